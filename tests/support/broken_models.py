"""Model files with the mistakes engineers make: for each the fault (its kind, and words behind a colon) and its place.

Most cases change ``BASE``: each pair replaces a text in it, ``END`` appends.
"""

from dataclasses import dataclass

from support.models import EVERY_ELEMENT

KINDS = ", ".join(sorted(EVERY_ELEMENT))

BASE = """\
torsionnet: 1
name: chain
parameters:
  k: 1 kN*m/rad
elements:
  rotor:   {type: inertia, node: motor, inertia: 0.1 kg*m^2}
  shaft:   {type: spring, nodes: [motor, wheel], stiffness: k}
  vehicle: {type: inertia, node: wheel, inertia: 2}
inputs:  {T_M: {torque: motor}}
sensors: {theta: {angle: motor}, T: {torque: shaft}}
"""
SPRING = "type: spring, nodes: [motor, wheel], stiffness: k"
END = ""
BOMB = "torsionnet: 1\na: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{new}: &{new} [{','.join(['*' + old] * 9)}]\n" for old, new in zip("abcdefgh", "bcdefghi", strict=True)
)


@dataclass(frozen=True)
class Case:
    name: str
    place: str
    fault: str
    text: str


def case(name, place, fault, *edits):
    text = BASE
    for old, new in edits:
        assert old in text
        text = text.replace(old, new, 1) if old else text + new
    return Case(name, place, fault, text)


whole = Case

