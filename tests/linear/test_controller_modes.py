"""Poles of drivetrains with controllers: closed forms, dense pencils, Lambert's W; and the same in time."""

import math
import warnings

import numpy as np
import pytest
import scipy
from support.controlled_plants import Plant

import torsionnet as tn
from torsionnet.linear.dynamic_stiffness.state_space import state_space
from torsionnet.linear.modes.active_pencil import ActivePencil


def governed(law, delay=0, inertia=3.0, quantity="velocity", **more):
    elements = [
        tn.Inertia("rotor", node="a", inertia=inertia),
        tn.Controller("governor", sense={quantity: "a"}, act="a", law=law, delay=delay),
    ]
    return tn.Drivetrain("governed", elements, **more)


def settled(asked):
    """What is asked for, or None where a law has no states, which is said in words."""
    try:
        return asked()
    except tn.UsageError as error:
        if "give it a filter" not in str(error):
            raise
        return None


def both_halves(modes):
    """All eigenvalues but zeros."""
    values = modes.eigenvalues[modes.eigenvalues != 0]
    return np.concatenate([values, values[values.imag > 0].conj()])


def by_size(values):
    values = np.asarray(values, dtype=complex)
    return values[np.lexsort((values.imag.round(9), values.real.round(9)))]


def dense_poles(plant):
    """Of det(M s^2 + C s + K - sum out kappa sensed), by a linearisation over (q, q', T, z) of rational fits of the laws.

    Each law is a quotient of polynomials of degree 4 at most, read from samples of kappa alone.
    """
    n, size = plant.n, plant.n + len(plant.laws)
    degree = 5
    powers = np.zeros((degree + 1, size, size))
    powers[0, :n, :n], powers[1, :n, :n], powers[2, :n, :n] = plant.K, plant.C, plant.M
    for number, (out, sensed, kappa) in enumerate(plant.laws):
        above, below = fitted(kappa)
        powers[0, :n, n + number] = -out
        for power, value in enumerate(above):
            powers[power, n + number, :n] = -value * sensed
        for power, value in enumerate(below):
            powers[power, n + number, n + number] += value
    left = np.zeros((degree * size, degree * size))
    right = np.eye(degree * size)
    for power in range(degree - 1):
        left[power * size : (power + 1) * size, (power + 1) * size : (power + 2) * size] = np.eye(size)
    for power in range(degree):
        left[-size:, power * size : (power + 1) * size] = -powers[power]
    right[-size:, -size:] = powers[degree]
    from scipy.linalg import eig

    values = eig(left, right, right=False)
    return values[np.isfinite(values) & (np.abs(values) < 1e4)]


def fitted(kappa, n=5, m=3):
    """Coefficients, ascending, of a quotient of degrees n and m through samples, of the lowest degrees that fit."""
    s = 1j * np.linspace(0.5, 30, 40) + 0.3
    values = kappa_of(kappa, s)
    for below in range(m + 1):
        for above in range(n + 1):
            scale = 10.0
            A = np.hstack(
                [
                    (s[:, None] / scale) ** np.arange(above + 1),
                    -values[:, None] * (s[:, None] / scale) ** np.arange(below + 1),
                ]
            )
            A = np.vstack([A.real, A.imag])
            norm = np.linalg.norm(A, axis=0)
            _, sizes, vectors = np.linalg.svd(A / norm)
            if sizes[-1] < 1e-12 * sizes[0]:
                x = vectors[-1] / norm
                x = x / np.abs(x).max()
                return x[: above + 1] / scale ** np.arange(above + 1), x[above + 1 :] / scale ** np.arange(below + 1)
    raise AssertionError("no quotient")


def kappa_of(kappa, s):
    return np.array([kappa(one) for one in s])


