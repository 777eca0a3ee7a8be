"""Small models that once gave wrong numbers, beside closed forms, the same model written otherwise, or exact mechanics."""

import warnings
from fractions import Fraction

import numpy as np
import pytest
from oracle.answers import Answer, Question
from oracle.description import Model, Part, Reading
from oracle.package import drivetrain
from oracle.solution import Mechanics

import torsionnet as tn
from torsionnet.base.errors import UsageError
from torsionnet.linear.sensitivity.parametric import parametric_response

F = Fraction
LOW = np.array([1e-4, 1e-3, 0.01, 1.0])


def held_planetary(*more):
    return tn.Drivetrain(
        "planetary",
        [
            tn.Planetary("p", sun="s", ring="r", carrier="c", ratio=3, planet_inertia=0.1),
            tn.Damper("d", nodes=("r", "w"), damping=20),
            tn.Spring("k1", nodes=("s", "w"), stiffness=100),
            tn.Spring("k2", nodes=("c", "w"), stiffness=100),
            tn.Lock("l", node="w"),
            *more,
        ],
    )


def held_differential(*more):
    return tn.Drivetrain(
        "differential",
        [
            tn.Differential("D", cage="c", left="l", right="r"),
            tn.Spring("k", nodes=("w", "l"), stiffness=576900),
            tn.Inertia("J", node="r", inertia=5.027),
            tn.Damper("d", nodes=("c", "ground"), damping=16.72),
            tn.Lock("lock", node="w"),
            *more,
        ],
    )


def held_chain(*more):
    return tn.Drivetrain(
        "chain",
        [
            tn.Inertia("Ja", node="a", inertia=0.03),
            tn.Spring("k1", nodes=("a", "b"), stiffness=2765),
            tn.Damper("d", nodes=("c", "b"), damping=2318),
            tn.Spring("k2", nodes=("d", "c"), stiffness=237000),
            tn.Spring("k3", nodes=("w", "b"), stiffness=270600),
            tn.Spring("k4", nodes=("x", "w"), stiffness=37410),
            tn.Inertia("Jx", node="x", inertia=188),
            tn.Lock("lock", node="w"),
            *more,
        ],
    )


class TestInertiaOnALockedNode:
    """It stands still: everything is as without it, and without a warning."""

    @pytest.mark.parametrize("model", [held_planetary, held_differential, held_chain])
    def test_changes_no_pole(self, model):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with_it = model(tn.Inertia("J_w", node="w", inertia=5)).modes().eigenvalues
        np.testing.assert_allclose(with_it, model().modes().eigenvalues, rtol=1e-12, atol=1e-12)

    def test_poles_of_the_planetary_set(self):
        found = held_planetary(tn.Inertia("J_w", node="w", inertia=5)).modes().eigenvalues
        np.testing.assert_allclose(found, [-2.98126, -26.634 + 23.419j], rtol=2e-5)

    def test_pole_of_the_differential(self):
        found = held_differential(tn.Inertia("J_w", node="w", inertia=1)).modes().eigenvalues
        assert found[np.argmax(abs(found))] == pytest.approx(-138013.523, rel=1e-8)

    def test_vibrations_of_the_chain(self):
        """a against two springs in series, x against its own; c and d creep along behind the damper."""
        found = held_chain(tn.Inertia("J_w", node="w", inertia=1)).modes()
        series = 1 / (1 / 2765 + 1 / 270600)
        expected = sorted([np.sqrt(series / 0.03), np.sqrt(37410 / 188)])
        np.testing.assert_allclose(sorted(found.eigenvalues.imag[found.eigenvalues.imag > 0]), expected, rtol=1e-10)


