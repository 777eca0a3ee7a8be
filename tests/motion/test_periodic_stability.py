"""Multipliers, folds, doublings and doubled motions against shooting with exponentials and the exact monodromy."""

from __future__ import annotations

import numpy as np
import pytest
from support.periodic_rigs import (
    CAR_LOADS,
    branch_over,
    car,
    duffing,
    free_clearance,
    gear_pair,
    order_2,
    problem,
    rubbing_mass,
    swing,
    two_stage_rig,
)

import torsionnet as tn
from torsionnet.linear.dynamic_stiffness.transfer_request import resolve_request
from torsionnet.motion.periodic.branch import MotionBranch, Tracer
from torsionnet.motion.periodic.doubling import Doubling, doubled_branch, doublings, located_doubling
from torsionnet.motion.periodic.periodic_problem import PeriodicMotion, PeriodicProblem
from torsionnet.motion.periodic.stability import stability_of
from torsionnet.motion.periodic.starts import from_rest

SHARE = 1e-5
"""Share asked of swings, folds, doublings and order amplitudes."""
MULTIPLIER = 1e-3
"""Error asked of multipliers."""


def _close(found: float, wanted: float, share: float = SHARE) -> None:
    assert abs(found - wanted) <= share * abs(wanted), (found, wanted)


def _first(one: PeriodicProblem, motion: PeriodicMotion) -> complex:
    return complex(stability_of(one, motion).multipliers[0])


def _doubled(one: PeriodicProblem, doubling: Doubling, harmonics: int = 40) -> MotionBranch:
    tracer = Tracer(one.with_subharmonics(2), harmonics)
    return MotionBranch(tracer, tuple(doubled_branch(tracer, doubling, 150)), "doubled")


def test_multipliers_of_a_cubic_spring():
    one = problem(duffing(), {"a": [0, 0.18]}, 0.5, hertz=False)
    motions = branch_over(one, 0.5, 1.3, harmonics=9).at(1.2)
    for motion, wanted in zip(motions, (0.80986 + 0.33732j, 1.314907, 0.48849 + 0.72873j), strict=True):
        found = _first(one, motion)
        assert abs(complex(found.real, abs(found.imag)) - wanted) < 2e-5
    assert [stability_of(one, motion).words for motion in motions] == ["stable", "unstable: leaves", "stable"]


def test_flywheel_of_two_stages_doubles_and_repeats_after_two_periods():
    one = problem(two_stage_rig(), {"motor": [40, 60]}, 25)
    branch = branch_over(one, 25, 14.2)
    upper, lower = doublings(branch)
    _close(upper.motion.parameter, 15.893847)
    _close(lower.motion.parameter, 14.507730)
    (single,) = branch.at(15)
    assert stability_of(one, single).words == "unstable: doubles"
    met = _doubled(one, upper).at(15)[0]
    _close(float(np.ptp(swing(one, met))), 0.17535737)
    _close(abs(met.x[1, 0]), 0.07017412)
    _close(abs(met.x[2, 0]), 0.04118129)
    assert stability_of(one.with_subharmonics(2), met).is_stable


@pytest.mark.slow
def test_flywheel_of_two_stages_at_low_frequencies():
    one = problem(two_stage_rig(), {"motor": [40, 60]}, 25)
    branch = branch_over(one, 25, 3.5)
    for frequency, multiplier in ((11, 1.729186), (4.55, 1.688174), (6.8, -1.472278)):
        found = [_first(one, motion) for motion in branch.at(frequency)]
        worst = max(found, key=abs)
        assert abs(worst - multiplier) < MULTIPLIER
        assert sum(abs(each) > 1 for each in found) == 1
    found = [one_of.motion.parameter for one_of in doublings(branch)]
    for ours, wanted in zip(found, (15.893847, 14.507730, 7.190820, 6.532795), strict=True):
        _close(ours, wanted)
    low = next(each for each in doublings(branch) if each.motion.parameter < 7)
    (met,) = {round(float(np.ptp(swing(one, each))), 9) for each in _doubled(one, low).at(6.8)}
    _close(met, 0.41144030)


def test_multipliers_of_the_gear_pair():
    one = problem(gear_pair(), {"x": [0.1, 0.032]}, 1.5, hertz=False)
    branch = branch_over(one, 1.5, 0.55)
    for frequency, unstable in ((0.8, 1.991761), (0.7, 1.875917)):
        upper, middle, small = sorted(branch.at(frequency), key=lambda each: swing(one, each)[0])
        assert abs(_first(one, middle) - unstable) < 1e-5
        # Damping alone fixes their product, exp(-c 2 pi/W).
        for each in (upper, small):
            assert abs(abs(_first(one, each)) - np.exp(-0.05 * 2 * np.pi / frequency)) < 1e-9


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