# fmt: off
CASES = [
    whole("bomb", "7:11", "too-large: 200000", BOMB),
    whole("empty", "1:1", "wrong-file", ""),
    whole("comment only", "1:1", "wrong-file", "# nothing\n"),
    whole("list", "1:1", "wrong-file", "- torsionnet: 1\n- name: x\n"),
    whole("two docs", "11:1", "wrong-indentation", BASE + "---\n" + BASE),
    whole("deep", "1:24", "too-large: 20", "a: " + "[" * 30 + "]" * 30),
    whole("elements list", "2:1", "missing-entry", "torsionnet: 1\nelements:\n  - {type: inertia, node: a, inertia: 1}\n"),
    whole("no elements", "1:1", "missing-entry", "torsionnet: 1\nname: x\n"),
    case("unit of another dimension", "6:50", "wrong-unit", ("0.1 kg*m^2", "0.1 kg*m")),
    case("unknown unit", "6:50", 'unknown-unit: did you mean "kgm2"', ("0.1 kg*m^2", "0.1 kgm3x")),
    case("unit misspelt", "4:6", 'unknown-unit: did you mean "rad"', ("1 kN*m/rad", "1 kNm/rd")),
    case("decimal comma text", "4:6", "decimal-comma", ("1 kN*m/rad", '"13,3 kN*m/rad"')),
    case("decimal comma plain", "4:6", "decimal-comma", ("1 kN*m/rad", "13,3 kN*m/rad")),
    case("decimal comma flow", "8:52", "decimal-comma: 152", ("inertia: 2}", "inertia: 0,152}")),
    case("ratio 3:1", "5:55", "not-a-number", ("shaft:   {type: spring, nodes: [motor, wheel], stiffness: k}", "shaft:   {type: gear, nodes: [motor, wheel], ratio: 3:1}"), ("  k: 1 kN*m/rad\n", ""), ("parameters:\n", "")),
    case("unknown type", "7:19", 'unknown-word: did you mean "spring"', ("type: spring", "type: sprng")),
    case("list as type", "7:19", "unknown-word", ("type: spring", "type: [spring]")),
    case("stiffness without value", "7:58", "empty-entry", (SPRING, "type: gear, nodes: [motor, wheel], ratio: 2, stiffness: ")),
    case("ratio without value", "7:48", "empty-entry", (SPRING, "type: gear, nodes: [motor, wheel], ratio: ")),
    case("type without value", "7:3", "missing-entry", ("type: spring", "type: ")),
    case("unknown key without value", "8:53", "unknown-entry", ("inertia: 2}", "inertia: 2, mass}")),
    case("sensors as empty list", "10:10", "wrong-form", ("{theta: {angle: motor}, T: {torque: shaft}}", "[]")),
    case("configurations switched off", "11:17", "wrong-form", (END, "configurations: false\n")),
    case("element without content", "8:11", "wrong-form", ("{type: inertia, node: wheel, inertia: 2}", "")),
    case("mixed axes and alternatives", "11:45", "wrong-form", (END, "configurations: {gear: {I: {k: 1}}, II: {k: 3}}\n")),
    case("contradiction in a configuration", "12:25", "contradicting-gears: in configuration I", (SPRING, "type: gear, nodes: [motor, wheel], ratio: t"), ("k: 1 kN*m/rad", "t: 2"), ("T: {torque: shaft}", "T: {twist: shaft}"), ("  vehicle:", "  g2: {type: gear, nodes: [motor, wheel], ratio: 2}\n  vehicle:"), (END, "configurations: {gear: {I: {t: 3}}}\n")),
    case("no type", "7:3", "missing-entry", ("type: spring, ", "")),
    case("unknown key", "7:50", 'unknown-entry: did you mean "stiffness"', ("stiffness: k", "stiffnes: k")),
    case("unknown top key", "10:1", 'unknown-entry: did you mean "sensors"', ("sensors:", "sensor:")),
    case("elements misspelt", "5:1", 'unknown-entry: did you mean "elements"', ("elements:", "elemnts:")),
    case("parameters misspelt", "3:1", 'unknown-entry: did you mean "parameters"', ("parameters:", "paramters:")),
    case("unknown node in input", "9:25", 'unknown-node: did you mean "motor"', ("T_M: {torque: motor}", "T_M: {torque: motr}")),
    case("unknown node in sensor", "10:26", 'unknown-node: did you mean "wheel"', ("angle: motor", "angle: whel")),
    case("unknown element", "10:46", 'unknown-element: did you mean "shaft"', ("torque: shaft", "torque: shft")),
    case("torque at a node", "10:46", "unknown-element", ("torque: shaft", "torque: wheel")),
    case("torque at unknown port", "10:57", 'unknown-word: did you mean "motor"', ("torque: shaft", "torque: shaft, at: motr")),
    case("at without torque", "10:37", "unfit-channel", ("angle: motor", "angle: motor, at: shaft")),
    case("unknown param", "7:61", 'unknown-parameter: did you mean "k"', ("stiffness: k", "stiffness: 2*kk")),
    case("missing key", "6:3", "missing-entry", (", inertia: 0.1 kg*m^2", "")),
    case("missing nodes", "7:3", "missing-entry", ("nodes: [motor, wheel], ", "")),
    case("dup element", "8:3", "repeated-name: column 3", ("vehicle:", "rotor:  ")),
    case("dup key", "7:64", "repeated-name: column 50", ("stiffness: k", "stiffness: k, stiffness: 3")),
    case("dup section", "11:1", "repeated-name: column 1", (END, "elements:\n  x: {type: lock, node: motor}\n")),
    case("cycle", "4:6", "circular-definition", ("k: 1 kN*m/rad", "k: 2*a\n  a: k/2")),
    case("cycle self", "4:6", "circular-definition", ("k: 1 kN*m/rad", "k: 2*k")),
    case("wrong dim expr", "7:61", "wrong-unit", ("stiffness: k", "stiffness: 1/k")),
    case("sum of unlike", "6:6", "wrong-unit", ("k: 1 kN*m/rad", "k: 1 kN*m/rad\n  J: 1 kg*m^2\n  x: k + J")),
    case("negative inertia", "6:50", "out-of-range: -0.1", ("0.1 kg*m^2", "-0.1 kg*m^2")),
    case("negative stiffness via parameter", "7:61", "out-of-range: -1000", ("k: 1 kN", "k: -1 kN")),
    case("nan", "6:50", "unreadable-expression: column 1", ("0.1 kg*m^2", ".nan")),
    case("NaN word", "6:50", "unreadable-expression: column 1", ("0.1 kg*m^2", "NaN")),
    case("inf", "6:50", "unreadable-expression: column 1", ("0.1 kg*m^2", ".inf")),
    case("inf word", "6:50", "unreadable-expression: column 1", ("0.1 kg*m^2", "inf")),
    case("1e999", "6:50", "not-finite", ("0.1 kg*m^2", "1e999")),
    case("zero ratio", "7:55", "out-of-range", (SPRING, "type: gear, nodes: [motor, wheel], ratio: 0")),
    case("ratio and teeth", "7:58", "contradicting-entries", (SPRING, "type: gear, nodes: [motor, wheel], ratio: 2, teeth: [10, 20]")),
    case("no ratio", "7:3", "missing-entry", (SPRING, "type: gear, nodes: [motor, wheel]")),
    case("teeth float", "7:56", "not-a-number: 17.5", (SPRING, "type: gear, nodes: [motor, wheel], teeth: [17.5, 61]")),
    case("teeth text", "7:55", "wrong-count: 17", (SPRING, "type: gear, nodes: [motor, wheel], teeth: 17/61")),
    case("gear loop", "9:3", "contradicting-gears: 25 %", ("shaft:   {type: spring, nodes: [motor, wheel], stiffness: k}", "g1: {type: gear, nodes: [motor, lay], ratio: 2}\n  g2: {type: gear, nodes: [lay, wheel], ratio: 2}\n  shaft: {type: gear, nodes: [motor, wheel], ratio: 3}")),
    case("unconnected", "8:3", 'unconnected-nodes: did you mean "wheel"', ("  vehicle:", "  other: {type: inertia, node: whel, inertia: 1}\n  vehicle:")),
    case("locked input", "10:25", "no-effect", ("  vehicle:", "  brake: {type: lock, node: motor}\n  vehicle:")),
    case("config unknown param", "11:29", 'unknown-parameter: did you mean "k"', (END, "configurations: {gear: {I: {kk: 3}}}\n")),
    case("config unknown element", "11:35", 'unknown-element: did you mean "shaft"', (END, "configurations: {gear: {I: {off: [shft]}}}\n")),
    case("config shape", "11:17", "wrong-form: 7.96", (END, "configurations: [I, II]\n")),
    case("config shape2", "13:5", "unknown-parameter", (END, "configurations:\n  gear:\n    I: 3\n")),
    case("config on string", "11:33", "wrong-form", (END, "configurations: {gear: {I: {on: shaft}}}\n")),
    case("config name", "11:25", "invalid-name", (END, 'configurations: {gear: {"I, II": {k: 3}}}\n')),
    case("config dim", "11:32", "wrong-unit", (END, "configurations: {gear: {I: {k: 3 kg*m^2}}}\n")),
    case("config neg", "11:32", "out-of-range: in configuration I", (END, "configurations: {gear: {I: {k: -3}}}\n")),
    case("config on off", "11:47", "contradicting-entries", (END, "configurations: {gear: {I: {on: [shaft], off: [shaft]}}}\n")),
    case("op unknown key", "11:19", 'unknown-entry: did you mean "speed"', (END, "operating_point: {speeds: {motor: 100 rpm}}\n")),
    case("op unit Hz", "11:34", "wrong-unit", (END, "operating_point: {speed: {motor: 100 Hz}}\n")),
    case("op unknown node", "11:27", 'unknown-node: did you mean "motor"', (END, "operating_point: {speed: {moter: 100 rpm}}\n")),
    case("op shape", "11:18", "wrong-form: 1500", (END, "operating_point: 1500 rpm\n")),
    case("op value shape", "11:26", "wrong-form: 1500", (END, "operating_point: {speed: 1500 rpm}\n")),
    case("op contradicts", "11:26", "contradicting-speeds: 100", (END, "operating_point: {speed: {motor: 100 rpm, wheel: 200 rpm}}\n")),
    case("indeterminate", "11:46", "indeterminate-torque", (SPRING, "type: rigid_coupling, nodes: [motor, wheel]"), ("  vehicle:", "  second: {type: rigid_coupling, nodes: [motor, wheel]}\n  vehicle:")),
    case("reserved param", "4:3", "invalid-name", ("k: 1 kN*m/rad", "omega: 3"), ("stiffness: k", "stiffness: 3")),
    case("keyword param", "4:3", "invalid-name", ("k: 1 kN*m/rad", "lambda: 3"), ("stiffness: k", "stiffness: 3")),
    case("param name dash", "4:3", "invalid-name", ("k: 1 kN*m/rad", "k-1: 3"), ("stiffness: k", "stiffness: 3")),
    case("element name blank", "7:3", "invalid-name", ("shaft:   {", "half shaft: {"), ("torque: shaft", "torque: half shaft")),
    case("node name dash", "8:34", "invalid-name", ("node: wheel", "node: wheel-hub")),
    case("inertia on ground", "8:34", "grounded-node", ("node: wheel", "node: ground")),
    case("both same", "7:42", "same-node", ("[motor, wheel]", "[motor, motor]")),
    case("three nodes", "7:34", "not-a-node", ("[motor, wheel]", "[motor, wheel, hub]")),
    case("one node", "7:34", "not-a-node", ("[motor, wheel]", "motor")),
    case("node number", "8:34", "not-a-node", ("node: wheel", "node: 3")),
    case("hostile", "7:61", "unreadable-expression: column 12", ("stiffness: k", 'stiffness: __import__("os").system("ls")')),
    case("hostile2", "7:61", "unreadable-expression: column 1", ("stiffness: k", 'stiffness: "k.__class__"')),
    case("hostile power", "7:61", "unreadable-expression: column 10", ("stiffness: k", "stiffness: 9**9**9**9")),
    case("div zero", "7:61", "incalculable-value", ("stiffness: k", "stiffness: k/(2-2)")),
    case("missing operator", "7:61", "unknown-unit", ("stiffness: k", "stiffness: 2 k")),
    case("incomplete expr", "7:61", "unreadable-expression: column 3", ("stiffness: k", "stiffness: 2*(k")),
    case("tab", "6:1", "wrong-indentation", ("  rotor:", "\trotor:")),
    case("indent", "7:4", "wrong-indentation", ("  shaft:", "   shaft:")),
    case("unclosed quote", "2:7", "open-quote", ("name: chain", 'name: "chain')),
    case("unclosed brace", "8:12", "open-bracket", ("inertia: 2}", "inertia: 2")),
    case("unclosed bracket", "7:61", "open-bracket", ("[motor, wheel]", "[motor, wheel")),
    case("missing colon", "8:3", "missing-colon", ("vehicle: {", "vehicle {")),
    case("missing blank", "8:3", "missing-colon", ("vehicle: {", "vehicle:{")),
    case("colon in text", "2:12", "stray-colon", ("name: chain", "name: chain: long")),
    case("at sign", "2:7", "missing-quotes", ("name: chain", "name: @chain")),
    case("tag", "2:7", "missing-quotes", ("name: chain", "name: !!python/object:os.system ls")),
    case("tag2", "6:10", "missing-quotes", ("rotor:   {", "rotor: !x {")),
    case("unknown alias", "7:61", "missing-quotes", ("stiffness: k", "stiffness: *k")),
    case("merge", "6:13", "missing-quotes", ("rotor:   {", "rotor:   {<<: {node: motor}, ")),
    case("version 2", "1:13", "wrong-version", ("torsionnet: 1", "torsionnet: 2")),
    case("version text", "1:13", "wrong-version", ("torsionnet: 1", 'torsionnet: "1"')),
    case("no version", "1:1", "missing-entry", ("torsionnet: 1\n", "")),
    case("element text", "8:12", "wrong-form", ("{type: inertia, node: wheel, inertia: 2}", "2 kg*m^2")),
    case("empty value", "8:50", "empty-entry", ("inertia: 2}", "inertia: }")),
    case("enabled no", "8:62", "wrong-form", ("inertia: 2}", "inertia: 2, enabled: no}")),
    case("bool value", "8:50", "not-a-number", ("inertia: 2}", "inertia: true}")),
    case("name number", "2:7", "wrong-form", ("name: chain", "name: 3")),
    case("sensor unknown key", "10:19", 'unknown-entry: did you mean "angle"', ("angle: motor", "angel: motor")),
    case("sensor two", "10:18", "wrong-form", ("angle: motor", "angle: motor, velocity: motor")),
    case("input shape", "9:16", "wrong-form", ("T_M: {torque: motor}", "T_M: motor")),
    case("sensors list", "10:10", "wrong-form", ("{theta: {angle: motor}, T: {torque: shaft}}", "[theta, T]")),
    case("damping at", "7:73", "missing-entry", ("stiffness: k", "stiffness: k, damping: {zeta: 0.02}")),
    case("damping unit", "7:73", "wrong-unit", ("stiffness: k", "stiffness: k, damping: 4 N*m/rad")),
    case("damping bad measure", "7:74", 'unknown-word: did you mean "zeta"', ("stiffness: k", "stiffness: k, damping: {zetta: 0.02, at: 8 Hz}")),
    case("damping neg zeta", "7:80", "out-of-range: -0.02", ("stiffness: k", "stiffness: k, damping: {zeta: -0.02, at: 8 Hz}")),
    case("unread shaft with a sensor inside", "7:75", "unknown-entry", (SPRING, "type: shaft, nodes: [motor, wheel], length: 1 m, segments: 3, outer_dameter: 50 mm"), ("{theta: {angle: motor}", "{inside: {angle: shaft.1}, theta: {angle: motor}")),
    case("param no value", "4:3", "missing-entry: 0.46", ("k: 1 kN*m/rad", "k: {description: x}")),
    case("param extra key", "4:17", "unknown-entry", ("k: 1 kN*m/rad", "k: {value: 3, unit: kN*m/rad}")),
    case("param comma text", "4:37", "unknown-entry", ("k: 1 kN*m/rad", "k: {value: 3, description: stiff, cold}")),
    case("param bounds", "4:25", "unordered-rows", ("k: 1 kN*m/rad", "k: {value: 3, bounds: [4, 2]}")),
    case("param list", "4:6", "not-a-number", ("k: 1 kN*m/rad", "k: [1, kN*m/rad]")),
    case("param empty", "4:5", "empty-entry", ("k: 1 kN*m/rad", "k:")),
    case("shaft inner", "7:88", "contradicting-values", (SPRING, "type: shaft, nodes: [motor, wheel], outer_diameter: 50 mm, inner_diameter: 60 mm, length: 1 m")),
    case("shaft mm as bare kg", "7:65", "wrong-unit", (SPRING, "type: shaft, nodes: [motor, wheel], outer_diameter: 50 kg, length: 1 m, segments: 2.5")),
    case("table order", "7:80", "unordered-rows", (SPRING, "type: tabulated_spring, nodes: [motor, wheel], table: [[2, 1, 1], [1, 2, 2]]")),
    case("table neg", "7:72", "out-of-range", (SPRING, "type: tabulated_spring, nodes: [motor, wheel], table: [[2, -1, 1], [1, 2]]")),
    case("planetary", "7:12", "same-node", (SPRING, "type: planetary, sun: motor, ring: motor, carrier: wheel, teeth: [62, 28]")),
    case("differential", "7:12", "same-node", (SPRING, "type: differential, cage: motor, left: wheel, right: wheel")),
    case("choice", "7:94", 'unknown-word: did you mean "lumped"', (SPRING, "type: shaft, nodes: [motor, wheel], outer_diameter: 50 mm, length: 1 m, inertia: lump")),
    case("shape follow-up", "9:50", 'unknown-entry: did you mean "stiffness"', ("stiffness: k}", "stiffnes: k, damping: c}"), ("k: 1 kN*m/rad", "k: 1 kN*m/rad\n  c: 1\n  zz: 3")),
    case("broken param used", "4:6", 'unknown-unit: did you mean "rad"', ("1 kN*m/rad", "1 kN*m/rdd")),
    case("leading zero", "8:50", "ambiguous-number", ("inertia: 2}", "inertia: 017}")),
    case("hex", "8:50", "unknown-unit", ("inertia: 2}", "inertia: 0x10}")),
    case("underscore number", "8:50", "ambiguous-number", ("inertia: 2}", "inertia: 1_000}")),
    case("thousands", "8:50", "ambiguous-number: 300", ("inertia: 2}", "inertia: 13 300 kg*m^2}")),
    case("multi line element", "10:5", 'unknown-entry: did you mean "stiffness"', ("shaft:   {type: spring, nodes: [motor, wheel], stiffness: k}", "shaft:\n    type: spring\n    nodes: [motor, wheel]\n    stifness: k")),
    case("two faults at once", "6:50", "wrong-unit", ("0.1 kg*m^2", "0.1 kg*m"), ("torque: shaft", "torque: shft")),
    case("torque and imposed angle", "9:25", "contradicting-angles", ("{T_M: {torque: motor}}", "{T_M: {torque: motor}, phi: {angle: motor}}")),
    case("undefined in parameter", "4:6", 'unknown-parameter: did you mean "k"', ("k: 1 kN*m/rad", "k: 2*kk")),
    case("massless", "7:3", "indeterminate-motion", (SPRING, "type: differential, cage: motor, left: wheel, right: hub"), ("{type: inertia, node: wheel, inertia: 2}", "{type: inertia, node: motor, inertia: 2}")),
]
# fmt: on
