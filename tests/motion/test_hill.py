"""Stability by Hill's determinant against monodromies, stepped disturbances with a delay, and folds."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from support.periodic_rigs import branch_over, duffing, free_clearance, problem, rubbing_mass, two_stage_rig

import torsionnet as tn
from torsionnet.motion.periodic.periodic_result import PeriodicResponse
from torsionnet.motion.periodic.stability import hill_multipliers, stability_of

MULTIPLIER = 1e-3
"""Error asked of multipliers."""


@pytest.mark.parametrize(
    ("rig", "loads", "start", "end", "at", "hertz"),
    [
        (duffing, {"a": [0, 0.18]}, 0.5, 1.3, 1.2, False),
        (two_stage_rig, {"motor": [40, 60]}, 25, 10, 11, True),
        (free_clearance, {"a": [25, 40], "b": [-25, 0]}, 80, 29, 30, True),
    ],
)
def test_largest_multipliers_are_those_of_the_monodromy(rig, loads, start, end, at, hertz):
    one = problem(rig(), loads, start, hertz=hertz)
    motions = branch_over(one, start, end).at(at)
    assert motions
    for motion in motions:
        exact = stability_of(one, motion).multipliers
        growing, found = hill_multipliers(one, motion)
        assert growing == int((np.abs(exact) > 1).sum())
        assert np.abs(exact - found[0]).min() < MULTIPLIER
        if growing:
            assert abs(exact[0] - found[0]) < MULTIPLIER


W, DELAY_STEPS, STEPS = 1.2, 40, 2000


def _delayed(gain: float) -> tn.Drivetrain:
    brake = tn.Controller("brake", sense={"velocity": "a"}, act="a", law=gain, delay=2 * pi / W * DELAY_STEPS / STEPS)
    return tn.Drivetrain("delayed", [*duffing().elements.values(), brake])


def _stepped(motion: PeriodicResponse, gain: float) -> complex:
    """Multiplier of y'' + .05 y' + (1 + .3 x^2) y = gain y'(t - tau) by Heun's method, x being the motion found."""
    h, k = 2 * pi / W / STEPS, np.arange(len(motion.amplitudes))
    x = (motion.amplitudes[:, 0] * np.exp(2j * pi * np.arange(STEPS)[:, None] * k / STEPS)).sum(axis=1).real
    stiffness = (1 + 0.3 * x**2).tolist()
    y, v = 1.0, 0.0
    speeds, kept = [0.0] * (DELAY_STEPS + 1), []
    for n in range(40 * STEPS):
        if n % STEPS == 0:
            kept.append(y)
        before, after = speeds[n], speeds[n + 1]
        first = -0.05 * v - stiffness[n % STEPS] * y + gain * before
        then_y, then_v = y + h * v, v + h * first
        second = -0.05 * then_v - stiffness[(n + 1) % STEPS] * then_y + gain * after
        y, v = y + h / 2 * (v + then_v), v + h / 2 * (first + second)
        speeds.append(v)
    # y_(n+2) = 2 Re(m) y_(n+1) - |m|^2 y_n once the largest pair alone is left
    a, b, c, d = kept[-4:]
    twice, square = np.linalg.solve([[b, -a], [c, -b]], [c, d])
    return complex(twice / 2, np.sqrt(square - (twice / 2) ** 2))


@pytest.mark.parametrize(("gain", "stable"), [(-0.1, True), (0.1, False)])
def test_delayed_torque_has_the_multipliers_of_stepped_disturbances(gain, stable):
    found = _delayed(gain).periodic_response("a", frequencies=np.array([W, 1.25]) / (2 * pi), excitation={"a": 0.3})
    motion = min(found.motions_at(W / (2 * pi)), key=lambda one: float(one.highest[0]))
    assert motion.is_stable is stable
    pair = motion.multipliers[np.abs(motion.multipliers.imag) > 0][0]
    assert abs(complex(pair.real, abs(pair.imag)) - _stepped(motion, gain)) < MULTIPLIER
    assert motion.stability == ("stable" if stable else "unstable: a second frequency grows")


def test_loss_factors_let_the_middle_of_three_motions_leave():
    mass, _ = duffing().elements.values()
    spring = tn.Spring("spring", nodes=("a", "ground"), stiffness=0.8, cubic=0.1)
    rubber = tn.HystereticSpring("rubber", nodes=("a", "ground"), stiffness=0.2, loss_factor=0.3)
    rig = tn.Drivetrain("rubber", [mass, spring, rubber])
    found = rig.periodic_response("a", frequencies=np.array([0.5, 1.2, 1.6]) / (2 * pi), excitation={"a": 0.18})
    three = sorted(found.motions_at(1.2 / (2 * pi)), key=lambda one: float(one.highest[0]))
    assert [one.stability for one in three] == ["stable", "unstable: leaves", "stable"]
    # At a fold a multiplier is 1.
    folds = found.turns("fold")
    assert len(folds) == 2
    for one in folds:
        assert np.abs(one.multipliers - 1).min() < MULTIPLIER


def test_sliding_friction_beside_a_delay_leaves_stability_open():
    brake = tn.Controller("brake", sense={"velocity": "x"}, act="x", law=-0.1, delay=0.001)
    rig = tn.Drivetrain("rubbing", [*rubbing_mass().elements.values(), brake])
    found = rig.periodic_response("x", frequencies=[13.0, 13.1], excitation={"x": 3})
    assert {one.stability for one in found.motions} == {"stability not determined"}
