"""Multipliers and contact states of periodic motions against numbers found elsewhere and closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from support.periodic_rigs import (
    branch_over,
    duffing,
    gear_pair,
    problem,
    rubbing_mass,
)

import torsionnet as tn
from torsionnet.motion.periodic.all_branches import from_rest
from torsionnet.motion.periodic.forks import located_doubling
from torsionnet.motion.periodic.periodic_problem import PeriodicMotion, PeriodicProblem
from torsionnet.motion.periodic.stability import stability_of


def _first(one: PeriodicProblem, motion: PeriodicMotion) -> complex:
    return complex(stability_of(one, motion).multipliers[0])


def test_a_high_harmonic_alone_is_answered_at_three_times_it():
    """The same motion under harmonic 1 and, over 40 of its periods, under harmonic 40."""
    slow = problem(duffing(), {"a": [*[0] * 40, 0.18]}, 0.03, hertz=False)
    x = next(from_rest(problem(duffing(), {"a": [0, 0.18]}, 1.2, hertz=False), 1.2)).x
    start = np.zeros((41, 1), dtype=complex)
    start[::40] = x[:2]
    np.testing.assert_allclose(slow.solve(0.03, start).x[::40][:4], x[:4], rtol=1e-5, atol=1e-12)


def test_multipliers_of_a_cubic_spring():
    one = problem(duffing(), {"a": [0, 0.18]}, 0.5, hertz=False)
    motions = branch_over(one, 0.5, 1.3, harmonics=9).at(1.2)
    for motion, wanted in zip(motions, (0.80986 + 0.33732j, 1.314907, 0.48849 + 0.72873j), strict=True):
        found = _first(one, motion)
        assert abs(complex(found.real, abs(found.imag)) - wanted) < 2e-5
    assert [stability_of(one, motion).words for motion in motions] == ["stable", "unstable: leaves", "stable"]


@pytest.mark.parametrize(
    ("force", "frequency", "share"), [(0.5, 15.79710, 0.1546), (3, 13.15039, 0.5275), (10, 10.10376, 0.8994)]
)
def test_friction_slips_for_a_part_of_the_period(force, frequency, share):
    one = problem(rubbing_mass(), {"x": [0, force]}, frequency)
    (motion,) = from_rest(one, frequency)
    stability = stability_of(one, motion)
    assert stability.is_stable
    slips = sum(each.length for each in stability.passage.stretches if each.contact != (1,))
    assert abs(slips / stability.march.period - share) < 2e-4  # four digits are printed; a flat maximum


@pytest.mark.parametrize(
    ("loads", "frequency", "wanted"), [([0, 6], 13, 0.11343 + 0.73519j), ([1, 12, 3j], 16, -0.02330 + 0.83255j)]
)
def test_multipliers_of_friction_behind_a_spring_beside_a_cubic_one(loads, frequency, wanted):
    """Differences of the flow stepped by Runge and Kutta's method from event to event, 4000 steps in a period."""
    cubic = tn.Spring("spring", nodes=("x", "ground"), stiffness=400, cubic=4e5, damping=0.4)
    rub = tn.Friction("rub", nodes=("x", "ground"), torque=2, stiffness=300)
    one = problem(
        tn.Drivetrain("rubbing", [tn.Inertia("m", node="x", inertia=0.1), cubic, rub]), {"x": loads}, frequency
    )
    (motion,) = from_rest(one, frequency)
    found = _first(one, motion)
    assert abs(complex(found.real, abs(found.imag)) - wanted) < 1e-4


def test_doubling_of_points_without_one_between_is_none():
    one = problem(gear_pair(0.06), {"x": [0.12, 0.6]}, 2.5, hertz=False)
    branch = branch_over(one, 2.5, 2.3)
    assert located_doubling(one, branch.points[0], branch.points[1], 1) is None


def test_monodromy_is_the_derivative_of_the_passage_where_a_damped_mesh_closes():
    """The damper of a mesh acts in contact alone, so that the torque jumps there and the slope of the path with it."""
    elements = [
        tn.Inertia("pinion", node="x", inertia=1),
        tn.Inertia("wheel", node="y", inertia=3),
        tn.Spring("hold", nodes=("y", "ground"), stiffness=0.5, damping=0.2),
        tn.Gear("mesh", nodes=("x", "y"), ratio=1, stiffness=1, damping=0.3, backlash=1),
    ]
    one = problem(tn.Drivetrain("damped mesh", elements), {"x": [0.1, 0.25]}, 0.9, hertz=False)
    stability = stability_of(one, next(iter(from_rest(one, 0.9))))
    begin, passed = stability.passage.stretches[0], stability.march.passage
    assert len(stability.passage.stretches) > 2
    steps = 1e-7 * np.eye(len(begin.z))
    slopes = [(passed(begin.z + h, begin.contact).end - passed(begin.z - h, begin.contact).end) / 2e-7 for h in steps]
    np.testing.assert_allclose(np.transpose(slopes), stability.passage.monodromy, atol=1e-6)


@pytest.mark.parametrize(("bearing", "count"), [(0.0, 2), (0.02, 1)])
def test_mass_that_never_touches_its_gap_is_neutral(bearing, count):
    elements = [
        tn.Inertia("oscillator", node="a", inertia=1),
        tn.Spring("spring", nodes=("a", "ground"), stiffness=4000, damping=2),
        tn.Inertia("ball", node="b", inertia=0.05),
        tn.Clearance("gap", nodes=("a", "b"), gap="40 deg", stiffness=2000, damping=0.5),
    ]
    if bearing:
        elements.append(tn.Damper("bearing", nodes=("b", "ground"), damping=bearing))
    (motion,) = tn.Drivetrain("loose", elements).periodic_response("a", frequencies=[9], excitation={"a": 1}).motions
    # the oscillator moves by M/|k - w^2 J + j w c|; its pair of multipliers shrinks by e^(-cT/2J), the ball stays put
    w = 18 * np.pi
    assert abs(motion.highest[0] * abs(4000 - w**2 + 2j * w) - 1) < 1e-6
    assert (np.abs(np.abs(motion.multipliers) - 1) < 1e-6).sum() == count
    assert abs(np.abs(motion.multipliers)[-1] - np.exp(-1 / 9)) < 1e-6
    assert (motion.stability, motion.is_stable) == ("neutral", None)
