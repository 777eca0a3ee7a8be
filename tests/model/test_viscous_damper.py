"""A ring in a viscous film against Den Hartog's closed forms, and against the same thing built of plain parts."""

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.io.tors_reading import from_tors
from torsionnet.io.tors_writing import to_tors
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
    with pytest.raises(tn.ModelError, match=r"elements\.d\.damping: .*missing-entry"):
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
    with pytest.raises(tn.UsageError, match="no-counterpart"):
        to_tors(rig)
    engine = tn.Drivetrain("engine", [rig.elements["mass"], rig.elements["damper"]])
    back = from_tors(to_tors(engine))
    ours, theirs = (model.frequency_response("a", "a", [3.0, 30.0]).values for model in (engine, back))
    np.testing.assert_allclose(theirs, ours, rtol=1e-12)


SILICONE = {
    "moduli": [["1 Hz", "1 kPa", "9 kPa"], ["10 Hz", "12 kPa", "40 kPa"], ["200 Hz", "90 kPa", "100 kPa"]],
    "reference_temperature": "25 degC",
    "shift": {"25 degC": 1, "100 degC": 0.25},
}
GAP = {"outer_diameter": "300 mm", "inner_diameter": "200 mm", "axial_gap": "0.5 mm", "width": "40 mm", "outer_gap": "0.4 mm"}  # fmt: skip
FACTOR = np.pi * (0.15**4 - 0.1**4) / 5e-4 + 2 * np.pi * 0.04 * 0.15**3 / 4e-4


def silicone(**more):
    rig = damped(0.2, 0.3)
    film = tn.ViscousDamper("damper", node="a", ring_inertia=0.4, **more)
    parts = [film if name == "damper" else one for name, one in rig.elements.items()]
    return tn.Drivetrain("silicone", parts, inputs=rig.inputs, sensors=rig.sensors)


