"""Drivetrains that turn freely under delayed controllers: zero is a multiple root, and no slow pole beside it."""

import math
import os
import subprocess
import sys
import time
import warnings
from collections import Counter
from fractions import Fraction
from pathlib import Path

import mpmath
import numpy as np
import pytest
from click.testing import CliRunner
from support import campaigns, kernels
from support.controlled_plants import Plant
from support.free_plants import DIGITS, HOLDS, FreePlant
from support.study_blocks import singly

import torsionnet as tn
from torsionnet.app.cli.app import app
from torsionnet.linear.modes.active_pencil import ActivePencil
from torsionnet.linear.modes.exact_pencil import DelayedSum, ExactPencil, zero_chains
from torsionnet.study.quantities.quantity import QUANTITIES


def jerk_control(*more, delay="12 ms", gain=-5, **entries):
    """A motor that damps the twist of its shaft to the car."""
    elements = [
        tn.Inertia("motor", node="a", inertia=0.28),
        tn.Spring("shaft", nodes=("a", "b"), stiffness=5000, damping=4),
        tn.Inertia("car", node="b", inertia=120),
        tn.Controller("jerk", sense={"velocity": ["a", "b"]}, act="a", law={"p": gain}, delay=delay),
    ]
    return tn.Drivetrain("car", [*elements, *more], **entries)


def random_car(seed, eta=0.0):
    rng = np.random.default_rng(seed)
    motor, car, k = 10 ** rng.uniform(-2, 0.5), 10 ** rng.uniform(0.5, 2.5), 10 ** rng.uniform(2.5, 5)
    size = math.sqrt(k * motor)
    damping, loss = rng.uniform(0, 0.02) * size, rng.uniform(0.01, 0.1)
    gain, delay = -rng.uniform(0.02, 1.5) * size * rng.choice([1, 1, 1, -0.2]), 10 ** rng.uniform(-3.3, -1.2)
    shaft = tn.Spring("shaft", nodes=("a", "b"), stiffness=k, damping=damping)
    if eta:
        shaft = tn.HystereticSpring("shaft", nodes=("a", "b"), stiffness=k, loss_factor=eta * loss)
    elements = [
        tn.Inertia("motor", node="a", inertia=motor),
        shaft,
        tn.Inertia("car", node="b", inertia=car),
        tn.Controller("jerk", sense={"velocity": ["a", "b"]}, act="a", law={"p": gain}, delay=delay),
    ]
    return tn.Drivetrain("car", elements)


