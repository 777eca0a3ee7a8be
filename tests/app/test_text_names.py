"""Names in model texts: where they stand, where they are defined, and renaming that changes nothing else."""

import re
from functools import cache

import pytest
from support import campaigns

from torsionnet.app.text.named_places import definition, named_places, references, renamable, rename
from torsionnet.app.text.text_edits import TextSpan, edited
from torsionnet.base.errors import UsageError
from torsionnet.drivetrain import Drivetrain
from torsionnet.model.files.library import library_models
from torsionnet.model.files.reader import read_text

FRESH = "zz_fresh"
PLANT = """\
torsionnet: 1
name: plant with everything that can be named
parameters:
  a: {value: 2 kg*m^2, description: the a of a}
  k: {value: 3 kN*m/rad, bounds: [1 kN*m/rad, 9 kN*m/rad]}
  tau: 2
  follows: {by: speed, of: a, table: {0 rpm: 1, 3000 rpm: 2}}
  twisting: {by: mean_torque, of: link, table: {0 N*m: 1 N*m*s/rad, 100 N*m: 2 N*m*s/rad}}
parts:
  stage:
    ports: [front, rear]
    parameters: {k: 5 kN*m/rad, J: 1 kg*m^2}
    elements:
      spring: {type: spring, nodes: [front, rear], stiffness: k}
      disc: {type: inertia, node: rear, inertia: J}
    sensors: {twisting: {torque: spring}}
    configurations: {light: {}, heavy: {J: 2 kg*m^2}}
use:
  left: {part: stage, at: {front: a, rear: b}, parameters: {k: 2*k}}
  row: {part: stage, repeat: 2, chain: [front, rear], at: {front: b, rear: c}, parameters: {J: [a, 2*a]}}
elements:
  a: {type: inertia, node: a, inertia: a, description: "a stands for a, tau for tau"}
  link: {type: spring, nodes: [c, "d"], stiffness: k/tau^2, damping: twisting}
  damper: {type: tuned_damper, node: d, ring_inertia: 1 kg*m^2, stiffness: 2 kN*m/rad}
inputs:
  T_a: {torque: a}
  between: {torque: [a, d]}
sensors:
  phi: {angle: [a, d]}
  ring: {angle: damper.ring}
  T_link: {torque: link, at: d, referred_to: a}
  T_left: {torque: left.spring}
  T_row: {torque: row2.spring, at: row2.front}
configurations:
  heat: {cold: {}, hot: {k: 2 kN*m/rad, left.k: 4 kN*m/rad, link.damping: tau*twisting}}
  clutch:
    closed: {on: [link]}
    open: {off: [link], operating_point: {speed: {a: 1000 rpm}}}
operating_point:
  speed: {a: 1500 rpm}
  torque: {a-d: 20 N*m}
speeds: {of: a, range: 500..3000 rpm, step: 10 rpm, rated: 2000 rpm}
excitations:
  shake: {type: harmonic, node: a, orders: {2: {amplitude: 3 N*m}}}
load: {absorbed_at: d, torque: 20 N*m, torque_exponent: 0, driven_by: {shake: 1}}
scenarios:
  tip_in: {type: torques, duration: 1 s, torque: {T_a: {0 s: 0 N*m, 1 s: 5 N*m}, a-d: 3 N*m}}
report:
  transfer_functions: [T_link/T_a, "torque(link, d)/a"]
  measure: [T_link, a]
  configurations: ["heat=hot,clutch=closed"]
bench:
  drive: T_a
  excitation: {type: linear chirp, start: 0.1 Hz, stop: 80 Hz, duration: 10 s, amplitude: 15 N*m}
  channels:
    phi: {type: encoder, lines: 1024}
    extra: {type: transducer, sensor: "torque(link)", range: 100 N*m}
  acquisition: {rate: 1 kHz}
"""


@cache
def library_texts():
    return {name: path.read_text(encoding="utf-8") for name, path in library_models().items()}


def things(places):
    """First place of everything that is defined in a text and can be renamed."""
    return list({one.home: one for one in places if one.is_definition}.values())


def named(data, name, new):
    """Data of a model in which a word, or that with the number of a copy, stands for another, in keys and values."""
    if isinstance(data, dict):
        return {named(key, name, new): named(one, name, new) for key, one in data.items()}
    if isinstance(data, list):
        return [named(one, name, new) for one in data]
    return re.sub(rf"\b{name}(?=\d*\b)", new, data) if isinstance(data, str) else data


