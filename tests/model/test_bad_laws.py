"""Bad input of springs, clearances, friction and backlash, located, and what checks note of them."""

import re

import pytest

import torsionnet as tn
from torsionnet.model.files.reader import read_text

MODEL = """\
torsionnet: 1
parameters: {{b: 0.2 deg, T_s: 10 N*m}}
elements:
  j: {{type: inertia, node: a, inertia: 2}}
  {entries}
  i: {{type: inertia, node: b, inertia: 3}}
"""


STAGE = "{stiffness: 9, to: 4 N*m}"
FAULTS = [  # a mark stands where the fault is told, and the kinds in their order
    ("^e: {type: spring, nodes: [a, b]}", ["missing-entry"]),
    (
        "e: {type: spring, nodes: [a, b], stiffness: 3, ^stages: [{stiffness: 3}], inner_diameter: ^3 mm}",
        ["contradicting-entries", "missing-entry"],
    ),
    (
        "e: {type: spring, nodes: [a, b], stages: [{stiffness: 3}], ^cubic: 4}",
        ["missing-entry"],
    ),
    (
        f"e: {{type: spring, nodes: [a, b], stages: [{STAGE}, {{stiffness: 8, to: ^3 N*m}}, "
        "{stiffness: 7, preload: 2 N*m, to: ^5 N*m}]}",
        ["unordered-rows", "unordered-rows"],
    ),
    (
        "e: {type: spring, nodes: [a, b], stages: [{stiffness: ^0, preload: ^-1 N*m, to: ^5}, {stiffness: ^3 kg}]}",
        ["out-of-range", "out-of-range", "missing-unit", "wrong-unit"],
    ),
    (
        "e: {type: spring, nodes: [a, b], stages: [{stiffness: 9, to: ^3 N*m/deg}, {stiffness: 3}]}",
        ["wrong-unit"],
    ),
    (
        "e: {type: spring, nodes: [a, b], stages: [{stiffness: 9, to: ^b}, {stiffness: 3}]}",
        ["expression-not-allowed"],
    ),
    (
        "e: {type: spring, nodes: [a, b], stages: [{stiffness: 9, to: 0.2 rad}, {stiffness: 8, to: ^0.1 rad}]}",
        ["unordered-rows"],
    ),
    (
        "e: {type: spring, nodes: [a, b], stages: [^{stiffness: 9}, ^{stiffness: 8}, {stiffness: 8}]}",
        ["missing-entry", "missing-entry"],
    ),
    (
        "e: {type: spring, nodes: [a, b], stages: [{stiffness: 9, to: 1 deg, ^to_torque: 2}, {stiffness: 8}]}",
        ["contradicting-entries"],
    ),
    (
        "e: {type: spring, nodes: [a, b], stages: [{stiffness: 9, to_torque: T_s}, {stiffness: 9, to_torque: ^T_s/2}]}",
        ["unordered-rows"],
    ),
    (
        "e: {type: spring, nodes: [a, b], torque_over_twist: [[0, 0], [b, T_s], [^b/2, 30]]}",
        ["unordered-rows"],
    ),
    (
        "e: {type: spring, nodes: [a, b], torque_over_twist: [[0, T_s], ^[b, 0.5*T_s], [3*b, 20]]}",
        ["negative-law"],
    ),
    (
        "e: {type: clutch, nodes: [a, b], state: slipping, torque: [[0, 20], [5, 18]], stick: ^19 N*m}",
        ["contradicting-values"],
    ),
    (
        "e: {type: clutch, nodes: [a, b], state: slipping, slip_speed: 3, torque: [[-5, -18], [5, 18]], ^stick: 30}",
        ["unfit-curve"],
    ),
    ("e: {type: friction, nodes: [a, b], torque_over_slip: [[0, ^0*T_s], [3, 2]]}", ["unfit-curve"]),
    (
        "e: {type: dual_mass_flywheel, nodes: [a, b], primary_inertia: 1, secondary_inertia: 1, torque: ^2*T_s, "
        "stages: [{stiffness: 9, to_torque: T_s}]}",
        ["contradicting-values"],
    ),
    (
        "e: {type: spring, nodes: [a, b], torque_over_twist: [[-1, 3], ^[0, 2], ^[1, 1]]}",
        ["negative-law", "negative-law"],
    ),
    (
        "e: {type: spring, nodes: [a, b], torque_over_twist: [^[0.1, 3], [1, 4]]}",
        ["unfit-curve"],
    ),
    (
        "e: {type: spring, nodes: [a, b], torque_over_twist: [[0, ^-3], [1, 4]]}",
        ["unfit-curve"],
    ),
    (
        "e: {type: spring, nodes: [a, b], torque_over_twist: [[-1, 4], ^[1, 4]]}",
        ["unfit-curve"],
    ),
    (
        "e: {type: clearance, nodes: [a, b], gap: ^0, stiffness: ^0, damping: ^-1}",
        ["out-of-range", "out-of-range", "out-of-range"],
    ),
    (
        "e: {type: spring, nodes: [a, b], stiffness: 0, cubic: ^-4}",
        ["negative-law"],
    ),
    ("e: {type: spring, nodes: [a, b], stiffness: 0*T_s, cubic: ^0}", ["negative-law"]),
    ("e: {type: clearance, nodes: [a, b], gap: ^-b, stiffness: 5}", ["out-of-range"]),
    ("e: {type: clearance, nodes: [a, b], ^backlash: 1 deg, stiffness: 5}", ["unknown-entry"]),
    ("e: {type: ^dead_zone, nodes: [a, b], gap: 1 deg, stiffness: 5}", ["unknown-word"]),
    ("e: {type: ^coulomb, nodes: [a, b], torque: 5}", ["unknown-word"]),
    (
        "e: {type: inertia, node: a, inertia: ^-1, ^frob: 2}",
        ["out-of-range", "unknown-entry"],
    ),
    (
        "e: {type: spring, nodes: [a, b], ^stifness: 3, damping: ^-1}",
        ["unknown-entry", "out-of-range"],
    ),
    (
        "e: {type: shaft, nodes: [a, b], outer_diameter: ^-1e308 mm, length: 1 m}",
        ["implausible-size"],
    ),
    ("^e: {type: friction, nodes: [a, b]}", ["missing-entry"]),
    (
        "e: {type: friction, nodes: [a, b], torque: 20 N*m, stick: ^19 N*m}",
        ["contradicting-values"],
    ),
    (
        "e: {type: friction, nodes: [a, b], torque: 20 N*m, stick: ^T_s}",
        ["contradicting-values"],
    ),
    (
        "e: {type: friction, nodes: [a, b], torque_over_slip: [[^1, ^0], [3, 2]]}",
        ["unfit-curve", "unfit-curve"],
    ),
    ("e: {type: friction, nodes: [a, b], torque_over_slip: [[^-1, 2], [3, 2]]}", ["out-of-range"]),
    ("e: {type: gear, nodes: [a, b], ratio: 2, backlash: ^1 deg}", ["missing-entry"]),
    ("e: {type: gear, nodes: [a, b], ratio: 2, stiffness: 9, ^lash: 1 deg}", ["unknown-entry"]),
]


