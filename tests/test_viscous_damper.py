"""A ring in a viscous film against Den Hartog's closed forms, and against the same thing built of plain parts."""

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.model.elements import Values

J, K = 2.0, 8e4
OMEGA = np.sqrt(K / J)


def magnification(mu, zeta, beta):
    """|theta| K / T of a mass on a spring with an untuned ring; mu ring to mass, beta frequency over natural frequency.

    Both equations of motion with theta_r eliminated; c = 2 zeta J_r omega_n.
    """
    film = 2j * zeta * mu * beta  # c s / K
    ring = film * (-mu * beta**2) / (film - mu * beta**2)
    return abs(1 / (1 - beta**2 + ring))


def damped(mu, zeta, **more):
    """The mass with a damper; hub_inertia is a part of J."""
    hub = more.get("hub_inertia", 0)
    film = 2 * zeta * mu * J * OMEGA
    return tn.Drivetrain(
        "damped",
        [
            tn.Inertia("mass", node="a", inertia=J - hub),
            tn.Spring("shaft", nodes=("a", "ground"), stiffness=K),
            tn.ViscousDamper("damper", node="a", ring_inertia=mu * J, damping=film, **more),
        ],
        inputs={"T": {"torque": "a"}},
        sensors={
            "theta": {"angle": "a"},
            "ring": {"angle": "damper.ring"},
            "slip": {"twist": "damper"},
            "taken": {"torque": "damper"},
        },
    )


@pytest.mark.parametrize("mu", [0.1, 0.5, 2.0])
class TestDenHartog:
    """Mechanical Vibrations, chapter 3: the damped absorber without a spring of its own."""

    def test_any_film(self, mu):
        beta = np.array([0.3, 0.8, 1.0, 1.4])
        found = damped(mu, 0.2).frequency_response("theta", "T", beta * OMEGA / (2 * np.pi)).magnitude.ravel()
        np.testing.assert_allclose(found * K, magnification(mu, 0.2, beta), rtol=1e-12)

    def test_all_films_meet_in_one_point(self, mu):
        """At beta = sqrt(2/(2 + mu)) theta is (2 + mu)/mu times the static angle, however strong the film."""
        at = np.sqrt(2 / (2 + mu)) * OMEGA / (2 * np.pi)
        for zeta in (0.05, 0.3, 2.0):
            found = damped(mu, zeta).frequency_response("theta", "T", [at]).magnitude.item()
            assert found * K == pytest.approx((2 + mu) / mu, rel=1e-12)

    def test_the_best_film_has_its_peak_there(self, mu):
        best = 1 / np.sqrt(2 * (1 + mu) * (2 + mu))
        frequencies = np.geomspace(0.3, 3, 4001) * OMEGA / (2 * np.pi)
        peaks = [
            damped(mu, factor * best).frequency_response("theta", "T", frequencies).magnitude.max() * K
            for factor in (0.9, 1, 1.1)
        ]
        assert peaks[1] == pytest.approx((2 + mu) / mu, rel=1e-5)
        assert min(peaks[0], peaks[2]) > 1.001 * peaks[1]


def built_of_parts():
    """Film, ring and hub as elements of their own."""
    return tn.Drivetrain(
        "parts",
        [
            tn.Inertia("mass", node="a", inertia=J - 0.3),
            tn.Spring("shaft", nodes=("a", "ground"), stiffness=K),
            tn.Inertia("hub", node="h", inertia=0.3),
            tn.RigidCoupling("flange", nodes=("a", "h")),
            tn.Spring("film", nodes=("h", "r"), stiffness=5e3, damping=12),
            tn.Inertia("ring", node="r", inertia=0.4),
        ],
        inputs={"T": {"torque": "a"}},
        sensors={
            "theta": {"angle": "a"},
            "ring": {"angle": "r"},
            "slip": {"twist": "film"},
            "taken": {"torque": "flange"},
        },
    )


def test_is_its_parts():
    one, parts = damped(0.2, 12 / (0.8 * OMEGA), hub_inertia=0.3, stiffness=5e3), built_of_parts()
    f = np.array([0.5, 10, 17, 31, 200])
    sensors = ["theta", "ring", "slip", "taken"]
    found, expected = (rig.frequency_response(sensors, "T", f).values for rig in (one, parts))
    np.testing.assert_allclose(found, expected, rtol=1e-10)
    np.testing.assert_allclose(one.modes().eigenvalues, parts.modes().eigenvalues, rtol=1e-10)


def test_a_measure_of_damping_is_that_of_the_film():
    """zeta at f: c = 2 zeta k/(2 pi f)."""
    one = tn.ViscousDamper(
        "d", node="a", ring_inertia=1, damping={"zeta": 0.1, "at": "40 Hz"}, stiffness="5 kN*m/rad"
    )  # fmt: skip
    film = one.parts(Values({}))[0]
    assert film.damping == pytest.approx(2 * 0.1 * 5000 / (2 * np.pi * 40), rel=1e-14)
    with pytest.raises(tn.ModelError, match="needs a film with stiffness"):
        tn.ViscousDamper("d", node="a", ring_inertia=1, damping={"zeta": 0.1, "at": "40 Hz"})


def test_the_ring_turns_with_the_hub_on_average():
    rig = damped(0.2, 0.3)
    free = tn.Drivetrain(
        "free",
        [element for name, element in rig.elements.items() if name != "shaft"],
        operating_point={"speed": {"a": "1500 rpm"}},
    )
    assert free.mean_speeds["damper.ring"] == pytest.approx(1500 * np.pi / 30)


def test_reaches_every_program():
    """What the ring does in an exported model is tested with all other elements; here: nothing of it is left out."""
    rig = damped(0.2, 0.3, hub_inertia=0.1)
    text = tn.io.to_modelica(rig)
    assert all(part in text for part in ("Damper damper(d=", "damper_inertia(J=0.4)", "damper_inertia_2(J=0.1)"))
    with pytest.raises(tn.UsageError, match=r"no counterpart of shaft \(spring\), stiffness on a;"):
        tn.io.to_tors(rig)
    engine = tn.Drivetrain("engine", [rig.elements["mass"], rig.elements["damper"]])
    back = tn.io.from_tors(tn.io.to_tors(engine))
    ours, theirs = (model.frequency_response("a", "a", [3.0, 30.0]).values for model in (engine, back))
    np.testing.assert_allclose(theirs, ours, rtol=1e-12)