def free_texts(data):
    """Descriptions anywhere in the data of a model, in their order."""
    if isinstance(data, list):
        return [text for one in data for text in free_texts(one)]
    if not isinstance(data, dict):
        return []
    return [text for key, one in data.items() for text in ([one] if key == "description" else free_texts(one))]


def test_a_parameter_is_renamed_in_expressions_and_not_in_nodes_or_descriptions():
    new = edited(PLANT, rename(PLANT, PLANT.index("  a: {value") + 2, "J_a"))
    assert "  J_a: {value: 2 kg*m^2, description: the a of a}" in new
    assert 'a: {type: inertia, node: a, inertia: J_a, description: "a stands for a, tau for tau"}' in new
    assert "parameters: {J: [J_a, 2*J_a]}" in new
    assert new.count("J_a") == 4


def test_a_node_is_renamed_wherever_it_stands_alone_or_in_a_pair():
    new = edited(PLANT, rename(PLANT, PLANT.index("node: a") + 6, "nose"))
    changed = [line.strip() for line, old in zip(new.splitlines(), PLANT.splitlines(), strict=True) if line != old]
    assert changed == [
        "follows: {by: speed, of: nose, table: {0 rpm: 1, 3000 rpm: 2}}",
        "left: {part: stage, at: {front: nose, rear: b}, parameters: {k: 2*k}}",
        'a: {type: inertia, node: nose, inertia: a, description: "a stands for a, tau for tau"}',
        "T_a: {torque: nose}",
        "between: {torque: [nose, d]}",
        "phi: {angle: [nose, d]}",
        "T_link: {torque: link, at: d, referred_to: nose}",
        "open: {off: [link], operating_point: {speed: {nose: 1000 rpm}}}",
        "speed: {nose: 1500 rpm}",
        "torque: {nose-d: 20 N*m}",
        "speeds: {of: nose, range: 500..3000 rpm, step: 10 rpm, rated: 2000 rpm}",
        "shake: {type: harmonic, node: nose, orders: {2: {amplitude: 3 N*m}}}",
        "tip_in: {type: torques, duration: 1 s, torque: {T_a: {0 s: 0 N*m, 1 s: 5 N*m}, nose-d: 3 N*m}}",
        'transfer_functions: [T_link/T_a, "torque(link, d)/nose"]',
        "measure: [T_link, nose]",
    ]


def test_an_element_is_renamed_with_the_nodes_that_belong_to_it():
    new = edited(PLANT, rename(PLANT, PLANT.index("damper: {type") + 2, "absorber"))
    assert "absorber: {type: tuned_damper" in new
    assert "ring: {angle: absorber.ring}" in new
    assert new.count("absorber") == 2


@pytest.mark.parametrize(
    ("before", "new", "lines"),
    [
        (
            "ports: [",
            "ahead",
            ["ports: [ahead,", "nodes: [ahead, rear]", "{front: a,", "[front, rear], at: {front: b,", "row2.front}"],
        ),
        ("parameters: {", "kk", ["{kk: 5", "ness: kk}", "{kk: 2*k}", "left.kk: 4"]),
        ("elements:\n      ", "bar", ["bar: {type: spring", "torque: bar}", "left.bar}", "row2.bar,"]),
        ("use:\n  ", "port_side", ["port_side: {part", "port_side.spring", "port_side.k: 4"]),
        ("{k: 2*k}}\n  ", "bank", ["bank: {part", "bank2.spring, at: bank2.front"]),
        ("parts:\n  ", "hub", ["hub:\n", "left: {part: hub", "row: {part: hub"]),
        ("cold: {}, ", "warm", ["warm: {k", "heat=warm,"]),
        ("tau*twisting}}\n  ", "plates", ["plates:\n", "hot,plates=closed"]),
        ("inputs:\n  ", "motor", ["motor: {torque", "{motor: {0 s", "T_link/motor,", "drive: motor\n"]),
        ("sensors:\n  ", "theta", ["theta: {angle", "theta: {type: encoder"]),
    ],
)
def test_things_of_parts_uses_configurations_and_channels(before, new, lines):
    changed = edited(PLANT, rename(PLANT, PLANT.index(before) + len(before), new))
    lines = [line.replace("front", new) if new == "ahead" else line for line in lines]
    for line in lines:
        assert line in changed
    assert len(re.findall(new, changed)) == sum(len(re.findall(new, line)) for line in lines)


