"""Motion of modes as the page draws it: closed forms, the library's own mode shapes, and the requests for them."""

import json
import math

import numpy as np
import pytest
from support.drawn_models import inertia
from support.library_cases import library_cases

import torsionnet as tn
from torsionnet.app.explore import Documents, open_session
from torsionnet.app.explore.answers import mean_torques, mode_motion
from torsionnet.app.explore.api import motion_answer, reply, schematic_answer
from torsionnet.app.explore.state import State

ROUNDED = 1e-6
"""Amplitudes and phases have six decimals."""


@pytest.fixture(scope="module")
def documents():
    return Documents.of(open_session("dmf_rig"))


def motion(model):
    return mode_motion(model, model.modes())


def discs(first, second, stiffness):
    return tn.Drivetrain(
        "two discs",
        [inertia("J1", "a", first), inertia("J2", "b", second), tn.Spring("k", nodes=("a", "b"), stiffness=stiffness)],
    )


class TestClosedForms:
    def test_two_discs_swing_against_each_other_as_their_inertias(self):
        found = motion(discs(6.0, 1.5, 900.0))
        rigid, swing = found["modes"]
        assert (rigid["kind"], rigid["name"], rigid["frequency_hz"], rigid["damping_ratio"]) == (
            "rigid body",
            "rigid body",
            0.0,
            None,
        )
        assert rigid["nodes"] == {"a": [1.0, 0.0], "b": [1.0, 0.0]}
        # omega^2 = k (1/J1 + 1/J2), theta_a/theta_b = -J2/J1
        assert swing["frequency_hz"] == pytest.approx(math.sqrt(900 * (1 / 6 + 1 / 1.5)) / (2 * math.pi), rel=1e-12)
        assert swing["nodes"]["b"][0] == 1.0
        assert swing["nodes"]["a"][0] == pytest.approx(1.5 / 6, abs=ROUNDED)
        assert abs(swing["nodes"]["a"][1] - swing["nodes"]["b"][1]) == pytest.approx(math.pi, abs=2 * ROUNDED)
        assert swing["damping_ratio"] == pytest.approx(0, abs=1e-12)
        assert swing["strain"] == {"k": 1.0}
        assert found["elements"]["k"] == {"type": "spring", "nodes": ["a", "b"], "values": "k = 900 N·m/rad"}

    @pytest.mark.parametrize("ratio", [4.0, -2.5])
    def test_a_node_behind_a_rigid_gear_turns_by_its_ratio(self, ratio):
        """Speed of the first node over that of the second is tau; the second has no coordinate of its own."""
        model = tn.Drivetrain(
            "geared",
            [
                inertia("J1", "a", 2.0),
                tn.Gear("gear", nodes=("b", "c"), ratio=ratio),
                inertia("J3", "c", 3.0),
                tn.Spring("k", nodes=("a", "b"), stiffness=50.0),
            ],
        )
        for mode in motion(model)["modes"]:
            b, c = mode["nodes"]["b"], mode["nodes"]["c"]
            assert c[0] == pytest.approx(b[0] / abs(ratio), abs=2 * ROUNDED)
            apart = 0.0 if ratio > 0 else math.pi
            assert abs(b[1] - c[1]) == pytest.approx(apart, abs=2 * ROUNDED)
            assert max(amplitude for amplitude, _ in mode["nodes"].values()) == 1.0

    def test_a_fast_end_behind_a_gear_has_the_largest_motion(self):
        model = tn.Drivetrain(
            "fast", [inertia("J1", "a", 2.0), tn.Gear("gear", nodes=("a", "b"), ratio=0.25), inertia("J2", "b", 1.0)]
        )
        (rigid,) = motion(model)["modes"]
        assert rigid["nodes"] == {"a": [0.25, 0.0], "b": [1.0, 0.0]}

    def test_damping_turns_the_phases(self):
        """One disc on a spring, a second on a damper to the first: the second lags."""
        model = tn.Drivetrain(
            "lag",
            [
                inertia("J1", "a", 1.0),
                inertia("J2", "b", 0.2),
                tn.Spring("k", nodes=("a", "ground"), stiffness=100.0),
                tn.Damper("c", nodes=("a", "b"), damping=1.0),
            ],
        )
        swing = next(mode for mode in motion(model)["modes"] if mode["kind"] == "oscillatory")
        s = (
            complex(-swing["damping_ratio"], math.sqrt(1 - swing["damping_ratio"] ** 2))
            * 2
            * math.pi
            * swing["frequency_hz"]
        )
        expected = 1.0 / (0.2 * s + 1.0)  # theta_b/theta_a = c/(J2 s + c)
        (a, phase_a), (b, phase_b) = swing["nodes"]["a"], swing["nodes"]["b"]
        assert b / a == pytest.approx(abs(expected), abs=1e-5)
        assert math.remainder(phase_b - phase_a - np.angle(expected), 2 * math.pi) == pytest.approx(0, abs=1e-5)

    def test_a_node_that_is_held_stands_still(self):
        model = tn.Drivetrain(
            "held",
            [
                inertia("J", "a"),
                tn.Spring("k", nodes=("a", "b"), stiffness=9.0),
                tn.Lock("lock", node="b"),
                inertia("Jb", "b"),
            ],
        )
        (mode,) = motion(model)["modes"]
        assert mode["nodes"] == {"a": [1.0, 0.0], "b": [0.0, 0.0]}