class TestPoles:
    def test_pi_governor_on_one_mass_has_the_poles_of_second_order(self):
        modes = governed({"p": -2, "i": -30}).modes()
        assert both_halves(modes) == pytest.approx(np.roots([3, 2, 30]), rel=1e-13)
        assert modes.damping_ratios[0] == pytest.approx(2 / (2 * math.sqrt(3 * 30)), rel=1e-13)
        assert modes.dissipated[:, 0].tolist() == [0, 1]

    def test_an_integral_that_pushes_makes_a_real_pole_grow(self):
        modes = governed({"p": -2, "i": 30}).modes()
        assert sorted(modes.eigenvalues.real) == pytest.approx(sorted(np.roots([3, 2, -30])), rel=1e-13)
        grows = int(np.argmax(modes.eigenvalues.real))
        assert modes.descriptions[grows].startswith("unstable, it grows; e times as much every")

    @pytest.mark.parametrize(("gain", "delay"), [(30, 0.05), (30, 0.2), (3, 0.2), (60, 0.0785)])
    def test_delayed_speed_loop_has_the_poles_of_lambert(self, gain, delay):
        """J w' = -g w(t - tau): s tau e^(s tau) = -g tau/J."""
        modes = governed(-gain, delay=delay, inertia=2.0).modes()
        expected = np.array([scipy.special.lambertw(-gain / 2 * delay, branch) / delay for branch in range(-60, 60)])
        found = both_halves(modes)
        expected = expected[np.abs(expected) < np.abs(found).max() * 1.0001]
        assert len(found) == len(expected)
        assert by_size(found) == pytest.approx(by_size(expected), rel=1e-12)
        assert modes.kinds.count("rigid body") == 1

    @pytest.mark.few(11)
    @pytest.mark.parametrize("seed", range(40))
    def test_random_laws_have_the_poles_of_a_dense_pencil(self, seed):
        plant = Plant(seed)
        modes = settled(plant.rig.modes)
        if modes is None:
            return
        found = both_halves(modes)
        expected = dense_poles(plant)
        for pole in found:
            assert np.abs(expected - pole).min() <= 2e-6 * max(1, abs(pole))
        moving = expected[np.abs(expected) > 1e-4]
        assert len(moving) == np.sum(np.abs(found) > 1e-4)

    @pytest.mark.few(10)
    @pytest.mark.parametrize("seed", range(40))
    def test_every_pole_and_shape_solves_the_equation_of_motion_with_delays(self, seed):
        plant = Plant(seed, delay=True, forms=("pid", "polynomials"))
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message=".*eigenvalues are uncertain")
            modes = settled(plant.rig.modes)
        if modes is None:
            return
        order = np.argsort([int(node[1:]) for node in modes.nodes])
        for pole, kind, shape in zip(modes.eigenvalues, modes.kinds, modes.shapes.T, strict=True):
            hidden = abs(1 + 0.1 * pole) < 1e-9  # a filter that swings by itself, which nothing senses
            if kind != "rigid body" and not hidden:
                loads = plant.dynamic_stiffness(pole) @ shape[order]
                size = np.abs(plant.M) * abs(pole) ** 2 + np.abs(plant.C) * abs(pole) + np.abs(plant.K)
                assert np.linalg.norm(loads) <= 1e-9 * np.linalg.norm(size)

    def test_poles_in_a_circle_are_counted(self):
        pencil = ActivePencil(governed(-30, delay=0.05, inertia=2.0).assembly)
        poles = np.array([0.0, *(scipy.special.lambertw(-30 / 2 * 0.05, branch) / 0.05 for branch in range(-60, 60))])
        for radius in (1.0, 40.0, 200.0, 700.0):
            assert pencil.count_within(radius) == np.sum(np.abs(poles) < radius)

    def test_counts_without_delay_are_exact(self):
        """Two masses on a spring, held at one angle by an integral: five poles, none of them zero."""
        elements = [
            tn.Inertia("one", node="a", inertia=1),
            tn.Spring("shaft", nodes=("a", "b"), stiffness=100),
            tn.Inertia("two", node="b", inertia=1),
        ]
        hold = tn.Controller("hold", sense={"angle": "a"}, act="a", law={"p": -5, "i": -1})
        assert ActivePencil(tn.Drivetrain("held", [*elements, hold]).assembly).counts() == (5, 0)
        drag = tn.Controller("drag", sense={"velocity": "a"}, act="b", law={"p": -5, "i": 0})
        assert ActivePencil(tn.Drivetrain("dragged", [*elements, drag]).assembly).counts() == (4, 1)

    def test_a_load_of_constant_power_is_negative_damping(self):
        """T = P/w opposes, so dT/dw = -P/w^2: 3 kW at 100 rad/s on a damper of 0.2."""
        elements = [
            tn.Inertia("rotor", node="a", inertia=0.5),
            tn.Spring("shaft", nodes=("a", "ground"), stiffness=200, damping=0.2),
            tn.Controller("load", sense={"velocity": "a"}, act="a", law="P/w^2"),
        ]
        rig = tn.Drivetrain("load", elements, parameters={"P": "3 kW", "w": "100 rad/s"})
        modes = rig.modes()
        assert both_halves(modes) == pytest.approx(np.roots([0.5, 0.2 - 0.3, 200]), rel=1e-12)
        assert modes.descriptions[0].startswith("unstable, it grows")
        assert modes.dissipated[:, 0] == pytest.approx([0, 0.4, -0.6])
        assert modes.undamped_natural_frequencies == pytest.approx([20 / (2 * math.pi)])

    @pytest.mark.parametrize("seed", range(12))
    def test_what_neither_grows_nor_decays_is_not_unstable_by_rounding(self, seed):
        """Two equal masses swing against each other; the third, which a load of constant power drives, stands still."""
        rng = np.random.default_rng(seed)
        J, k = 10 ** rng.uniform(-2, 2), 10 ** rng.uniform(2, 6)
        rate = math.sqrt(k * J)
        elements = [
            tn.Inertia("left", node="a", inertia=J),
            tn.Spring("one", nodes=("a", "b"), stiffness=k),
            tn.Inertia("middle", node="b", inertia=3 * J),
            tn.Spring("two", nodes=("b", "c"), stiffness=k),
            tn.Inertia("right", node="c", inertia=J),
            tn.Spring("hold", nodes=("b", "ground"), stiffness=2 * k, damping=rate / 100),
            tn.ConstantPowerLoad("load", node="b", power=10 * rate, speed=10),
        ]
        modes = tn.Drivetrain("three", elements).modes()
        swings = int(np.argmin(np.abs(np.abs(modes.eigenvalues) - math.sqrt(k / J))))
        assert modes.eigenvalues[swings].real == 0
        grows = ["unstable" in text for text in modes.descriptions]
        assert [place for place, one in enumerate(grows) if not one] == [swings]

    def test_a_delay_does_not_hide_modes_beyond_its_circle(self):
        elements = [
            tn.Inertia("one", node="a", inertia=1),
            tn.Spring("shaft", nodes=("a", "b"), stiffness=1e8, damping=1),
            tn.Inertia("two", node="b", inertia=1),
            tn.Controller("slow", sense={"velocity": "a"}, act="a", law=-1e-3, delay="2 s"),
        ]
        modes = tn.Drivetrain("slow", elements).modes()
        assert modes.natural_frequencies[-1] == pytest.approx(math.sqrt(2e8) / (2 * math.pi), rel=1e-6)
        assert "those next to modes without control" in modes.notes[0]