def renamed_everything(text):
    """Each thing that a text defines, with the model after it got another name; only the name is another one then."""
    before, faults = read_text(text, "")
    data = before.to_data()
    for one in things(named_places(text)):
        after, found = read_text(edited(text, rename(text, one.span.start, FRESH)), "")
        assert after is not None, (one, found)
        assert [fault.kind for fault in found] == [fault.kind for fault in faults], (one, found)
        assert named(after.to_data(), FRESH, one.name) == data, one
        assert free_texts(after.to_data()) == free_texts(data), one
        yield one, after


def test_the_plant_of_these_tests_stays_what_it_is():
    assert {one.kind for one in things(named_places(PLANT))} == {
        *(
            "axis",
            "channel",
            "configuration",
            "element",
            "excitation",
            "input",
            "node",
            "parameter",
            "part",
            "scenario",
        ),
        *("sensor", "use"),
    }


@pytest.mark.slow
def test_renaming_anything_leaves_the_same_plant():
    assert len(list(renamed_everything(PLANT))) > 30


QUICK = ("geared_branch", "oil_engine")
SLOW = pytest.param("two_stroke_ship", marks=pytest.mark.nightly)
MODELS = [*QUICK, SLOW, *campaigns.by_day(sorted({*library_models()} - {*QUICK, *SLOW.values}))]


@pytest.mark.parametrize("name", MODELS)
def test_renaming_anything_leaves_the_same_model(name):
    kinds = {one.kind for one, _ in renamed_everything(library_texts()[name])}
    assert {"node", "element"} <= kinds


@pytest.mark.parametrize("name", MODELS)
def test_renaming_leaves_the_natural_frequencies(name):
    text = library_texts()[name]
    expected = Drivetrain.from_definition(read_text(text, "")[0]).modes().undamped_natural_frequencies
    for one in {one.kind: one for one in things(named_places(text))}.values():
        after, _ = read_text(edited(text, rename(text, one.span.start, FRESH)), "")
        found = Drivetrain.from_definition(after).modes().undamped_natural_frequencies
        assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)


NODE, PARAMETER, ELEMENT = "  a: {type: inertia, node: ", "parameters:\n  ", "\nelements:\n  "


@pytest.mark.parametrize(
    ("before", "new", "message"),
    [
        (NODE, "b", '"b" is a node of this model already; choose another name'),
        (NODE, "2b", '"2b" is not a valid name'),
        (NODE, "ground", '"ground" is the node that never moves'),
        (NODE, "left.x", "has a dot"),
        (NODE, "true", "something else would be meant"),
        (NODE, "phi", "something else would be meant"),  # in the report a sensor
        (PARAMETER, "k", '"k" is a parameter of this model already'),
        (PARAMETER, "pi", '"pi" is reserved: it stands for the number 3.14159'),
        (PARAMETER, "lambda", "a word of the Python language"),
        (PARAMETER, "rpm", '"rpm" is a unit'),
        (ELEMENT, "left", '"left" is a part used in this model already'),
        ("\ninp", "x", "nothing that has a name stands here"),
        ("description: the", "x", "nothing that has a name stands here"),
        ("heat: {", "so so", "no spaces, commas, ="),
    ],
)
def test_refusals_name_their_reason(before, new, message):
    with pytest.raises(UsageError, match=re.escape(message)):
        rename(PLANT, PLANT.index(before) + len(before), new)


def test_the_same_name_changes_nothing():
    assert rename(PLANT, PLANT.index("node: a") + 6, "a") == []


def test_a_name_that_is_defined_elsewhere_cannot_be_renamed():
    text = "elements: {disc: {type: inertia, node: a, inertia: J}}\n"
    with pytest.raises(UsageError, match=r'(?s)"J" .*unknown-name'):
        rename(text, text.index("J}"), "K")
    assert renamable(text, text.index("J}")) is None
    node = text.index("node: a") + 6
    assert renamable(text, node) == TextSpan(node, node + 1)


def test_renaming_in_a_text_with_faults_elsewhere():
    text = PLANT.replace("stiffness: k/tau^2", "stiffness: k/tau^^2").replace("bench:", "bench: {[")
    new = edited(text, rename(text, text.index("node: d") + 6, "nose"))
    assert "damper: {type: tuned_damper, node: nose," in new
    assert 'nodes: [c, "nose"]' in new
    assert "at: nose, referred_to: a" in new