@pytest.mark.parametrize(("entries", "kinds"), FAULTS)
def test_bad_input_is_said_where_it_stands(entries, kinds):
    text = MODEL.format(entries=entries.replace("^", ""))
    _, found = read_text(text, "model.yaml")
    wrong = [fault for fault in found if fault.severity == "error"]
    marks = [place.start() - number for number, place in enumerate(re.finditer(r"\^", entries))]
    assert [(fault.position.line, fault.position.column) for fault in wrong] == [(5, 3 + at) for at in marks]
    assert [fault.kind for fault in wrong] == kinds


def findings(*lines, more=""):
    text = "torsionnet: 1\nelements:\n" + "".join(f"  {line}\n" for line in lines) + more
    return [(fault.severity, fault.message) for fault in read_text(text, "model.yaml")[1]]


class TestChecks:
    MASSES = ("i: {type: inertia, node: a, inertia: 1}", "j: {type: inertia, node: b, inertia: 2}")

    def test_a_gap_is_a_free_motion(self):
        mesh = "mesh: {type: clearance, nodes: [a, b], gap: 1 deg, stiffness: 5}"
        (free, gap) = findings(*self.MASSES, mesh)
        assert free == ("note", "the drivetrain can turn freely: 2 rigid-body modes")
        assert gap[0] == "note"
        assert gap[1].startswith("mesh stands open in linear results")
        loaded = findings(*self.MASSES, mesh, more="operating_point: {torque: {a: 9, b: -9}}\n")
        assert not any("stands open" in text for _, text in loaded)

    @pytest.mark.parametrize(
        ("other", "loop"),
        [
            ("f: {type: friction, nodes: [a, b], torque: 4}", True),
            ("f: {type: friction, nodes: [a, b], torque: 4, stiffness: 90}", False),
            ("f: {type: spring, nodes: [b, a], stages: [{stiffness: 9, preload: 4}]}", True),
            ("f: {type: friction, nodes: [b, ground], torque: 4}", False),
            ("f: {type: clutch, nodes: [b, a], state: slipping, torque: [[0, 30], [10, 20]]}", True),
            ("f: {type: rigid_coupling, nodes: [a, b]}", False),
        ],
    )
    def test_two_that_stick_side_by_side_are_asked_for_a_stiffness(self, other, loop):
        found = findings(*self.MASSES, "e: {type: friction, nodes: [a, b], torque: 3}", other)
        told = [text for severity, text in found if "stick in a loop" in text]
        assert len(told) == loop
        assert all(text.startswith("e and f stick") and "of them a stiffness" in text for text in told)

    def test_a_loop_of_three(self):
        rubs = [f"{name}: {{type: friction, nodes: [{ends}], torque: 3}}"
                for name, ends in (("e", "a, b"), ("f", "b, ground"), ("g", "a, ground"))]  # fmt: skip
        told = [text for _, text in findings(*self.MASSES, *rubs) if "stick in a loop" in text]
        assert [text.split(" stick")[0] for text in told] == ["e and f and g"]

    def test_between_locked_nodes_nothing_is_open_or_sticks(self):
        """Neither can move anyway, so that there is nothing to note."""
        locks = ("l: {type: lock, node: a}", "m: {type: lock, node: b}", "c: {type: inertia, node: c, inertia: 1}")
        more = "k: {type: spring, nodes: [b, c], stiffness: 9}"
        for entries in ("clearance, gap: 1 deg, stiffness: 5", "friction, torque: 3"):
            found = findings(*self.MASSES, *locks, more, f"e: {{type: {entries}, nodes: [a, b]}}")
            assert not [text for _, text in found if text.startswith("e ")]

    def test_a_torque_on_what_friction_holds_is_no_mistake(self):
        """It moves where the friction slips; one on what a lock holds never does."""
        rub = "rub: {type: friction, nodes: [b, ground], torque: 5}"
        spring = "k: {type: spring, nodes: [a, b], stiffness: 9}"
        given = "inputs: {T: {torque: b}}\n"
        stuck, found = findings(*self.MASSES, spring, rub, more=given)
        assert found[0] == "note"
        assert stuck[1].startswith("rub sticks in linear results, and is rigid there; give stiffness, of what yields")
        assert found[1].startswith('input T does nothing: "b" is locked, in linear results at an operating point where')
        locked = findings(*self.MASSES, spring, rub, "lock: {type: lock, node: b}", more=given)
        assert "error" in [severity for severity, said in locked if said.startswith("input T")]

    @pytest.mark.parametrize(
        ("entries", "hint"),
        [
            ("dual_mass_flywheel, primary_inertia: 1, secondary_inertia: 1, stiffness: 500, friction: 3", "give swing"),
            ("clutch, state: slipping, torque: [[0, 30], [10, 20]]", "give slip_speed, or an operating point"),
        ],
    )
    def test_what_sticks_is_rigid_and_said_to_be(self, entries, hint):
        def noted(added="", more=""):
            found = findings(*self.MASSES, f"e: {{type: {entries}, nodes: [a, b]{added}}}", more=more)
            return [text for severity, text in found if severity == "note" and "sticks in linear results" in text]

        (note,) = noted()
        assert note.startswith(f"e sticks in linear results, and is rigid there; {hint}")
        assert not noted(", slip_speed: 5" if "clutch" in entries else ", swing: 3 deg")
        loaded = "operating_point: {torque: {a: 9, b: -9}}\n"
        assert len(noted(more=loaded)) == (0 if "clutch" in entries else 1)

    def test_friction_may_stand_between_shafts_of_other_speeds(self):
        """Stuck, it locks the gears with which it closes a loop; slipping, it does not."""
        gears = ("g: {type: gear, nodes: [a, b], ratio: 3}", "rub: {type: friction, nodes: [a, b], torque: 5}")
        assert not [text for severity, text in findings(*self.MASSES, *gears) if severity == "error"]
        rigid = (gears[0], "c: {type: rigid_coupling, nodes: [a, b]}")
        assert [text for severity, text in findings(*self.MASSES, *rigid) if severity == "error"]

    def test_a_plain_model_is_read_no_operating_value(self):
        """Springs and friction have no entry at which their rows would be read."""
        ends = {"nodes": ("a", "b")}
        assert not tn.Spring("e", **ends, stages=[{"stiffness": 9, "to": "1 deg"}, {"stiffness": 20}]).reads_off
        assert not tn.Friction("e", **ends, torque_over_slip=[[0, 20], [5, 12]]).reads_off
