"""Pendulums in the centrifugal field: the order that stands still, modes in closed form, and large swings."""

import numpy as np
import pytest
import scipy

import torsionnet as tn

RPM = np.pi / 30
J, R, r, M = 0.9, 0.08, 0.02, 0.4
PLANT = """torsionnet: 1
name: engine with pendulums
parameters:
  w: {by: speed, of: crank}
elements:
  pendulums: {type: pendulum_absorber, node: crank, count: 4, mass: 0.4 kg, pivot_radius: 80 mm, path_radius: 20 mm,
    speed: w, own_inertia: 2e-4 kg*m^2}
  crank: {type: inertia, node: crank, inertia: 0.9 kg*m^2}
  shaft: {type: spring, nodes: [crank, load], stiffness: 9 kN*m/rad, damping: 2 N*m*s/rad}
  load: {type: inertia, node: load, inertia: 3 kg*m^2}
speeds: {of: crank, range: 600..3000 rpm, step: 300 rpm, rated: 3000 rpm}
excitations:
  gas: {type: harmonic, node: crank, orders: {2: {amplitude: 100 N*m}, 4: {amplitude: 30 N*m}}}
"""


def absorber(speed=150.0, **more):
    given = {"mass": M, "pivot_radius": R, "path_radius": r, "speed": speed} | more
    return tn.PendulumAbsorber("p", node="a", **given)


def plant(*elements):
    return tn.Drivetrain(
        "plant",
        [tn.Inertia("rotor", node="a", inertia=J), *elements],
        inputs={"T": {"torque": "a"}},
        sensors={"theta": {"angle": "a"}},
    )


def held(*elements):
    return tn.Drivetrain("held", [tn.Inertia("rotor", node="a", inertia=J), *elements, tn.Lock("lock", node="a")])


def grounded(*elements):
    return plant(tn.Spring("shaft", nodes=("a", "ground"), stiffness=5e4), *elements)


class TestOrder:
    def test_the_node_stands_still_at_every_speed(self):
        """sqrt(R/r) = 2: the order of the gas torque that it is tuned to; the other one is still there."""
        rig = tn.loads(PLANT)
        run = rig.order_response("crank", speeds=np.arange(600, 3001, 300) * RPM)
        tuned, other = abs(run.of_order(2)), abs(run.of_order(4))
        assert tuned.max() < 1e-10 * other.min()
        off = tn.loads(PLANT.replace("path_radius: 20 mm", "path_radius: 20.5 mm"))
        assert abs(off.order_response("crank", speeds=[600 * RPM]).of_order(2)).item() > 1e-3 * other.max()

    @pytest.mark.parametrize("speed", [20.0, 150.0, 700.0])
    @pytest.mark.parametrize("own", [0.0, 3e-4])
    def test_hung_at_one_point_its_own_inertia_counts(self, speed, own):
        order = np.sqrt(M * R * r / (M * r**2 + own))
        rig = grounded(absorber(speed, own_inertia=own, suspension="simple", count=3))
        still, beside = rig.frequency_response(
            "theta", "T", np.array([1, 1.01]) * order * speed / (2 * np.pi)
        ).magnitude.ravel()
        assert still < 1e-10 * beside

    def test_several_of_one_order_are_one_of_their_mass(self):
        f = np.linspace(5, 80, 7)
        one, four = (
            grounded(absorber(count=count, mass=mass, own_inertia=own)).frequency_response("theta", "T", f).values
            for count, mass, own in ((1, 4 * M, 8e-4), (4, M, 2e-4))
        )
        np.testing.assert_allclose(one, four, rtol=1e-12)

    def test_two_orders_at_once(self):
        second = tn.PendulumAbsorber("q", node="a", mass=0.2, pivot_radius=0.08, path_radius=0.005, speed=150)
        still = grounded(absorber(), second).frequency_response("theta", "T", np.array([2, 4]) * 150 / (2 * np.pi))
        assert still.magnitude.max() < 1e-14


class TestModes:
    """In the angles of shaft and pendulum against it, from the positions of the masses: M = [[J + m L^2, m r L],
    [m r L, m r^2]], K = diag(K, m R r Omega^2), L = R + r."""

    def squared_frequencies(self, stiffness, speed, mass):
        L = R + r
        a = (J + mass * L**2) * mass * r**2 - (mass * r * L) ** 2
        b = -((J + mass * L**2) * mass * R * r * speed**2 + stiffness * mass * r**2)
        c = stiffness * mass * R * r * speed**2
        return np.sort(np.roots([a, b, c]).real)

    def test_a_rotor_on_a_spring_has_two(self):
        found = grounded(absorber(150.0, count=3)).modes().natural_frequencies
        expected = np.sqrt(self.squared_frequencies(5e4, 150.0, 3 * M)) / (2 * np.pi)
        np.testing.assert_allclose(np.sort(found), expected, rtol=1e-10)

    def test_a_free_rotor_has_one_beside_the_rigid_body(self):
        """Omega n sqrt(1 + m (R + r)^2/J): with the speed, and above the order of the pendulum alone."""
        for speed in (40.0, 150.0):
            found = plant(absorber(speed)).modes().natural_frequencies
            expected = speed * 2 * np.sqrt(1 + M * (R + r) ** 2 / J) / (2 * np.pi)
            np.testing.assert_allclose(np.sort(found), [0, expected], rtol=1e-10, atol=1e-12)

    def test_damping_acts_between_mass_and_shaft(self):
        """Rotor held: m r^2 phi'' + c phi' + m R r Omega^2 phi = 0."""
        assert held(absorber(150.0, damping=0.002)).modes().damping_ratios == pytest.approx(
            [0.002 / (2 * M * r**2 * 300)]
        )