class TestReadingsThatAreZero:
    """A shaft to a node on which nothing acts carries no torque."""

    def rig(self):
        elements = [tn.Inertia("J", node="a", inertia=1), tn.Spring("k", nodes=("a", "b"), stiffness=1e4)]
        return tn.Drivetrain("rig", elements, inputs={"T": {"torque": "a"}})

    def test_are_zero_at_rest_and_elsewhere(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            found = self.rig().frequency_response("torque(k)", "T", [0.0, 1.0, 50.0]).values
        assert not found.any()

    def test_are_refused_as_measured_inputs_by_name(self):
        with pytest.raises(UsageError, match=r"torque\(k\)"):
            self.rig().frequency_response("a", "torque(k)", [0.0, 1.0])


class TestImposedAngles:
    def test_torque_of_a_spring(self):
        """-k J w^2 / (k - J w^2) for J on a spring at an angle of 1."""
        elements = [
            tn.Inertia("Ja", node="a", inertia=1),
            tn.Spring("k", nodes=("a", "b"), stiffness=1e6),
            tn.Inertia("Jb", node="b", inertia=0.01),
        ]
        rig = tn.Drivetrain("rig", elements, inputs={"phi": {"angle": "a"}})
        found = rig.frequency_response("torque(k)", "phi", LOW).values[:, 0, 0]
        w2 = (2 * np.pi * LOW) ** 2
        np.testing.assert_allclose(found, -1e6 * 0.01 * w2 / (1e6 - 0.01 * w2), rtol=1e-12)

    def test_torque_of_a_compliant_gear(self):
        """The same with k on the first shaft and tau^2 k on the second, tau = 4."""
        gear = tn.Gear("g", nodes=("a", "b"), ratio=4, stiffness=2.9e7)
        rig = tn.Drivetrain("rig", [gear, tn.Inertia("J", node="b", inertia=0.5)], inputs={"phi": {"angle": "a"}})
        found = rig.frequency_response("torque(g)", "phi", LOW).values[:, 0, 0]
        w2, k = (2 * np.pi * LOW) ** 2, 2.9e7
        np.testing.assert_allclose(found, -k * 0.5 * w2 / (16 * k - 0.5 * w2), rtol=1e-12)

    def test_parameters_of_a_compliant_gear(self):
        """Values and derivative with respect to k, of k = 1.7e7, tau = 2 and J = 0.1."""
        gear = tn.Gear("g", nodes=("a", "b"), ratio=2, stiffness=1.7e7)
        rig = tn.Drivetrain("rig", [gear, tn.Inertia("J", node="b", inertia=0.1)], inputs={"phi": {"angle": "a"}})
        found = parametric_response(rig, "torque(g)", "phi", LOW, ["g.stiffness"]).evaluation([1.7e7])
        m, k = 0.1 * (2 * np.pi * LOW) ** 2, 1.7e7
        np.testing.assert_allclose(found.values[:, 0, 0], -k * m / (4 * k - m), rtol=1e-12)
        np.testing.assert_allclose(found.jacobian[:, 0, 0, 0], (m / (4 * k - m)) ** 2, rtol=1e-9)


class TestThreePorts:
    def test_torque_through_a_differential(self):
        parts = (
            Part("differential", "D", {"cage": "c", "left": "l", "right": "r", "locked": False}),
            Part("gear", "g", {"nodes": ("m", "r"), "ratio": F("-0.3935")}),
            Part("spring", "k1", {"nodes": ("m", "ground"), "stiffness": F(481600)}),
            Part("inertia", "J1", {"node": "l", "inertia": F("0.0018")}),
            Part("spring", "k2", {"nodes": ("c", "x"), "stiffness": F(1850)}),
            Part("inertia", "J2", {"node": "x", "inertia": F("5.8")}),
        )
        model = Model(parts, {"T": ("torque", "m")})
        answer = Answer(Mechanics(model), Question((Reading("torque", "D", "cage"),), (model.inputs["T"],), ()))
        expected = [complex(answer.at(f)[0][0]) for f in LOW]
        found = drivetrain(model).frequency_response("torque(D, cage)", "T", LOW).values[:, 0, 0]
        np.testing.assert_allclose(found, expected, rtol=1e-12)