class TestLibrary:
    @pytest.mark.few(3)
    @pytest.mark.parametrize("name", library_cases())
    def test_motion_is_the_shape_of_each_mode_at_every_node(self, name):
        session = open_session(name)
        modes = session.base.modes()
        found = motion_answer(session, State())
        assert json.loads(json.dumps(found, allow_nan=False))
        assert [mode["kind"] for mode in found["modes"]] == list(modes.kinds)
        for number, mode in enumerate(found["modes"]):
            assert list(mode["nodes"]) == list(session.base.nodes)
            moved = np.array([amplitude * np.exp(1j * phase) for amplitude, phase in mode["nodes"].values()])
            shape = modes.shapes[:, number]
            np.testing.assert_allclose(moved, shape / np.abs(shape).max(), atol=3 * ROUNDED)
            assert max(amplitude for amplitude, _ in mode["nodes"].values()) == 1.0
        assert list(found["elements"]) == list(session.base.elements)

    def test_mean_torques_are_those_of_the_static_state(self):
        ship = tn.load("two_stroke_ship")
        found, state = mean_torques(ship), ship.static_state()
        assert found["tail"] == state.of("tail").torque
        # Power over speed: all of it goes through the tail shaft.
        assert abs(found["tail"]) == pytest.approx(max(map(abs, state.external.values())), rel=1e-9)
        assert mean_torques(tn.load("dmf_rig")) == {}

    def test_a_configuration_and_the_sliders_count(self):
        session = open_session("amt_rig")
        state = State({"gear": "V"}, {"c_O": "360 N*m*s/rad"})
        rig = tn.load("amt_rig").configured("V", c_O=360)
        found = motion_answer(session, state)
        np.testing.assert_array_equal(
            [mode["frequency_hz"] for mode in found["modes"]], rig.modes().natural_frequencies
        )
        drawing = schematic_answer(session, state)
        assert list(drawing["elements"]) == list(rig.elements)
        assert "360 N·m·s/rad" in drawing["svg"]
        assert "360 N·m·s/rad" not in schematic_answer(session, State({"gear": "V"}))["svg"]


def test_of_a_large_model_the_lowest_modes_move(tmp_path):
    """A chain of equal discs, free at both ends: omega_n = 2 sqrt(k/J) sin(n pi/(2 N))."""
    count, elements = 130, []
    for place in range(count):
        elements.append(f"  J{place}: {{type: inertia, node: n{place}, inertia: 2 kg*m^2}}")
        if place:
            elements.append(f"  k{place}: {{type: spring, nodes: [n{place - 1}, n{place}], stiffness: 800 N*m/rad}}")
    path = tmp_path / "chain.yaml"
    inputs = "inputs:\n  T: {torque: n0}\n"
    path.write_text("torsionnet: 1\nname: chain\nelements:\n" + "\n".join(elements) + f"\n{inputs}", encoding="utf-8")
    found = motion_answer(open_session(path), State())
    expected = [2 * math.sqrt(800 / 2) * math.sin(n * math.pi / (2 * count)) / (2 * math.pi) for n in range(12)]
    np.testing.assert_allclose([mode["frequency_hz"] for mode in found["modes"]], expected, rtol=1e-8, atol=1e-6)
    assert found["notes"][0] == "130 nodes: the 12 lowest modes can be moved"
    # Both ends swing alike, in phase for even numbers and against each other for odd ones.
    for number, mode in enumerate(found["modes"]):
        (first, phase), (last, other) = mode["nodes"]["n0"], mode["nodes"][f"n{count - 1}"]
        assert first == pytest.approx(last, abs=1e-4)
        assert math.cos(phase - other) == pytest.approx((-1) ** number, abs=1e-4)


class TestRequests:
    def test_pictures_are_answered_with_the_revision(self, documents):
        drawing, moved = (
            json.loads(reply(documents, path, b'{"document": "tab"}')) for path in ("api/schematic", "api/motion")
        )
        assert set(drawing) == {"revision", "svg", "elements", "nodes", "size"}
        assert {"revision", "modes", "elements"} <= set(moved)
        assert set(moved["elements"]) == set(drawing["elements"])
        assert all(set(mode["nodes"]) == set(drawing["nodes"]) for mode in moved["modes"])

    @pytest.mark.parametrize("path", ["api/schematic", "api/motion"])
    def test_an_impossible_state_is_refused_in_words(self, documents, path):
        session = documents.named("").examined().sound.session
        name = next(iter(session.base.parameters))
        found = json.loads(reply(documents, path, json.dumps({"values": {name: "3 bananas"}}).encode()))
        assert found["refused"]
        assert "svg" not in found

    def test_what_depends_on_nothing_new_is_not_made_again(self):
        session = open_session("dmf_rig")
        first = schematic_answer(session, State(output="theta_1"))
        assert schematic_answer(session, State(band=(1.0, 20.0), axis="frequency")) is first
        name = next(iter(session.base.parameters))
        assert schematic_answer(session, State(values={name: 2 * session.base.parameters[name]})) is not first