def test_a_name_in_an_anchor_is_renamed_once():
    text = (
        "elements:\n  disc: {type: inertia, node: &n hub, inertia: 2}\n  more: {type: inertia, node: *n, inertia: 3}\n"
    )
    new = edited(text, rename(text, text.index("hub"), "rim"))
    assert new == text.replace("hub", "rim")


def test_a_name_spelled_with_escapes_is_not_renamed():
    text = 'elements:\n  a: {type: inertia, node: hub, inertia: 2}\n  b: {type: inertia, node: "h\\x75b", inertia: 3}\n'
    with pytest.raises(UsageError, match="spelled with escapes"):
        rename(text, text.index("hub"), "rim")


def test_a_place_on_an_element_is_its_port_before_it_is_a_node():
    text = """\
torsionnet: 1
name: gears
elements:
  first: {type: inertia, node: first, inertia: 2 kg*m^2}
  wheel: {type: gear, nodes: [first, out], ratio: 2}
  load: {type: inertia, node: out, inertia: 2 kg*m^2}
sensors: {T: {torque: wheel, at: first}, T_out: {torque: wheel, at: out}}
"""
    new = edited(text, rename(text, text.index("node: first") + 6, "nose"))
    assert "{torque: wheel, at: first}" in new
    new = edited(text, rename(text, text.index("node: out") + 6, "end"))
    assert "{torque: wheel, at: end}" in new


def test_parts_of_the_library_are_used_by_their_names():
    text = library_texts()["front_wheel_drive_car"]
    kinds = {one.kind for one in named_places(text)}
    assert "use" in kinds or "part" in kinds


def test_definitions_and_references_of_parts():
    def at(marker, shift=0):
        found = definition(PLANT, PLANT.index(marker) + shift)
        return None if found is None else PLANT[: found.end].splitlines()[-1]

    assert at("left.spring", 6).strip() == "spring"
    assert at("left.spring", 1).strip() == "left"
    assert at("part: stage", 7).strip() == "stage"
    assert at("left.k", 5) == "    parameters: {k"
    assert at("hot,clutch", 1).endswith("cold: {}, hot")
    assert at("drive: T_a", 8).strip() == "T_a"
    assert len(references(PLANT, PLANT.index("part: stage") + 7)) == 3


def test_every_place_holds_its_name():
    for text in library_texts().values():
        for one in named_places(text):
            assert text[one.span.start : one.span.end] == one.name


def test_a_parameter_with_the_name_of_a_key_beside_it_is_renamed_in_the_value() -> None:
    text = (
        "parameters: {zeta: 0.01}\nelements:\n  s: {type: spring, nodes: [a, b], damping: {zeta: 2*zeta, at: 10 Hz}}\n"
    )
    new = edited(text, rename(text, text.index("zeta"), "D"))
    assert new == text.replace("{zeta: 0.01}", "{D: 0.01}").replace("2*zeta", "2*D")


def test_a_node_with_the_name_of_a_quantity_is_renamed_in_the_value() -> None:
    text = "elements: {a: {type: inertia, node: angle, inertia: 1 kg*m^2}}\nsensors: {phi: {angle: angle}}\n"
    new = edited(text, rename(text, text.index("angle"), "hub"))
    assert new == text.replace("node: angle", "node: hub").replace("{angle: angle}", "{angle: hub}")


@pytest.mark.parametrize("ends", ["  ", " \n", "\n "])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_names_on_the_line_behind_a_byte_order_mark(mark, ends):
    """Begin and end of a name move by the mark where they stand on its line, and only there."""
    first, second = ends
    lines = "torsionnet: 1,", "parameters: {J: 2},", "elements: {d: {type: inertia, node: a, inertia: J}}"
    text = f"{mark}{{{lines[0]}{first}{lines[1]}{second}{lines[2]}}}"
    for at in (text.index("J: 2"), text.index("J}}")):
        new = edited(text, rename(text, at, "J_motor"))
        assert new == text.replace("{J: 2}", "{J_motor: 2}").replace("inertia: J}", "inertia: J_motor}")
    assert [text[one.span.start : one.span.end] for one in named_places(text)].count("J") == 2