class TestInTime:
    @pytest.mark.filterwarnings("ignore:the state space of t/T has lost digits")  # far below, near rest
    @pytest.mark.parametrize("seed", range(12))
    def test_state_space_has_the_frequency_response(self, seed):
        plant = Plant(seed)
        channels = {"inputs": {"T": {"torque": "n0"}}, "sensors": {"w": {"velocity": "n1"}, "t": {"torque": "act0"}}}
        rig = tn.Drivetrain("plant", plant.elements, **channels)
        system = settled(rig.to_control)
        if system is None:
            return
        for f in (0.1, 1.0, 5.0):
            expected = rig.frequency_response(["w", "t"], "T", [f]).values[0]
            assert system(2j * math.pi * f) == pytest.approx(expected, rel=1e-8)

    def test_simulation_is_that_of_scipy(self):
        """J w' = -p w - i x + T, x' = w, written down as states; torque of the controller too."""
        J, p, i, h = 3.0, 2.0, 30.0, 0.01
        torque = np.sin(0.07 * np.arange(800)) + np.linspace(0, 3, 800)
        A, B = [[0, 1], [-i / J, -p / J]], [[0], [1 / J]]
        _, expected, _ = scipy.signal.lsim((A, B, [[0, 1], [-i, -p]], [[0], [0]]), torque, h * np.arange(800))
        rig = governed({"p": -p, "i": -i})
        record = rig.simulate(["velocity(a)", "torque(governor)"], {"a": torque}, 1 / h)
        assert record["velocity(a)"].values == pytest.approx(expected[:, 0], abs=1e-10)
        assert record["torque(governor)"].values == pytest.approx(expected[:, 1], abs=1e-9)

    def test_a_filtered_law_in_time_is_that_of_scipy(self):
        """J w' = T - 4 w_f with w_f' = (w - w_f)/0.1."""
        A, B = [[0, -4 / 2], [10, -10]], [[1 / 2], [0]]
        torque = np.cos(0.05 * np.arange(500))
        _, expected, _ = scipy.signal.lsim((A, B, [[1, 0]], [[0]]), torque, 0.01 * np.arange(500))
        rig = governed({"numerator": [-4], "denominator": [0.1, 1]}, inertia=2)
        record = rig.simulate("velocity(a)", {"a": torque}, 100)
        assert record["velocity(a)"].values == pytest.approx(expected, abs=1e-10)

    def test_a_delay_has_no_state_space(self):
        with pytest.raises(tn.UsageError, match="unsupported-law"):
            state_space(governed(-3, delay=0.1))


