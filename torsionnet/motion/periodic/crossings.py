"""Places along a branch at which multipliers pass the unit circle, and the onset of a second frequency among them.

A pair of complex multipliers passes the circle where the product of 1 - m_i m_j over all pairs is zero (bialternate
product; Yu. A. Kuznetsov, Elements of Applied Bifurcation Theory, chapter 10): beyond, a second frequency grows that
has no period in common with the torques (Neimark-Sacker). Of two real multipliers m and 1/m it is zero as well;
nothing happens there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import combinations, pairwise

import numpy as np

from torsionnet.linear.assembly.rows import ComplexArray
from torsionnet.motion.periodic.branch import BranchPoint, MotionBranch
from torsionnet.motion.periodic.harmonic_balance import unpacked
from torsionnet.motion.periodic.periodic_problem import PeriodicMotion, PeriodicProblem
from torsionnet.motion.periodic.stability import ON_CIRCLE, stability_of

LOCATED = 1e-8
"""Share of the parameter to which a crossing is located."""
APART, MOST_LOOKS = 6, 50
"""Points of a branch from one look at its multipliers to the next, and most looks."""
PASSING = 1e-4
"""Distance from the unit circle of a pair that passes it at a located place."""


def located_crossing(
    problem: PeriodicProblem,
    before: BranchPoint,
    after: BranchPoint,
    n_laws: int,
    value: Callable[[PeriodicMotion], float | None],
) -> PeriodicMotion | None:
    """Motion between two points of a branch at which a value passes zero, by the rule of false positions (Illinois)."""

    def at(parameter: float, near: PeriodicMotion | None = None) -> tuple[PeriodicMotion, float] | None:
        share = (parameter - before.p) / (after.p - before.p)
        between = unpacked(before.u + share * (after.u - before.u), n_laws)
        motion = problem.solve(parameter, between if near is None else near.x)
        passed = None if motion is None else value(motion)
        return None if motion is None or passed is None else (motion, passed)

    span = after.p - before.p
    ends = at(before.p), at(after.p)
    # Few harmonics may see a crossing a little beside its place.
    for _ in range(3):
        if ends[0] is None or ends[1] is None or ends[0][1] * ends[1][1] <= 0:
            break
        before_p, after_p = ends[0][0].parameter - span / 2, ends[1][0].parameter + span / 2
        ends = at(before_p), at(after_p)
    if ends[0] is None or ends[1] is None or ends[0][1] * ends[1][1] > 0:
        return None
    (motion, fb), (other, fa) = ends[1], ends[0]
    a, b = other.parameter, motion.parameter
    for _ in range(60):
        c = (a * fb - b * fa) / (fb - fa)
        # the last motion has all the harmonics that it needs
        further = at(c, motion)
        if further is None:
            return None
        motion, fc = further
        if fc * fb < 0:
            a, fa = b, fb
        else:
            fa /= 2
        moved, b, fb = abs(c - b), c, fc
        if moved <= LOCATED * abs(c) or fc == 0:
            break
    return motion


def second_frequencies(branch: MotionBranch) -> Iterator[tuple[int, PeriodicMotion]]:
    """Yield the motions of a branch at which a second frequency sets in or ends, with the number of the point before.

    Every few points are looked at: a frequency that sets in and ends between two looks is not seen.
    """
    problem, points = branch.tracer.problem, branch.points
    if not problem.plant.has_states:
        return

    def value(motion: PeriodicMotion) -> float | None:
        stability = stability_of(problem, motion)
        return None if stability.undetermined else _pairs(stability.multipliers)

    def at(place: int) -> float | None:
        return value(branch.tracer.motion(points[place]))

    looks = [
        (place, passed)
        for place in range(0, len(points), max(APART, len(points) // MOST_LOOKS))
        if (passed := at(place)) is not None
    ]
    for (start, first), (end, second) in pairwise(looks):
        if first * second >= 0:
            continue
        i, j = start, end
        while j - i > 1:  # halve the stretch of points
            middle = (i + j) // 2
            there = at(middle)
            if there is None:
                break
            i, j = (middle, j) if there * first > 0 else (i, middle)
        motion = located_crossing(problem, points[i], points[j], branch.tracer.n_laws, value)
        if motion is not None and _passes(stability_of(problem, motion).multipliers):
            yield i, motion


def _pairs(multipliers: ComplexArray) -> float:
    """Product of 1 - m_i m_j over all pairs of multipliers."""
    return float(np.prod([1 - left * right for left, right in combinations(multipliers.tolist(), 2)]).real)


def _passes(multipliers: ComplexArray) -> bool:
    """Whether a complex pair of multipliers lies on the unit circle."""
    pairs = multipliers[np.abs(multipliers.imag) > ON_CIRCLE**0.5]
    return bool((np.abs(np.abs(pairs) - 1) < PASSING).any())
