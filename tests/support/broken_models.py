"""Model files with the mistakes engineers make: for each the message and the place (line:column) that are shown first.

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
    message: str
    text: str


def case(name, place, message, *edits):
    text = BASE
    for old, new in edits:
        assert old in text
        text = text.replace(old, new, 1) if old else text + new
    return Case(name, place, message, text)


whole = Case

# fmt: off
CASES = [
    whole("bomb", "7:11", "the file holds more than 200000 entries, aliases (*) followed", BOMB),
    whole("empty", "1:1", "the file is empty", ""),
    whole("comment only", "1:1", "the file is empty", "# nothing\n"),
    whole("list", "1:1", "this is a list", "- torsionnet: 1\n- name: x\n"),
    whole("two docs", "11:1", "a second document begins here (---)", BASE + "---\n" + BASE),
    whole("deep", "1:24", "entries are nested more than 20 levels deep", "a: " + "[" * 30 + "]" * 30),
    whole("elements list", "2:1", "a model needs elements: {name: {type: inertia, node: ..., inertia: ...}, ...}", "torsionnet: 1\nelements:\n  - {type: inertia, node: a, inertia: 1}\n"),
    whole("no elements", "1:1", "a model needs elements: {name: {type: inertia, node: ..., inertia: ...}, ...}", "torsionnet: 1\nname: x\n"),
    case("unit of another dimension", "6:50", '"0.1 kg*m" is not a value of inertia', ("0.1 kg*m^2", "0.1 kg*m")),
    case("unknown unit", "6:50", '"kgm3" is not a known unit; did you mean "kgm2"?', ("0.1 kg*m^2", "0.1 kgm3x")),
    case("unit misspelt", "4:6", '"rd" is not a known unit; did you mean "rad"?', ("1 kN*m/rad", "1 kNm/rd")),
    case("decimal comma text", "4:6", '"13,3 kN*m/rad" has a decimal comma', ("1 kN*m/rad", '"13,3 kN*m/rad"')),
    case("decimal comma plain", "4:6", '"13,3 kN*m/rad" has a decimal comma', ("1 kN*m/rad", "13,3 kN*m/rad")),
    case("decimal comma flow", "8:52", '"0,152" has a decimal comma', ("inertia: 2}", "inertia: 0,152}")),
    case("ratio 3:1", "5:55", 'expected a number, got "3:1"', ("shaft:   {type: spring, nodes: [motor, wheel], stiffness: k}", "shaft:   {type: gear, nodes: [motor, wheel], ratio: 3:1}"), ("  k: 1 kN*m/rad\n", ""), ("parameters:\n", "")),
    case("unknown type", "7:19", 'no element type is named "sprng"; did you mean "spring"?', ("type: spring", "type: sprng")),
    case("list as type", "7:19", "no element type is named", ("type: spring", "type: [spring]")),
    case("stiffness without value", "7:58", "stiffness has no value; give one, or leave the entry out", (SPRING, "type: gear, nodes: [motor, wheel], ratio: 2, stiffness: ")),
    case("ratio without value", "7:48", "ratio has no value; give one, or leave the entry out", (SPRING, "type: gear, nodes: [motor, wheel], ratio: ")),
    case("type without value", "7:3", "an element needs a type", ("type: spring", "type: ")),
    case("unknown key without value", "8:53", 'unknown key "mass"', ("inertia: 2}", "inertia: 2, mass}")),
    case("sensors as empty list", "10:10", "expected entries by name, got []", ("{theta: {angle: motor}, T: {torque: shaft}}", "[]")),
    case("configurations switched off", "11:17", "expected axes of alternatives", (END, "configurations: false\n")),
    case("element without content", "8:11", "expected {type: ..., ...}, got nothing", ("{type: inertia, node: wheel, inertia: 2}", "")),
    case("mixed axes and alternatives", "11:45", "expected {parameter: value}, got 3", (END, "configurations: {gear: {I: {k: 1}}, II: {k: 3}}\n")),
    case("contradiction in a configuration", "12:25", "in configuration I: the rigid ratios of shaft, g2 contradict each other", (SPRING, "type: gear, nodes: [motor, wheel], ratio: t"), ("k: 1 kN*m/rad", "t: 2"), ("T: {torque: shaft}", "T: {twist: shaft}"), ("  vehicle:", "  g2: {type: gear, nodes: [motor, wheel], ratio: 2}\n  vehicle:"), (END, "configurations: {gear: {I: {t: 3}}}\n")),
    case("no type", "7:3", f"an element needs a type: {KINDS}", ("type: spring, ", "")),
    case("unknown key", "7:50", 'unknown key "stiffnes"; did you mean "stiffness"?', ("stiffness: k", "stiffnes: k")),
    case("unknown top key", "10:1", 'unknown key "sensor"; did you mean "sensors"?', ("sensors:", "sensor:")),
    case("elements misspelt", "5:1", 'unknown key "elemnts"; did you mean "elements"?', ("elements:", "elemnts:")),
    case("parameters misspelt", "3:1", 'unknown key "paramters"; did you mean "parameters"?', ("parameters:", "paramters:")),
    case("unknown node in input", "9:25", 'no node is named "motr"; did you mean "motor"?', ("T_M: {torque: motor}", "T_M: {torque: motr}")),
    case("unknown node in sensor", "10:26", 'no node is named "whel"; did you mean "wheel"?', ("angle: motor", "angle: whel")),
    case("unknown element", "10:46", 'no element is named "shft"; did you mean "shaft"?', ("torque: shaft", "torque: shft")),
    case("torque at a node", "10:46", '"wheel" is a node, no element', ("torque: shaft", "torque: wheel")),
    case("torque at unknown port", "10:57", 'shaft is not attached to "motr"; did you mean "motor"?', ("torque: shaft", "torque: shaft, at: motr")),
    case("at without torque", "10:37", "only a torque is taken at a port; leave out at:", ("angle: motor", "angle: motor, at: shaft")),
    case("unknown param", "7:61", 'no parameter is named "kk"; did you mean "k"?', ("stiffness: k", "stiffness: 2*kk")),
    case("missing key", "6:3", "inertia rotor needs inertia: mass moment of inertia", (", inertia: 0.1 kg*m^2", "")),
    case("missing nodes", "7:3", "spring shaft needs nodes: the two nodes it connects, one may be ground", ("nodes: [motor, wheel], ", "")),
    case("dup element", "8:3", '"rotor" was already given at line 6, column 3', ("vehicle:", "rotor:  ")),
    case("dup key", "7:64", '"stiffness" was already given at line 7, column 50', ("stiffness: k", "stiffness: k, stiffness: 3")),
    case("dup section", "11:1", '"elements" was already given at line 5, column 1', (END, "elements:\n  x: {type: lock, node: motor}\n")),
    case("cycle", "4:6", "parameters define each other in a circle: k -> a -> k", ("k: 1 kN*m/rad", "k: 2*a\n  a: k/2")),
    case("cycle self", "4:6", "parameters define each other in a circle: k -> k", ("k: 1 kN*m/rad", "k: 2*k")),
    case("wrong dim expr", "7:61", '"1/k" has the dimension of rad/(N*m)', ("stiffness: k", "stiffness: 1/k")),
    case("sum of unlike", "6:6", '"k + J" would add N*m and kg*m^2', ("k: 1 kN*m/rad", "k: 1 kN*m/rad\n  J: 1 kg*m^2\n  x: k + J")),
    case("negative inertia", "6:50", "-0.1: mass moment of inertia must not be less than 0", ("0.1 kg*m^2", "-0.1 kg*m^2")),
    case("negative stiffness via parameter", "7:61", "k = -1000: torsional stiffness must not be less than 0", ("k: 1 kN", "k: -1 kN")),
    case("nan", "6:50", '"nan" at column 1: "nan" is no finite number', ("0.1 kg*m^2", ".nan")),
    case("NaN word", "6:50", '"NaN" at column 1: "NaN" is no finite number', ("0.1 kg*m^2", "NaN")),
    case("inf", "6:50", '"inf" at column 1: "inf" is no finite number', ("0.1 kg*m^2", ".inf")),
    case("inf word", "6:50", '"inf" at column 1: "inf" is no finite number', ("0.1 kg*m^2", "inf")),
    case("1e999", "6:50", '"1e999" is too large or too small a number', ("0.1 kg*m^2", "1e999")),
    case("zero ratio", "7:55", "0: speed of the first node over speed of the second must not be zero", (SPRING, "type: gear, nodes: [motor, wheel], ratio: 0")),
    case("ratio and teeth", "7:58", "give ratio or teeth, not both", (SPRING, "type: gear, nodes: [motor, wheel], ratio: 2, teeth: [10, 20]")),
    case("no ratio", "7:3", "give ratio or teeth, one of the two", (SPRING, "type: gear, nodes: [motor, wheel]")),
    case("teeth float", "7:56", "a teeth count is a whole number other than zero, got 17.5", (SPRING, "type: gear, nodes: [motor, wheel], teeth: [17.5, 61]")),
    case("teeth text", "7:55", "expected two teeth counts [z1, z2], got '17/61'", (SPRING, "type: gear, nodes: [motor, wheel], teeth: 17/61")),
    case("gear loop", "9:3", "the rigid ratios of g1, g2, shaft contradict each other: the loop could not turn; by shaft motor turns 3 times as fast as wheel, by the others 4 times, 25 % apart", ("shaft:   {type: spring, nodes: [motor, wheel], stiffness: k}", "g1: {type: gear, nodes: [motor, lay], ratio: 2}\n  g2: {type: gear, nodes: [lay, wheel], ratio: 2}\n  shaft: {type: gear, nodes: [motor, wheel], ratio: 3}")),
    case("unconnected", "8:3", 'whel is not connected to the rest of the drivetrain; did you mean "wheel"?', ("  vehicle:", "  other: {type: inertia, node: whel, inertia: 1}\n  vehicle:")),
    case("locked input", "10:25", '"motor" is locked', ("  vehicle:", "  brake: {type: lock, node: motor}\n  vehicle:")),
    case("config unknown param", "11:29", 'no parameter is named "kk"; did you mean "k"?', (END, "configurations: {gear: {I: {kk: 3}}}\n")),
    case("config unknown element", "11:35", 'no element is named "shft"; did you mean "shaft"?', (END, "configurations: {gear: {I: {off: [shft]}}}\n")),
    case("config shape", "11:17", "expected axes of alternatives, gear: {II: {tau: 7.96}}, got ['I', 'II']", (END, "configurations: [I, II]\n")),
    case("config shape2", "13:5", 'no parameter is named "I"', (END, "configurations:\n  gear:\n    I: 3\n")),
    case("config on string", "11:33", "expected a list of element names, got 'shaft'", (END, "configurations: {gear: {I: {on: shaft}}}\n")),
    case("config name", "11:25", '"I, II" is no name for a configuration: no spaces, commas or =', (END, 'configurations: {gear: {"I, II": {k: 3}}}\n')),
    case("config dim", "11:32", '"3 kg*m^2" has the dimension of kg*m^2', (END, "configurations: {gear: {I: {k: 3 kg*m^2}}}\n")),
    case("config neg", "11:32", "in configuration I: k = -3: torsional stiffness must not be less than 0", (END, "configurations: {gear: {I: {k: -3}}}\n")),
    case("config on off", "11:47", "shaft is switched on and off at once", (END, "configurations: {gear: {I: {on: [shaft], off: [shaft]}}}\n")),
    case("op unknown key", "11:19", 'unknown key "speeds"; did you mean "speed"?', (END, "operating_point: {speeds: {motor: 100 rpm}}\n")),
    case("op unit Hz", "11:34", '"100 Hz" is not a value of speed', (END, "operating_point: {speed: {motor: 100 Hz}}\n")),
    case("op unknown node", "11:27", 'no node is named "moter"; did you mean "motor"?', (END, "operating_point: {speed: {moter: 100 rpm}}\n")),
    case("op shape", "11:18", "expected {speed: {node: 1500 rpm}}, got '1500 rpm'", (END, "operating_point: 1500 rpm\n")),
    case("op value shape", "11:26", "expected {node: value}, got '1500 rpm'", (END, "operating_point: {speed: 1500 rpm}\n")),
    case("op contradicts", "11:26", "the mean speeds (motor 100 rpm, wheel 200 rpm) do not fit the ratios between these nodes", (END, "operating_point: {speed: {motor: 100 rpm, wheel: 200 rpm}}\n")),
    case("indeterminate", "11:46", "torque through shaft is statically indeterminate: shaft, second form a rigid loop", (SPRING, "type: rigid_coupling, nodes: [motor, wheel]"), ("  vehicle:", "  second: {type: rigid_coupling, nodes: [motor, wheel]}\n  vehicle:")),
    case("reserved param", "4:3", '"omega" is reserved', ("k: 1 kN*m/rad", "omega: 3"), ("stiffness: k", "stiffness: 3")),
    case("keyword param", "4:3", '"lambda" is a word of the Python language; choose another name', ("k: 1 kN*m/rad", "lambda: 3"), ("stiffness: k", "stiffness: 3")),
    case("param name dash", "4:3", '"k-1" is not a valid name: a letter comes first, then letters, digits and _ (no accents)', ("k: 1 kN*m/rad", "k-1: 3"), ("stiffness: k", "stiffness: 3")),
    case("element name blank", "7:3", '"half shaft" is not a valid name', ("shaft:   {", "half shaft: {"), ("torque: shaft", "torque: half shaft")),
    case("node name dash", "8:34", '"wheel-hub" is not a valid name', ("node: wheel", "node: wheel-hub")),
    case("inertia on ground", "8:34", "ground does not move", ("node: wheel", "node: ground")),
    case("both same", "7:42", 'both ends are on node "motor"', ("[motor, wheel]", "[motor, motor]")),
    case("three nodes", "7:34", "expected two nodes [first, second], got ['motor', 'wheel', 'hub']", ("[motor, wheel]", "[motor, wheel, hub]")),
    case("one node", "7:34", "expected two nodes [first, second], got 'motor'", ("[motor, wheel]", "motor")),
    case("node number", "8:34", "expected the name of a node, got 3", ("node: wheel", "node: 3")),
    case("hostile", "7:61", '"__import__("os").system("ls")" at column 12: """ is not allowed in an expression', ("stiffness: k", 'stiffness: __import__("os").system("ls")')),
    case("hostile2", "7:61", '"k.__class__" at column 1: "k.__class__" is not a valid name', ("stiffness: k", 'stiffness: "k.__class__"')),
    case("hostile power", "7:61", '"9**9**9**9" at column 10: an exponent is a whole or half number of at most 4', ("stiffness: k", "stiffness: 9**9**9**9")),
    case("div zero", "7:61", 'k/(2 - 2) cannot be calculated: division by zero: "2 - 2" is 0', ("stiffness: k", "stiffness: k/(2-2)")),
    case("missing operator", "7:61", '"k" is not a known unit; if it is a parameter, write 2*k', ("stiffness: k", "stiffness: 2 k")),
    case("incomplete expr", "7:61", '"2*(k" at column 3: the expression is incomplete here', ("stiffness: k", "stiffness: 2*(k")),
    case("tab", "6:1", "a tab stands here", ("  rotor:", "\trotor:")),
    case("indent", "7:4", "this does not fit the indentation of the lines above", ("  shaft:", "   shaft:")),
    case("unclosed quote", "2:7", "a quote is opened here and never closed", ("name: chain", 'name: "chain')),
    case("unclosed brace", "8:12", 'the "{" opened here is not closed, or a comma is missing after it', ("inertia: 2}", "inertia: 2")),
    case("unclosed bracket", "7:61", 'a "," between two values or the closing "]" is missing', ("[motor, wheel]", "[motor, wheel")),
    case("missing colon", "8:3", 'write "vehicle: " with a colon and a blank after the name', ("vehicle: {", "vehicle {")),
    case("missing blank", "8:3", 'write "vehicle: " with a colon and a blank after the name', ("vehicle: {", "vehicle:{")),
    case("colon in text", "2:12", 'a ":" is not expected here', ("name: chain", "name: chain: long")),
    case("at sign", "2:7", 'a value cannot begin with "@"', ("name: chain", "name: @chain")),
    case("tag", "2:7", 'tags such as "!!python/object:os.system" have no meaning in a model file', ("name: chain", "name: !!python/object:os.system ls")),
    case("tag2", "6:10", 'tags such as "!x" have no meaning in a model file', ("rotor:   {", "rotor: !x {")),
    case("unknown alias", "7:61", 'no anchor "&k" stands before this alias', ("stiffness: k", "stiffness: *k")),
    case("merge", "6:13", "merging with << is not supported", ("rotor:   {", "rotor:   {<<: {node: motor}, ")),
    case("version 2", "1:13", "this is format 2", ("torsionnet: 1", "torsionnet: 2")),
    case("version text", "1:13", "is the version of the format, 1 for this release; this is '1'", ("torsionnet: 1", 'torsionnet: "1"')),
    case("no version", "1:1", "the first entry of a model file is torsionnet: 1, the version of the format", ("torsionnet: 1\n", "")),
    case("element text", "8:12", "expected {type: ..., ...}, got '2 kg*m^2'", ("{type: inertia, node: wheel, inertia: 2}", "2 kg*m^2")),
    case("empty value", "8:50", "a value is missing", ("inertia: 2}", "inertia: }")),
    case("enabled no", "8:62", "expected true or false, got 'no'", ("inertia: 2}", "inertia: 2, enabled: no}")),
    case("bool value", "8:50", "expected a number, got true", ("inertia: 2}", "inertia: true}")),
    case("name number", "2:7", "expected text, got 3", ("name: chain", "name: 3")),
    case("sensor unknown key", "10:19", 'unknown key "angel"; did you mean "angle"?', ("angle: motor", "angel: motor")),
    case("sensor two", "10:18", "expected one of angle, velocity, acceleration, twist, torque, stress, as in {angle: node} or {torque: e", ("angle: motor", "angle: motor, velocity: motor")),
    case("input shape", "9:16", "expected {torque: node}, {angle: node} or {torque: [node, node]}, got 'motor'", ("T_M: {torque: motor}", "T_M: motor")),
    case("sensors list", "10:10", "expected entries by name, got ['theta', 'T']", ("{theta: {angle: motor}, T: {torque: shaft}}", "[theta, T]")),
    case("damping at", "7:73", "zeta gives a viscous coefficient only at a stated frequency", ("stiffness: k", "stiffness: k, damping: {zeta: 0.02}")),
    case("damping unit", "7:73", '"4 N*m/rad" is not a value of damping', ("stiffness: k", "stiffness: k, damping: 4 N*m/rad")),
    case("damping bad measure", "7:74", '"zetta" is not a measure of damping; did you mean "zeta"?', ("stiffness: k", "stiffness: k, damping: {zetta: 0.02, at: 8 Hz}")),
    case("damping neg zeta", "7:80", "-0.02: must not be less than 0", ("stiffness: k", "stiffness: k, damping: {zeta: -0.02, at: 8 Hz}")),
    case("unread shaft with a sensor inside", "7:75", 'unknown key "outer_dameter"', (SPRING, "type: shaft, nodes: [motor, wheel], length: 1 m, segments: 3, outer_dameter: 50 mm"), ("{theta: {angle: motor}", "{inside: {angle: shaft.1}, theta: {angle: motor}")),
    case("param no value", "4:3", "a parameter needs value: a number with unit, as 0.46 kN*m/rad", ("k: 1 kN*m/rad", "k: {description: x}")),
    case("param extra key", "4:17", 'unknown key "unit"', ("k: 1 kN*m/rad", "k: {value: 3, unit: kN*m/rad}")),
    case("param comma text", "4:37", 'unknown key "cold"', ("k: 1 kN*m/rad", "k: {value: 3, description: stiff, cold}")),
    case("param bounds", "4:25", "the lower bound must be smaller than the upper bound", ("k: 1 kN*m/rad", "k: {value: 3, bounds: [4, 2]}")),
    case("param list", "4:6", "expected a number, a quantity with unit or an expression, got [1, 'kN*m/rad']", ("k: 1 kN*m/rad", "k: [1, kN*m/rad]")),
    case("param empty", "4:5", "expected a number, a quantity with unit or an expression, got nothing", ("k: 1 kN*m/rad", "k:")),
    case("shaft inner", "7:88", "the inner diameter must be smaller than the outer diameter", (SPRING, "type: shaft, nodes: [motor, wheel], outer_diameter: 50 mm, inner_diameter: 60 mm, length: 1 m")),
    case("shaft mm as bare kg", "7:65", '"50 kg" is not a value of length', (SPRING, "type: shaft, nodes: [motor, wheel], outer_diameter: 50 kg, length: 1 m, segments: 2.5")),
    case("table order", "7:80", "the frequency must increase from row to row", (SPRING, "type: tabulated_spring, nodes: [motor, wheel], table: [[2, 1, 1], [1, 2, 2]]")),
    case("table neg", "7:72", "stiffness must not be negative", (SPRING, "type: tabulated_spring, nodes: [motor, wheel], table: [[2, -1, 1], [1, 2]]")),
    case("planetary", "7:12", "sun, ring and carrier must be on three different nodes", (SPRING, "type: planetary, sun: motor, ring: motor, carrier: wheel, teeth: [62, 28]")),
    case("differential", "7:12", "cage, left and right must be on three different nodes", (SPRING, "type: differential, cage: motor, left: wheel, right: wheel")),
    case("choice", "7:94", 'expected consistent or lumped or none, got \'lump\'; did you mean "lumped"?', (SPRING, "type: shaft, nodes: [motor, wheel], outer_diameter: 50 mm, length: 1 m, inertia: lump")),
    case("shape follow-up", "9:50", 'unknown key "stiffnes"; did you mean "stiffness"?', ("stiffness: k}", "stiffnes: k, damping: c}"), ("k: 1 kN*m/rad", "k: 1 kN*m/rad\n  c: 1\n  zz: 3")),
    case("broken param used", "4:6", '"rdd" is not a known unit; did you mean "rad"?', ("1 kN*m/rad", "1 kN*m/rdd")),
    case("leading zero", "8:50", '"017" begins with 0, which some programs read as octal', ("inertia: 2}", "inertia: 017}")),
    case("hex", "8:50", '"x10" is not a known unit', ("inertia: 2}", "inertia: 0x10}")),
    case("underscore number", "8:50", '"1_000" has thousands separators', ("inertia: 2}", "inertia: 1_000}")),
    case("thousands", "8:50", '"13 300 kg*m^2" has thousands separators', ("inertia: 2}", "inertia: 13 300 kg*m^2}")),
    case("multi line element", "10:5", 'unknown key "stifness"; did you mean "stiffness"?', ("shaft:   {type: spring, nodes: [motor, wheel], stiffness: k}", "shaft:\n    type: spring\n    nodes: [motor, wheel]\n    stifness: k")),
    case("two faults at once", "6:50", '"0.1 kg*m" is not a value of inertia', ("0.1 kg*m^2", "0.1 kg*m"), ("torque: shaft", "torque: shft")),
    case("torque and imposed angle", "9:25", 'the angle of "motor" is imposed by phi', ("{T_M: {torque: motor}}", "{T_M: {torque: motor}, phi: {angle: motor}}")),
    case("undefined in parameter", "4:6", 'no parameter is named "kk"; did you mean "k"?', ("k: 1 kN*m/rad", "k: 2*kk")),
    case("massless", "7:3", "wheel, hub move together freely, with no inertia, spring or damper to hold them", (SPRING, "type: differential, cage: motor, left: wheel, right: hub"), ("{type: inertia, node: wheel, inertia: 2}", "{type: inertia, node: motor, inertia: 2}")),
]
# fmt: on