class TestSilicone:
    def expected(self, f, shift=1.0, scale=1.0):
        """The mass on its spring with a ring on the complex stiffness of the film, powers between the rows."""
        rows = np.log([[1, 1e3, 9e3], [10, 12e3, 40e3], [200, 90e3, 100e3]]).T
        storage, loss = (np.exp(np.interp(np.log(f * shift), rows[0], row)) for row in rows[1:])
        kappa, s2 = scale * FACTOR * (storage + 1j * loss), -((2 * np.pi * f) ** 2)
        return 1 / (J * s2 + K + kappa * 0.4 * s2 / (0.4 * s2 + kappa))

    def test_film_in_the_gaps_round_the_ring(self):
        f = np.array([4.0, 10.0, 31.0, 150.0])
        found = silicone(silicone=SILICONE, gap=GAP).frequency_response("theta", "T", f).values.ravel()
        np.testing.assert_allclose(found, self.expected(f), rtol=1e-11)

    def test_warm_silicone_is_weaker(self):
        """a_T goes with its logarithm: half way between 25 and 100 degC it is 0.5."""
        f = np.array([4.0, 10.0, 31.0, 150.0])
        warm = silicone(silicone=SILICONE, gap=GAP, temperature="62.5 degC", scale=0.8)
        found = warm.frequency_response("theta", "T", f).values.ravel()
        np.testing.assert_allclose(found, self.expected(f, shift=0.5, scale=0.8), rtol=1e-11)

    def test_a_table_is_a_tabulated_spring(self):
        rows = [[5, 2e3, 30], [40, 9e3, 22], [200, 2e4, 9]]
        rig = damped(0.2, 0.3)
        parts = tn.Drivetrain(
            "parts",
            [
                *(one for name, one in rig.elements.items() if name != "damper"),
                tn.TabulatedSpring("film", nodes=("a", "r"), table=rows),
                tn.Inertia("ring", node="r", inertia=0.4),
            ],
            inputs=rig.inputs,
            sensors={"theta": {"angle": "a"}},
        )
        f = [4.0, 31.0, 300.0]
        found, expected = (one.frequency_response("theta", "T", f).values for one in (silicone(table=rows), parts))
        np.testing.assert_allclose(found, expected, rtol=1e-12)
        np.testing.assert_allclose(silicone(table=rows).modes().eigenvalues, parts.modes().eigenvalues, rtol=1e-9)

    @pytest.mark.nightly
    def test_the_best_oil_is_found(self):
        """A factor on the moduli is sought as a film's damping is; temperature, without derivatives, is refused."""
        rig = silicone(silicone=SILICONE, gap=GAP, temperature="60 degC", scale=0.3)
        found = rig.damper_design("theta", {"damper.scale": (0.01, 1.0)}, input="T", band=(10, 100))
        best, f = found.values["damper.scale"], np.linspace(10, 100, 200)
        levels = [
            silicone(silicone=SILICONE, gap=GAP, temperature="60 degC", scale=factor * best)
            .frequency_response("theta", "T", f)
            .magnitude.max()
            for factor in (0.9, 1, 1.1)
        ]
        assert levels[1] == min(levels)
        with pytest.raises(tn.ModelError, match=r"temperature.*expression-not-allowed"):
            rig.damper_design("theta", {"damper.temperature": (300, 350)}, input="T", band=(10, 100))

    def test_a_configuration_says_how_warm_it_is(self):
        text = """torsionnet: 1
elements:
  mass: {type: inertia, node: a, inertia: 2 kg*m^2}
  shaft: {type: spring, nodes: [a, ground], stiffness: 80 kN*m/rad}
  damper:
    type: viscous_damper
    node: a
    ring_inertia: 0.4 kg*m^2
    gap: {outer_diameter: 300 mm, inner_diameter: 200 mm, axial_gap: 0.5 mm, width: 40 mm, outer_gap: 0.4 mm}
    silicone:
      moduli: [[1 Hz, 1 kPa, 9 kPa], [10 Hz, 12 kPa, 40 kPa], [200 Hz, 90 kPa, 100 kPa]]
      shift: {25 degC: 1, 100 degC: 0.25}
    temperature: 25 degC
inputs: {T: {torque: a}}
sensors: {theta: {angle: a}}
configurations: {oil: {cold: {}, warm: {damper.temperature: 62.5 degC}}}
"""
        rig, f = tn.loads(text), np.array([31.0])
        for name, shift in (("cold", 1.0), ("warm", 0.5)):
            found = rig.configured(name).frequency_response("theta", "T", f).values.item()
            assert found == pytest.approx(self.expected(f, shift).item(), rel=1e-10)

    @pytest.mark.parametrize(
        ("given", "words"),
        [
            ({}, r"elements\.d: .*missing-entry"),
            ({"damping": 1, "table": [[1, 1, 1]]}, r"elements\.d\.table: .*contradicting-entries"),
            ({"table": [[1, 1, 1]], "stiffness": 3}, r"elements\.d\.stiffness: .*needless-entry"),
            ({"silicone": SILICONE}, "here is no gap"),
            ({"damping": 1, "gap": GAP}, "here is no silicone"),
            ({"damping": 1, "temperature": "20 degC"}, r"elements\.d\.temperature: .*needless-entry"),
            ({"damping": 1, "scale": 2}, "there is none"),
            (
                {"silicone": SILICONE, "gap": GAP, "temperature": "120 degC"},
                r"elements\.d\.temperature: .*25.*100.*out-of-range",
            ),
            ({"silicone": SILICONE, "gap": {"outer_diameter": 1, "inner_diameter": 0.5}}, "give a gap"),
            ({"silicone": SILICONE, "gap": GAP | {"width": None}}, "width has no value|needs the width"),
        ],
    )
    def test_contradictions_are_named(self, given, words):
        with pytest.raises(tn.ModelError, match=words):
            tn.ViscousDamper("d", node="a", ring_inertia=1, **given)
