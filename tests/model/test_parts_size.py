"""Files of a few lines that would make models without end: refused soon, with the line that asks for too much."""

import time

import pytest

import torsionnet as tn
from torsionnet.base.errors import ModelError

THROW = """\
torsionnet: 1
name: throws
parts:
  p0:
    ports: [a, b]
    elements:
      mass: {type: inertia, node: a, inertia: 1}
      shaft: {type: spring, nodes: [a, b], stiffness: 100}
"""
LAST = "use: {x: {part: %s, at: {a: n0, b: n1}}}\n"


def nested(levels, copies):
    parts = [
        f"  p{level}:\n    ports: [a, b]\n"
        f"    use: {{c: {{part: p{level - 1}, repeat: {copies}, chain: [a, b], at: {{a: a, b: b}}}}}}\n"
        for level in range(1, levels + 1)
    ]
    return THROW + "".join(parts) + LAST % f"p{levels}"


def refused(text, message):
    began = time.process_time()
    with pytest.raises(ModelError, match=message) as caught:
        tn.loads(text)
    assert time.process_time() - began < 2
    return caught.value.faults


def test_parts_that_hold_each_other_many_times():
    """Ten levels of ten: 10**10 throws. Nothing else is said of the parts above, which cannot be put together."""
    faults = refused(nested(10, 10), "this makes 20000 entries")
    assert [fault.position.line for fault in faults] == [20]


def test_parts_nested_deeply():
    faults = refused(nested(500, 1), r":1451:21: .*20.*too-large")
    assert len(faults) == 1
    assert len(tn.loads(nested(19, 1)).elements) == 2


def test_a_part_of_many_ports():
    ports = ", ".join(f"a{index}" for index in range(3000))
    refused(THROW.replace("[a, b]", f"[{ports}]", 1) + LAST % "p0", r":5:13: .*unknown-node")


def test_a_gearbox_of_many_gears():
    ratios = ", ".join(f"g{index}: {index + 1}" for index in range(3000))
    box = f"elements: {{box: {{type: gearbox, input: a, output: b, engaged: neutral, ratios: {{{ratios}}}}}}}\n"
    refused(f"torsionnet: 1\nname: box\n{box}", r":3:80: .*3000.*100.*too-large")


@pytest.mark.parametrize("name", ["in", "lambda", "omega"])
def test_a_name_that_no_parameter_may_have(name):
    """Parameters of the part begin with it: flat, the model could not be read again."""
    text = THROW.replace("    elements:", "    parameters: {k: 1}\n    elements:")
    refused(text + LAST.replace("x:", f"{name}:") % "p0", f'"{name}" is (a word of the Python language|reserved)')
    with pytest.raises(ModelError, match=f'"{name}" is'):
        tn.loads("torsionnet: 1\nname: x\nelements: {m: {type: inertia, node: a, inertia: 1}}\n").with_part(
            name,
            tn.Drivetrain("p", [tn.Inertia("m", node="a", inertia="J")], parameters={"J": 1}, ports=["a"]),
            at={"a": "a"},
        )