class TestHysteresis:
    """Loss factors beside controllers: poles of the upper half plane against the determinant of dense matrices."""

    def car(self, eta, gain=-8.0, delay="4 ms"):
        elements = [
            tn.Inertia("motor", node="m", inertia=0.5),
            tn.HystereticSpring("half_shaft", nodes=("m", "w"), stiffness=4000, loss_factor=eta),
            tn.Inertia("wheels", node="w", inertia=2),
            tn.HystereticSpring("tyre", nodes=("w", "v"), stiffness=9000, loss_factor=2 * eta),
            tn.Damper("rubber", nodes=("w", "v"), damping=3),
            tn.Inertia("car", node="v", inertia=90),
            tn.Controller("jerk", sense={"velocity": ["m", "v"]}, act="m", law={"p": gain}, delay=delay),
        ]
        return tn.Drivetrain("car", elements)

    def determinant(self, s, eta, gain, tau):
        k, t = 4000 * (1 + 1j * eta), 9000 * (1 + 2j * eta) + 3 * s
        D = np.array([[0.5 * s**2 + k, -k, 0], [-k, 2 * s**2 + k + t, -t], [0, -t, 90 * s**2 + t]])
        D[0] -= gain * s * np.exp(-tau * s) * np.array([1, 0, -1])
        return np.linalg.det(D)

    @pytest.mark.parametrize(("eta", "gain", "tau"), [(0.05, -8.0, 0), (0.1, -8.0, 0.004), (0.02, 5.0, 0)])
    def test_poles_are_roots_of_the_determinant(self, eta, gain, tau):
        modes = self.car(eta, gain, tau).modes()
        poles = modes.eigenvalues[modes.eigenvalues.imag > 1]
        assert len(poles) >= 2
        for pole in poles:
            near = [abs(self.determinant(pole * (1 + d), eta, gain, tau)) for d in (1e-6, -1e-6)]
            assert abs(self.determinant(pole, eta, gain, tau)) < 1e-5 * min(near)

    def test_what_turns_freely_has_two_poles_at_zero_and_none_beside(self):
        """A double pole at zero is moved by the root of the rounding; with a delay it was taken for a slow mode."""
        modes = self.car(0).modes()
        slow = np.abs(modes.eigenvalues) < 1
        assert slow.sum() == 1
        assert modes.kinds[int(np.flatnonzero(slow)[0])] == "rigid body"

    def test_without_gain_they_are_those_of_the_drivetrain_alone(self):
        with_it = self.car(0.08, -1e-9, 0).modes().eigenvalues
        elements = [one for one in self.car(0.08).elements.values() if one.name != "jerk"]
        alone = tn.Drivetrain("alone", elements).modes().eigenvalues
        assert with_it[with_it.imag > 1] == pytest.approx(alone[alone.imag > 1], rel=1e-8)


class TestRefused:
    def test_a_stiffness_that_varies_is_named(self):
        table = tn.TabulatedSpring("s", nodes=("a", "ground"), table=[[1, 300, 2], [9, 500, 1]])
        rig = governed(-3)
        with pytest.raises(tn.UsageError, match="unsupported-law"):
            tn.Drivetrain("x", [*rig.elements.values(), table]).modes()

    def test_laws_that_nothing_real_has_in_time(self):
        with pytest.raises(tn.UsageError, match="unsupported-law"):
            governed({"d": -3}, quantity="acceleration").modes()
        with pytest.raises(tn.UsageError, match="unsupported-law"):
            governed(-1, delay=0.1, quantity="acceleration").modes()
