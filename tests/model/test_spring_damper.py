"""A damper of steel springs and oil against its equations of motion."""

import numpy as np
import pytest

import torsionnet as tn

J, K, RING, STAR, SPRINGS = 2.0, 8e4, 0.5, 0.1, 1.2e4


def damped(parameters=None, **given):
    return tn.Drivetrain(
        "damped",
        [
            tn.Inertia("mass", node="a", inertia=J),
            tn.Spring("shaft", nodes=("a", "ground"), stiffness=K),
            tn.SpringDamper("damper", node="a", ring_inertia=RING, hub_inertia=STAR, **given),
        ],
        parameters=parameters or {},
        inputs={"T": {"torque": "a"}},
        sensors={"theta": {"angle": "a"}, "ring": {"angle": "damper.ring"}},
    )


def motion(f, kappa):
    """Angles of hub and ring under a torque of one on the hub."""
    s2 = -((2 * np.pi * f) ** 2)
    ring = kappa / (RING * s2 + kappa)
    hub = 1 / ((J + STAR) * s2 + K + kappa * (1 - ring))
    return np.array([hub, hub * ring]).T


F = np.array([10.0, 20.0, 40.0])


def test_constant_damping():
    found = damped(stiffness=SPRINGS, damping=30).frequency_response(["theta", "ring"], "T", F).values[..., 0]
    np.testing.assert_allclose(found, motion(F, SPRINGS + 2j * np.pi * F * 30), rtol=1e-12)


def test_undimensioned_damping_and_stiffness_over_frequency():
    """At 20 Hz, half way between the rows on double logarithmic paper: the geometric mean."""
    given = {
        "loss_over_frequency": {"10 Hz": 0.2, "40 Hz": 0.8},
        "stiffness_over_frequency": {"10 Hz": 1.1, "40 Hz": 1.3},
    }
    eta, factor = np.array([0.2, 0.4, 0.8]), np.array([1.1, np.sqrt(1.1 * 1.3), 1.3])
    rig = damped({"k": SPRINGS}, stiffness="k", **given)
    found = rig.frequency_response(["theta", "ring"], "T", F).values[..., 0]
    np.testing.assert_allclose(found, motion(F, SPRINGS * factor * (1 + 1j * eta)), rtol=1e-11)
    soft = rig.configured(k=SPRINGS / 2).frequency_response(["theta", "ring"], "T", F).values[..., 0]
    np.testing.assert_allclose(soft, motion(F, SPRINGS / 2 * factor * (1 + 1j * eta)), rtol=1e-11)


def test_a_ring_has_an_inertia():
    text = "torsionnet: 1\nname: x\nelements: {d: {type: spring_damper, node: a, ring_inertia: 0, stiffness: 10}}"
    with pytest.raises(tn.ModelError, match=r":3:60: .*out-of-range"):
        tn.loads(text)


@pytest.mark.slow
def test_the_best_springs_are_found_with_the_law_over_frequency():
    """A parameter that acts through curves has derivatives: the design is that of a scan."""
    rig = damped(
        {"k": {"value": SPRINGS, "bounds": [3000, 60000]}}, stiffness="k", loss_over_frequency={10: 0.3, 60: 0.5}
    )
    found = rig.damper_design("theta", "k", input="T", band=(5, 60))
    f = np.linspace(5, 60, 1500)
    scan = {
        k: rig.configured(k=k).frequency_response("theta", "T", f).magnitude.max()
        for k in found.values["k"] * np.array([0.93, 1.0, 1.07])
    }
    assert min(scan, key=scan.get) == pytest.approx(found.values["k"])


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"damping": 1, "loss_over_frequency": {1: 1, 2: 2}}, "not both"),
        ({"stiffness_over_frequency": {1: 1, 2: 2}}, r"elements\.damper\.stiffness_over_frequency: .*missing-entry"),
        ({"loss_over_frequency": {1: 1, 2: 0}}, r"elements\.damper\.loss_over_frequency\.2: .*out-of-range"),
    ],
)
def test_contradictions_are_named(given, words):
    with pytest.raises(tn.ModelError, match=words):
        damped(stiffness=SPRINGS, **given)


def test_damping_factors_that_rise_with_frequency_have_the_poles_of_a_constant_damping():
    """Factors c omega/k of one c: below critical damping and above, the law is k + c s."""
    for c in (20.0, 3000.0):
        rows = {f"{f} Hz": c * 2 * np.pi * f / 1e4 for f in (0.01, 1, 1000)}
        poles = []
        for damping in ({"damping": c}, {"loss_over_frequency": rows}):
            damper = tn.SpringDamper("damper", node="a", ring_inertia=2, stiffness=1e4, **damping)
            hub = tn.Inertia("hub", node="a", inertia=5)
            poles.append(tn.Drivetrain("rig", [hub, damper]).modes().eigenvalues)
        np.testing.assert_allclose(poles[1], poles[0], rtol=1e-9)
