"""Active elements: torques that follow the motion of some node, against dense matrices written down here."""

import numpy as np
import pytest
from support.controlled_plants import FREQUENCIES, Plant

import torsionnet as tn


class TestFrequencyResponse:
    @pytest.mark.parametrize("seed", range(30))
    @pytest.mark.parametrize("method", ["auto", "dense"])
    def test_is_that_of_dense_matrices(self, seed, method):
        plant = Plant(seed, delay=seed % 2 > 0)
        outputs = [f"n{node}" for node in range(plant.n)] + ["torque(act0)", "torque(k1)"]
        found = plant.rig.frequency_response(outputs, ["n0", "n1"], FREQUENCIES, method=method).values
        for f, value in zip(FREQUENCIES, found, strict=True):
            s = 2j * np.pi * f
            motion = np.linalg.inv(plant.dynamic_stiffness(s))[:, :2]
            spring = plant.elements[plant.n]
            twist = np.array([motion[int(node[1:])] for node in spring.nodes])
            kappa = float(spring.stiffness.value) + s * float(spring.damping.value)
            expected = np.vstack([motion, plant.torque(0, motion, s), kappa * (twist[0] - twist[1])])
            assert np.allclose(value, expected, rtol=1e-10, atol=1e-10 * np.abs(expected).max(axis=0))

    def test_against_a_measured_input(self):
        """Torque over speed, both read with the loop closed."""
        plant = Plant(3)
        found = plant.rig.frequency_response("n2", "velocity(n1)", FREQUENCIES, driven_by="n0").values[:, 0, 0]
        for f, value in zip(FREQUENCIES, found, strict=True):
            s = 2j * np.pi * f
            motion = np.linalg.inv(plant.dynamic_stiffness(s))[:, 0]
            assert value == pytest.approx(motion[2] / (s * motion[1]), rel=1e-10)

    def test_a_rigid_coupling_hands_on_what_a_controller_applies_behind_it(self):
        elements = [
            tn.Inertia("one", node="a", inertia=2),
            tn.RigidCoupling("joint", nodes=("a", "b")),
            tn.Inertia("two", node="b", inertia=3),
            tn.Spring("hold", nodes=("a", "ground"), stiffness=100),
            tn.Controller("brake", sense={"velocity": "a"}, act="b", law=-4, delay="50 ms"),
        ]
        s = 2j * np.pi * 1.5
        kappa = -4 * s * np.exp(-0.05 * s)
        motion = 1 / (5 * s**2 + 100 - kappa)
        H = tn.Drivetrain("two", elements).frequency_response(["torque(joint)", "torque(brake)"], "a", [1.5])
        assert H.values[0, :, 0] == pytest.approx([3 * s**2 * motion - kappa * motion, kappa * motion], rel=1e-12)

    def test_at_rest_an_integral_holds_what_nothing_else_does(self):
        elements = [
            tn.Inertia("rotor", node="a", inertia=2),
            tn.Controller("governor", sense={"velocity": "a"}, act="a", law={"p": -4, "i": -50}),
        ]
        H = tn.Drivetrain("governed", elements).frequency_response("a", "a", [0.0])
        assert H.values.item() == pytest.approx(1 / 50, rel=1e-12)

    def test_digits_lost_in_a_stiff_loop_are_found_again(self):
        """A gain of 1e13 holds the node almost still; what is left is the difference of two large numbers."""
        elements = [
            tn.Inertia("one", node="a", inertia=1),
            tn.Spring("shaft", nodes=("a", "b"), stiffness=100),
            tn.Inertia("two", node="b", inertia=1),
            tn.Controller("hold", sense={"angle": "a"}, act="a", law=-1e13),
        ]
        f = 0.5
        s = 2j * np.pi * f
        H = tn.Drivetrain("held", elements).frequency_response("a", "a", [f])
        expected = 1 / (1e13 + s**2 + 100 * s**2 / (s**2 + 100))
        assert H.values.item() == pytest.approx(expected, rel=1e-12)

    def test_a_plant_connected_by_a_controller_alone_feels_the_other_side(self):
        elements = [
            tn.Inertia("one", node="a", inertia=1),
            tn.Inertia("two", node="b", inertia=2),
            tn.Controller("link", sense={"angle": "a"}, act="b", law=7),
        ]
        H = tn.Drivetrain("linked", elements).frequency_response("b", "a", [1.0], method="auto")
        s = 2j * np.pi
        assert H.values.item() == pytest.approx(7 / (s**2 * 2 * s**2), rel=1e-12)
        with pytest.raises(tn.UsageError, match="stays zero"):
            tn.Drivetrain("linked", elements).frequency_response("b", "angle(a)", [1.0], driven_by="b")
