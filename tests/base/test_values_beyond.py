"""Values of parameters, of alternatives and of parts at which an element has no law: said in its words, never a traceback."""

import pytest

import torsionnet as tn
from torsionnet.base.errors import ModelError

LIMITED = {
    "the rated torque must not be above the breakdown torque": (
        "{type: induction_machine, node: a, synchronous_speed: 100, breakdown_torque: p, rated_torque: 2, rated_slip: 2 %}",
        1,
    ),
    "the torque must not be above the pull-out torque": (
        "{type: synchronous_machine, node: a, pull_out_torque: p, torque: 2, pole_pairs: 2}",
        1,
    ),
    "the power must not be above E V/X": (
        "{type: grid_generator, node: a, rated_power: 1 MW, speed: 3000 rpm, grid_frequency: 50, inertia_constant: 3,"
        " emf: p, grid_voltage: 1, reactance: 1, power: 0.9}",
        0.5,
    ),
    "something is divided by zero": (
        "{type: dual_mass_flywheel, nodes: [a, b], primary_inertia: 1, secondary_inertia: 1, stiffness: 9, blocked: p}",
        1,
    ),
}
ELEMENTS = "elements:\n{0}  m: {{type: inertia, node: a, inertia: 1}}\n{0}  e: {1}\n"
FLAT = "torsionnet: 1\nname: x\nparameters: {{p: {2}}}\n" + ELEMENTS
PART = (
    "torsionnet: 1\nname: x\nparts:\n  z:\n    ports: [a]\n    parameters: {{p: {3}}}\n    "
    + ELEMENTS
    + "use: {{u: {{part: z, at: {{a: n}}, parameters: {{p: {2}}}}}}}\n"
)


@pytest.mark.parametrize(("reason", "case"), LIMITED.items(), ids=list(LIMITED))
def test_reason(reason, case):
    element, bad = case
    good = 0.5 if bad == 1 and "blocked" in element else 4
    axis = f"configurations: {{c: {{ok: {{}}, bad: {{p: {bad}}}}}}}\n"
    for text in (
        FLAT.format("", element, bad),
        PART.format("    ", element, bad, good),
        FLAT.format("", element, good) + axis,
    ):
        with pytest.raises(ModelError, match=reason) as caught:
            tn.loads(text)
        assert all(fault.position.line > 1 for fault in caught.value.faults)
    with pytest.raises(ModelError, match=reason):
        tn.loads(FLAT.format("", element, good)).configured(p=bad).modes()


def test_a_size_beyond_all_numbers(tmp_path):
    (tmp_path / "c.csv").write_text("size;stiffness [kN*m/rad]\nA;1e309\n")
    path = tmp_path / "m.yaml"
    path.write_text(
        "torsionnet: 1\nname: x\nelements:\n  m: {type: inertia, node: a, inertia: 1}\n"
        "  s: {type: spring, nodes: [a, ground], catalogue: c.csv, size: A}\n"
    )
    with pytest.raises(ModelError):
        tn.load(path)


def test_a_controller_that_moves_nothing():
    """Its own pole stays, without motion; warnings would be errors here."""
    law = {"numerator": [1], "denominator": [1, 2]}
    held = tn.Drivetrain(
        "held",
        [
            tn.Inertia("m", node="a", inertia=1),
            tn.Spring("s", nodes=("a", "ground"), stiffness=9),
            tn.Inertia("w", node="b", inertia=1),
            tn.Lock("l", node="b"),
            tn.Controller("c", sense={"velocity": "a"}, act="b", law=law),
        ],
    )
    assert sorted(abs(held.modes().eigenvalues)) == pytest.approx([2, 3])


def test_a_link_to_itself(tmp_path):
    (tmp_path / "loop.yaml").symlink_to("loop.yaml")
    path = tmp_path / "m.yaml"
    path.write_text(
        "torsionnet: 1\nname: x\ninclude: [loop.yaml]\nelements:\n  m: {type: inertia, node: a, inertia: 1}\n"
    )
    with pytest.raises(ModelError, match="there is no file"):
        tn.load(path)