def quiet_modes(rig):
    """Modes without a doubt."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return rig.modes()


def require_one_rigid_body(rig):
    modes = quiet_modes(rig)
    assert modes.kinds.count("rigid body") == 1
    slow = modes.eigenvalues[(modes.eigenvalues != 0) & (np.abs(modes.eigenvalues) < 1e-2)]
    assert not slow.size


def chain(masses):
    elements = [tn.Inertia(f"j{i}", node=f"n{i}", inertia=0.05) for i in range(masses - 1)]
    elements += [tn.Inertia("car", node=f"n{masses - 1}", inertia=120)]
    elements += [
        tn.Spring(f"k{i}", nodes=(f"n{i}", f"n{i + 1}"), stiffness=1e5 if i else 5e3, damping=2)
        for i in range(masses - 1)
    ]
    jerk = tn.Controller("jerk", sense={"velocity": ["n0", "n2"]}, act="n0", law=-3, delay="4 ms")
    return tn.Drivetrain("chain", [*elements, jerk])


class TestCar:
    def test_modes(self):
        modes = quiet_modes(jerk_control())
        assert modes.kinds[0] == "rigid body"
        assert modes.eigenvalues[0] == 0
        assert modes.natural_frequencies[1:3] == pytest.approx([22.8596521, 37.25101683], rel=1e-8)
        assert modes.damping_ratios[1] == pytest.approx(0.04258802, rel=1e-6)

    def test_is_stable_and_keeps_its_margins(self):
        rig = jerk_control()
        assert not [fault for fault in rig.check() if "unstable" in fault.message]
        margins = rig.loop_margins()
        assert margins.stable
        assert margins.phase.value == pytest.approx(47.58, abs=0.005)
        assert "the drivetrain is stable" in str(margins.table())

    def test_a_study_reads_the_vibration(self):
        rig = jerk_control(gain="g", parameters={"g": -5})
        block = singly(rig, {"g": np.array([-5.0, -4.0])})
        found = QUANTITIES["natural_frequency"](mode=1).evaluate(block)
        assert found[0] == pytest.approx(22.8596521, rel=1e-8)

    def test_a_slow_pole_beside_two_zeros_is_found(self):
        """A drag of 1e-4 N m s/rad on 120.28 kg m^2: one zero, and -c/J, slower than what rounding makes of zeros."""
        modes = quiet_modes(jerk_control(tn.Damper("drag", nodes=("b", "ground"), damping=1e-4)))
        assert modes.kinds[:2] == ("rigid body", "real pole")
        assert modes.eigenvalues[1].real == pytest.approx(-1e-4 / 120.28, rel=1e-6)

    @pytest.mark.parametrize("seed", range(12))
    def test_random_cars_have_no_slow_pole(self, seed):
        require_one_rigid_body(random_car(seed))

    @pytest.mark.parametrize("seed", range(3))
    def test_nor_with_a_loss_factor(self, seed):
        require_one_rigid_body(random_car(seed, eta=1.0))

    @pytest.mark.slow
    def test_a_delay_beyond_all_time_is_quiet(self):
        elements = [
            tn.Inertia("flywheel", node="fly", inertia=780),
            tn.Spring("rubber", nodes=("fly", "load"), stiffness=11000),
            tn.Inertia("load", node="load", inertia=9),
            tn.Controller(
                "governor", sense={"velocity": ["fly", "load"]}, act="fly", law={"p": -40, "i": -90}, delay="1e15 ms"
            ),
        ]
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            warnings.simplefilter("ignore", tn.TorsionnetWarning)
            modes = tn.Drivetrain("long", elements).modes()
        assert modes.kinds[0] == "rigid body"

    @pytest.mark.slow
    def test_a_chain_of_45_keeps_its_rigid_body(self):
        modes = quiet_modes(chain(45))
        assert modes.kinds[0] == "rigid body"
        assert modes.natural_frequencies[1] == pytest.approx(8.0009904, rel=1e-6)

    @pytest.mark.slow
    def test_whole_turns_of_several_long_delays_are_counted(self):
        """Between 64 points of the circle the phase turned by up to 9 rad: the count fell short of what was found."""
        inertias, stiffnesses = (233.0, 0.0731, 0.0147, 228.0), (2e4, 3e5, 5e3)
        elements = [tn.Inertia(f"J{i}", node=f"n{i}", inertia=J) for i, J in enumerate(inertias)]
        elements += [tn.Spring(f"k{i}", nodes=(f"n{i}", f"n{i + 1}"), stiffness=k) for i, k in enumerate(stiffnesses)]
        first = {"numerator": [0.00308, -0.0628], "denominator": [0.0559, 1.0]}
        elements += [
            tn.Controller("one", sense={"velocity": ["n3", "n1"]}, act="n1", law=first, delay="36.6 ms"),
            tn.Controller("two", sense={"velocity": ["n1", "n0"]}, act=["n1", "n2"], law=0.00648, delay="22.7 ms"),
        ]
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            tn.Drivetrain("two delays", elements).modes()
        assert not [one for one in caught if "poles lie below" in str(one.message)]


class TestZero:
    """How often zero is a root, and the chains that it is taken out by."""

    def chains(self, rig):
        exact = ExactPencil.of(rig.assembly)
        found = zero_chains(exact, [1.0] * exact.size)
        zeros = sum(chain.order for chain in found.values())
        assert exact.counts(zeros + 2)[1] == zeros
        return sorted((chain.order, len(chain.motion)) for chain in found.values())

    def test_what_turns_freely_has_two(self):
        assert self.chains(jerk_control()) == [(2, 1)]

    def test_a_drag_leaves_one(self):
        assert self.chains(jerk_control(tn.Damper("drag", nodes=("b", "ground"), damping="1e-30 N*m*s/rad"))) == [
            (1, 1)
        ]

    def test_an_internal_torque_that_follows_a_speed_twists_the_shaft(self):
        """x(s) = 1 + s x_1: a turning drivetrain has a torque in it, and stands twisted."""
        inside = tn.Controller("brake", sense={"velocity": "a"}, act=("a", "b"), law=-3, delay="5 ms")
        (chain,) = self.chains(jerk_control(inside))
        assert chain == (2, 2)

    def test_an_integral_holds_the_speed(self):
        held = tn.Controller("governor", sense={"velocity": "a"}, act="a", law={"p": -3, "i": -2}, delay="5 ms")
        assert self.chains(jerk_control(held)) == []

    def test_an_integral_of_a_twist_counts(self):
        """T = -2 (a - b)/s on the motor: a constant torque of it turns everything ever faster."""
        law = {"numerator": [-2], "denominator": [1, 0]}
        pull = tn.Controller("pull", sense={"angle": ["a", "b"]}, act="a", law=law, delay="5 ms")
        assert self.chains(jerk_control(pull)) == [(2, 1)]

    def test_two_bodies_with_a_damper_between(self):
        slip = [tn.Damper("slip", nodes=("b", "c"), damping=2), tn.Inertia("trailer", node="c", inertia=30)]
        assert self.chains(jerk_control(*slip)) == [(1, 1), (2, 1)]
        modes = quiet_modes(jerk_control(*slip))
        assert modes.kinds.count("rigid body") == 2
        slow = modes.eigenvalues[modes.kinds.index("real pole")]
        assert slow.real == pytest.approx(-2 * (1 / 30 + 1 / 120.28), rel=1e-3)

    def test_values_that_only_nearly_cancel_are_not_zero(self):
        """An angle fed back against a spring to ground: exactly as stiff, and by one part in 1e25 less."""
        for gain, zeros in ((Fraction(100), 2), (Fraction(100) - Fraction(1, 10**23), 0)):
            spring = tn.Spring("hold", nodes=("b", "ground"), stiffness=100)
            push = tn.Controller("push", sense={"angle": "b"}, act="b", law=gain)
            exact = ExactPencil.of(jerk_control(spring, push).assembly)
            assert sum(chain.order for chain in zero_chains(exact, [1.0] * exact.size).values()) == zeros

    @pytest.mark.parametrize("power", [0, 2, -1, -3])
    def test_columns_with_delays_are_those_of_many_digits(self, power):
        """p s^m e^(-s tau) without the powers of s below zero, and its rate."""
        one = DelayedSum(0, ((power, 3.0),), 0.02)
        for s in (1e-9 + 1e-9j, -3 + 40j, 120 - 5j, -700 + 900j):
            with mpmath.workdps(DIGITS):

                def exact(z):
                    below = sum((-z * mpmath.mpf("0.02")) ** m / mpmath.factorial(m) for m in range(max(-power, 0)))
                    return -3 * z**power * (mpmath.exp(-z * mpmath.mpf("0.02")) - below)

                point = mpmath.mpmathify(s)
                value, slope = complex(exact(point)), complex(mpmath.diff(exact, point, h=mpmath.mpf(10) ** -30))
            assert one.value_at(s) == pytest.approx(value, rel=1e-12)
            assert one.derivative(s) == pytest.approx(slope, rel=1e-9)


@pytest.mark.parametrize("delay", ["12 ms", "1e15 ms"])
def test_a_doubt_about_the_count_is_told_once_and_all_poles_are_not_said_to_be_here(tmp_path, delay):
    (tmp_path / "car.yaml").write_text(jerk_control(delay=delay).to_yaml(), encoding="utf-8")
    done = CliRunner().invoke(app, ["modes", str(tmp_path / "car.yaml")])
    assert done.exit_code == 0
    told = done.stderr.splitlines()
    assert len(told) == len(set(told))
    doubted = any("with the delay" in line for line in told)
    assert doubted == (delay == "1e15 ms")
    assert ("are all here" in done.stdout) == (not doubted)
    assert ("may lack some here" in done.stdout) == doubted


class TestRandom:
    def test_what_is_drawn(self):
        plants = [FreePlant(seed) for seed in range(40)]
        assert Counter(plant.hold for plant in plants) == dict.fromkeys(HOLDS, 8)
        assert sum(plant.delayed for plant in plants) == 20
        integrate = sum(any(below[-1] == 0 for _, _, _, _, below, _ in plant.laws) for plant in plants)
        assert integrate >= 15
        zeros = Counter(ActivePencil(plant.rig.assembly).zeros for plant in plants[:10])
        assert set(zeros) >= {0, 1, 2, 3}

    @pytest.mark.slow
    def test_the_plants_of_other_tests_turn_freely_as_often_as_not(self):
        plants = [Plant(seed, delay=True, forms=("pid", "polynomials")) for seed in range(40)]
        assert sum(plant.freely for plant in plants) == 20
        assert sum(plant.apart for plant in plants) == 10
        doubled = [seed for seed, plant in enumerate(plants) if ActivePencil(plant.rig.assembly).zeros > 1]
        assert len(doubled) >= 15

    @pytest.mark.few(1)
    @pytest.mark.parametrize("seed", range(6))
    def test_poles_are_those_of_fifty_digits(self, seed):
        self.compare(FreePlant(seed))

    def compare(self, plant):
        modes = quiet_modes(plant.rig)
        poles = modes.eigenvalues[modes.eigenvalues != 0]
        assert max((plant.moved(pole) for pole in poles), default=0) < 1e-9
        radius = min(1e-9, np.abs(poles).min() / 2)
        assert plant.within(radius, points=24) == ActivePencil(plant.rig.assembly).zeros
        return poles

    @pytest.mark.slow
    @pytest.mark.parametrize("part", campaigns.by_day(range(8), 0))
    def test_and_as_many(self, part):
        """By the argument principle in fifty digits, within the circle of which it is said that all poles are here."""
        for seed in range(25 * part, 25 * part + campaigns.examples(3, 25)):
            plant = FreePlant(seed)
            poles = self.compare(plant)
            radius = 1.001 * np.abs(poles).max()
            if plant.delayed:
                (note,) = plant.rig.modes().notes
                radius = 2 * math.pi * float(note.partition("those below ")[2].partition(" Hz")[0])
            found = sum(1 if pole.imag == 0 else 2 for pole in poles if abs(pole) < radius)
            assert plant.within(radius) == found + ActivePencil(plant.rig.assembly).zeros


class TestMany:
    @pytest.mark.slow
    @pytest.mark.parametrize("below", campaigns.by_day(range(3), 1))
    def test_under_every_kernel(self, below):
        """Another kernel of OpenBLAS rounds differently; without OpenBLAS the word does nothing.

        Kernels above the processor's own are left out: it does not know their instructions and ends the process.
        """
        names = kernels.own_and_lower()
        if below >= len(names):
            pytest.skip(f"this processor runs {len(names)} kernels")
        environment = {**os.environ, "OPENBLAS_CORETYPE": names[below], "OPENBLAS_NUM_THREADS": "1"}
        environment["PYTHONPATH"] = str(Path(__file__).parents[1])  # helpers
        call = [sys.executable, __file__, str(campaigns.examples(40, 300))]
        done = subprocess.run(call, env=environment, capture_output=True, text=True, timeout=600, check=False)
        assert done.returncode == 0, done.stderr[-2000:]

    @pytest.mark.slow
    @pytest.mark.parametrize(("masses", "seconds"), [(45, 6), pytest.param(160, 40, marks=pytest.mark.nightly)])
    def test_many_masses_are_solved_and_counted_soon(self, masses, seconds):
        """In processor time, of three tries the shortest: a busy machine makes each of them longer."""
        taken = []
        while len(taken) < 3 and min(taken, default=math.inf) > seconds:
            began = time.process_time()
            require_one_rigid_body(chain(masses))
            taken.append(time.process_time() - began)
        assert min(taken) <= seconds


def main(cars):
    for seed in range(cars):
        require_one_rigid_body(random_car(seed))
    for seed in range(cars // 8):
        require_one_rigid_body(random_car(seed, eta=1.0))


if __name__ == "__main__":
    main(int(sys.argv[1]))