def squared_distance(path, s):
    """From the shaft after a length s of path; the slope of the path is the integral of ds/rho."""
    squared = R / r
    size = {"circle": 1e-9, "cycloid": 1.0, "epicycloid": np.sqrt(squared / (1 + squared))}[path]

    def slope(u):  # rho^2 = r^2 - lambda^2 s^2
        return np.arcsin(size * u / r) / size

    radial = R + r - scipy.integrate.quad(lambda u: np.sin(slope(u)), 0, s, epsabs=1e-15)[0]
    across = scipy.integrate.quad(lambda u: np.cos(slope(u)), 0, s, epsabs=1e-15)[0]
    return radial**2 + across**2


def order_by_the_exact_path(path, swing):
    """Of a mass on a shaft that turns evenly at 1 rad/s: by energy, ds/dt = sqrt(x(s)^2 - x(A)^2); s = A sin(u)."""
    end = squared_distance(path, swing * r)

    def slowness(u):
        return swing * r * np.cos(u) / np.sqrt(squared_distance(path, swing * r * np.sin(u)) - end)

    quarter = scipy.integrate.quad(slowness, 0, np.pi / 2 - 1e-3, epsabs=1e-10, limit=200)[0]
    quarter += 1e-3 * slowness(np.pi / 2 - 1e-3)
    return np.pi / 2 / quarter


@pytest.mark.parametrize("path", ["circle", "cycloid", "epicycloid"])
class TestSwing:
    def order(self, path, swing):
        return held(absorber(150.0, path=path, swing=swing)).modes().natural_frequencies[0] * 2 * np.pi / 150.0

    def test_small_swings_have_the_same_order_on_any_path(self, path):
        assert self.order(path, 0) == pytest.approx(2, rel=1e-12)

    def test_the_change_is_that_of_the_exact_path_to_its_square(self, path):
        """What is left over goes with the fourth power of the swing."""
        for swing in (0.2, 0.4):
            assert self.order(path, swing) == pytest.approx(order_by_the_exact_path(path, swing), abs=0.05 * swing**4)
        changed = abs(self.order(path, 0.4) - 2)
        assert changed < 1e-9 if path == "epicycloid" else changed > 4 * 0.05 * 0.4**4 / 2


def test_reports_draw_and_explain_it():
    rig = tn.loads(PLANT)
    assert "pendulums" in [text.get_text() for text in tn.plot.schematic(rig).axes[0].texts]
    assert not [fault for fault in rig.check() if fault.severity == "error"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"count": 0}, "from 1 to 100"),
        ({"path": "circel"}, 'did you mean "circle"'),
        ({"suspension": "trifilar"}, 'did you mean "bifilar"'),
        ({"speed": "1500 Hz"}, "Hz counts cycles"),
    ],
)
def test_nonsense_is_refused(change, words):
    with pytest.raises(tn.ModelError, match=words):
        absorber(**change)


def test_a_shaft_that_stands_still_has_no_centrifugal_field():
    with pytest.raises(tn.ModelError, match=r"elements\.p\.speed: .*out-of-range"):
        grounded(absorber(0.0))


ABOVE_ITS_ORDER = """
torsionnet: 1
parameters: {w: SPEED}
elements:
  rotor: {type: inertia, node: a, inertia: 0.4 kg*m^2}
  shaft: {type: spring, nodes: [a, b], stiffness: 30 kN*m/rad}
  load: {type: inertia, node: b, inertia: 0.9 kg*m^2}
  pendulums: {type: pendulum_absorber, node: a, count: 4, mass: 0.8 kg, pivot_radius: 90 mm, path_radius: 20 mm, speed: w}
speeds: {of: a, range: 2000..5000 rpm, step: 500 rpm, rated: 3000 rpm}
excitations: {gas: {type: harmonic, node: a, orders: {2: {amplitude: 100 N*m}}}}
"""


def test_a_mode_that_rises_nearly_with_its_order_never_meets_it():
    """Its frequency over the speed is the same throughout, in the range of speeds and beyond."""
    found = tn.loads(ABOVE_ITS_ORDER.replace("SPEED", "{by: speed, of: a}")).critical_speeds(margin="95 %", reach=0.5)
    ahead = [
        tn.loads(ABOVE_ITS_ORDER.replace("SPEED", f"{rpm} rpm")).modes().natural_frequencies.max() / (2 * rpm / 60) - 1
        for rpm in (2000, 5000)
    ]
    last = max(found.crossings, key=lambda one: one.mode.undamped_frequency)
    assert 0 < last.margin <= min(ahead) * (1 + 1e-9)
    assert not np.isfinite([last.undamped_speed, last.natural_speed, last.damped_speed]).any()
    assert "no crossing: nearest at" in last.remark
