"""A ring on rubber against Den Hartog's closed forms and the same thing built of parts."""

import numpy as np
import pytest

import torsionnet as tn

J, K = 2.0, 8e4
OMEGA = np.sqrt(K / J)
HZ = OMEGA / (2 * np.pi)


def damped(**given):
    hub = given.get("hub_inertia", 0)
    return tn.Drivetrain(
        "damped",
        [
            tn.Inertia("mass", node="a", inertia=J - hub),
            tn.Spring("shaft", nodes=("a", "ground"), stiffness=K),
            tn.TunedDamper("damper", node="a", **given),
        ],
        inputs={"T": {"torque": "a"}},
        sensors={"theta": {"angle": "a"}, "ring": {"angle": "damper.ring"}, "taken": {"torque": "damper"}},
    )


def levels(beta, **given):
    """Angle over that of the spring at rest."""
    return damped(**given).frequency_response("theta", "T", np.asarray(beta) * HZ).magnitude.ravel() * K


@pytest.mark.parametrize("mu", [0.05, 0.2])
class TestDenHartog:
    """Mechanical Vibrations, chapter 3: the damped absorber."""

    def given(self, mu, zeta):
        return {"ring_inertia": mu * J, "natural_frequency": HZ / (1 + mu), "damping_ratio": zeta}

    def test_all_dampings_meet_in_two_points_of_one_height(self, mu):
        """beta^2 = (1 -+ sqrt(mu/(2 + mu)))/(1 + mu), and there sqrt(1 + 2/mu) times the angle at rest."""
        beta = np.sqrt((1 + np.array([-1, 1]) * np.sqrt(mu / (2 + mu))) / (1 + mu))
        for zeta in (0.01, 0.1, 0.7):
            np.testing.assert_allclose(levels(beta, **self.given(mu, zeta)), np.sqrt(1 + 2 / mu), rtol=1e-10)

    def test_the_best_damping_has_its_peaks_near_there(self, mu):
        beta = np.linspace(0.6, 1.3, 4001)
        best = np.sqrt(3 * mu / (8 * (1 + mu)))
        peaks = [levels(beta, **self.given(mu, factor * best)).max() for factor in (0.8, 1, 1.25)]
        assert peaks[1] == pytest.approx(np.sqrt(1 + 2 / mu), rel=5e-3)
        assert min(peaks[0], peaks[2]) > 1.02 * peaks[1]


def test_rubber_is_a_ring_on_a_hysteretic_spring():
    one = damped(ring_inertia=0.3, stiffness="9 kN*m/rad", loss_factor={"psi": 1.1}, hub_inertia=0.2)
    parts = tn.Drivetrain(
        "parts",
        [
            tn.Inertia("mass", node="a", inertia=J),
            tn.Spring("shaft", nodes=("a", "ground"), stiffness=K),
            tn.HystereticSpring("layer", nodes=("a", "r"), stiffness=9e3, loss_factor=1.1 / (2 * np.pi)),
            tn.Inertia("ring", node="r", inertia=0.3),
        ],
        inputs={"T": {"torque": "a"}},
        sensors={"theta": {"angle": "a"}, "ring": {"angle": "r"}},
    )
    f = [3.0, 26.0, 40.0]
    found, expected = (rig.frequency_response(["theta", "ring"], "T", f).values for rig in (one, parts))
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_viscous_damping_by_a_measure_at_a_frequency():
    one = damped(ring_inertia=0.3, stiffness=9e3, damping={"eta": 0.2, "at": "27 Hz"})
    assert one.elements["damper"].parts(tn.model.elements.Values({}))[0].damping == pytest.approx(
        0.2 * 9e3 / (2 * np.pi * 27)
    )


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, r"elements\.d: .*missing-entry"),
        ({"stiffness": 1, "natural_frequency": 2}, "not both"),
        (
            {"stiffness": 1, "loss_factor": 0.1, "damping_ratio": 0.1},
            r"elements\.d\.loss_factor: .*contradicting-entries",
        ),
        ({"stiffness": 1, "damping": {"zeta": 0.1}}, "stated frequency"),
    ],
)
def test_contradictions_are_named(given, words):
    with pytest.raises(tn.ModelError, match=words):
        tn.TunedDamper("d", node="a", ring_inertia=1, **given)