def test_clearance_between_free_masses_doubles_from_48_to_28_hertz():
    one = problem(free_clearance(), {"a": [25, 40], "b": [-25, 0]}, 80)
    branch = branch_over(one, 80, 25)
    folds = {each.kind: each.motion.parameter for each in branch.folds()}
    _close(folds["maximum"], 34.161250)
    _close(folds["minimum"], 27.466157)
    high, low = (each.motion.parameter for each in doublings(branch))
    _close(high, 48.316462)
    _close(low, 27.505812)
    expected = {
        50: [(0.01267717, 0.02633979, -0.922627)],
        40: [(0.00584299, 0.02858168, -1.221775)],
        30: [
            (-0.01024941, 0.03218109, -1.315239),
            (-0.02690664, 0.03900662, 2.505880),
            (-0.04250085, 0.05268038, None),
        ],
    }
    for frequency, motions in expected.items():
        for ours, (lowest, highest, multiplier) in zip(branch.at(frequency), motions, strict=True):
            found = swing(one, ours)
            _close(found[0], lowest)
            _close(found[1], highest)
            stability = stability_of(one, ours)
            if multiplier is None:
                assert stability.is_stable
            else:
                assert abs(stability.multipliers[0] - multiplier) < MULTIPLIER


def test_clearance_between_free_masses_as_it_is_met():
    one = problem(free_clearance(), {"a": [25, 40], "b": [-25, 0]}, 80)
    branch = branch_over(one, 80, 47)
    doubled = _doubled(one, next(doublings(branch)))
    for frequency, lowest, highest in ((40, -0.00153571, 0.02895156), (45, 0.00605751, 0.02761135)):
        found = swing(one, doubled.at(frequency)[0])
        _close(found[0], lowest)
        _close(found[1], highest)


def test_half_order_of_a_gear_pair_alone():
    one = problem(gear_pair(0.06), {"x": [0.12, 0.6]}, 2.5, hertz=False)
    (doubling,) = doublings(branch_over(one, 2.5, 1.8))
    _close(doubling.motion.parameter, 1.9318359)
    _close(swing(one, doubling.motion)[0], 0.89464288)
    _close(swing(one, doubling.motion)[1], 1.30165093)
    branch = _doubled(one, doubling)
    for frequency, lowest, highest, half in (
        (1.9, 0.84913817, 1.45737458, 0.16103843),
        (1.85, 0.80286119, 1.51853955, 0.22882425),
    ):
        met = branch.at(frequency)[0]
        _close(swing(one, met)[0], lowest)
        _close(swing(one, met)[1], highest)
        _close(abs(met.x[1, 0]), half)
    again = branch.at(1.8)[0]
    assert abs(_first(branch.tracer.problem, again) + 1.135307) < MULTIPLIER


def test_car_leaves_its_motions_at_two_speeds():
    one = problem(car(), CAR_LOADS, order_2(2000))
    branch = branch_over(one, order_2(2000), order_2(790))
    leaves, caught = sorted((each.motion.parameter * 30 for each in branch.folds()), reverse=True)
    _close(leaves, 1180.922)
    _close(caught, 1102.2643)
    reading = resolve_request(one.plant.placed.drivetrain, "acceleration(gearbox)", "engine", None).outputs
    for rpm, swings, peaks in (
        (800, [0.19337599], [8333.743]),
        (1000, [0.23560961], [9967.141]),
        (1120, [0.18463360, 0.21192727, 0.25114580], []),
        (1150, [0.15954798, 0.22471678, 0.25328757], [5552.713, None, 13089.60]),
        (1300, [0.08927163], [3252.107]),
        (1500, [0.05291269], [983.655]),
    ):
        motions = branch.at(order_2(rpm))
        for motion, wanted in zip(motions, swings, strict=True):
            _close(float(np.ptp(swing(one, motion))), wanted)
        for motion, wanted in zip(motions, peaks, strict=False):
            stability = stability_of(one, motion)
            if wanted is None:
                assert abs(stability.multipliers[0] - 1.6770) < MULTIPLIER
                continue
            found = np.abs(stability.march.read(stability.passage, reading, 4000)).max()
            _close(float(found), wanted)


def test_order_2_makes_order_1_in_the_car():
    one = problem(car(), CAR_LOADS, order_2(2000))
    branch = branch_over(one, order_2(2000), order_2(1450))
    high, low = doublings(branch)
    _close(high.motion.parameter * 30, 1875.612)
    _close(low.motion.parameter * 30, 1529.144)
    (single,) = branch.at(order_2(1700))
    _close(float(np.ptp(swing(one, single))), 0.03577206)
    assert abs(_first(one, single) + 1.5884) < MULTIPLIER
    doubled = _doubled(one, high)
    for rpm, size, first, second in (
        (1700, 0.09489966, 0.03709959, 0.01857517),
        (1600, 0.09359238, 0.03742745, 0.02088838),
    ):
        met = doubled.at(order_2(rpm))[0]
        _close(float(np.ptp(swing(one, met))), size)
        _close(abs(met.x[1, 0]), first)
        _close(abs(met.x[2, 0]), second)


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
