"""Places along a branch at which multipliers pass the unit circle, and the forks from which other branches begin.

A pair of complex multipliers passes the circle where the product of 1 - m_i m_j over all pairs is zero (bialternate
product; Yu. A. Kuznetsov, Elements of Applied Bifurcation Theory, chapter 10): beyond, a second frequency grows that
has no period in common with the torques (Neimark-Sacker). Of two real multipliers m and 1/m it is zero as well;
nothing happens there.

Forks of branches: where the period doubles or symmetry is lost, and the motions that begin there.

A motion of one period is one of two periods whose odd harmonics, in the numbers of two periods, are zero. Its slope
matrix over two periods falls apart into even and odd harmonics; where the odd part is singular a multiplier passes -1,
and its null vector is the way into the doubled motions. So with motions that are their own mirror images half a period
later: their even harmonics are zero, and where the even part is singular a multiplier passes 1 without a fold, and two
lopsided motions begin, mirror images of each other (J. M. T. Thompson, H. B. Stewart, Nonlinear Dynamics and Chaos).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import Literal

import numpy as np

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.motion.periodic.branch import LONGEST_STEP, BranchPoint, MotionBranch, Tracer
from torsionnet.motion.periodic.periodic_problem import PeriodicMotion, PeriodicProblem, fitted, packed, unpacked
from torsionnet.motion.periodic.stability import ON_CIRCLE, stability_of

# Places along a branch at which multipliers pass the unit circle, and the onset of a second frequency among them.

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


# Forks of branches: where the period doubles or symmetry is lost, and the motions that begin there.

ENDS = 0.3
"""Share of the largest new harmonics along a branch from a fork below which its other end is near."""
SYMMETRIC = 1e-9
"""Even harmonics, over the largest, up to which a motion is its own mirror image half a period later."""


@dataclass(frozen=True, eq=False)
class Fork:
    """Motion at which others begin, and the harmonics of the way to them: at a doubling over two periods.

    ``place`` is the number of the point of the branch before it.
    """

    motion: PeriodicMotion
    way: ComplexArray
    place: int = 0
    kind: Literal["doubling", "symmetry"] = "doubling"

    @property
    def periods(self) -> int:
        """Periods of the torques after which the motions that begin repeat."""
        return self.motion.subharmonics * (2 if self.kind == "doubling" else 1)


def odd_part(problem: PeriodicProblem, motion: PeriodicMotion) -> FloatArray:
    """Slope matrix over the odd harmonics of two periods."""
    twice = problem.with_subharmonics(2 * motion.subharmonics)
    harmonics = 2 * motion.harmonics + 1
    balance = twice.balance(motion.parameter, harmonics)
    _, answers, _ = balance.residual(doubled(motion.x, harmonics))
    odd = _odd(harmonics, len(problem.forces))
    return np.asarray(balance.slopes(answers)[np.ix_(odd, odd)])


def doubled(x: ComplexArray, harmonics: int) -> ComplexArray:
    """Harmonics over two periods of a motion with those of one."""
    over_two = np.zeros((2 * len(x) - 1, x.shape[1]), dtype=complex)
    over_two[::2] = x
    return fitted(over_two, harmonics)


def even_part(problem: PeriodicProblem, motion: PeriodicMotion) -> FloatArray:
    """Slope matrix over the even harmonics, the mean among them."""
    balance = problem.balance(motion.parameter, motion.harmonics)
    even = _even(motion.harmonics, len(problem.forces))
    return np.asarray(balance.slopes(balance.answers(motion.x))[np.ix_(even, even)])


def _odd(harmonics: int, n_laws: int) -> FloatArray:
    """Places of odd harmonics among packed ones."""
    own = np.arange(1, harmonics + 1, 2)
    per_law = np.concatenate([own, harmonics + own])
    return np.concatenate([per_law + law * (2 * harmonics + 1) for law in range(n_laws)])


def _even(harmonics: int, n_laws: int) -> FloatArray:
    """Places of even harmonics among packed ones, the mean first."""
    own = np.arange(2, harmonics + 1, 2)
    per_law = np.concatenate([[0], own, harmonics + own])
    return np.concatenate([per_law + law * (2 * harmonics + 1) for law in range(n_laws)])


def doublings(branch: MotionBranch) -> Iterator[Fork]:
    """Yield the doublings along a branch in its order."""
    problem, tracer = branch.tracer.problem, branch.tracer
    signs = [np.linalg.slogdet(odd_part(problem, tracer.motion(point)))[0] for point in branch.points]
    for place, (first, second) in enumerate(pairwise(signs)):
        if first * second < 0:
            before, after = branch.points[place], branch.points[place + 1]
            doubling = located_doubling(problem, before, after, tracer.n_laws, place)
            if doubling is not None:
                yield doubling


def losses_of_symmetry(branch: MotionBranch) -> Iterator[Fork]:
    """Yield the motions of a branch at which symmetry is lost, in its order; none where no motion is symmetric."""
    problem, tracer = branch.tracer.problem, branch.tracer
    if not all(_is_symmetric(unpacked(point.u, tracer.n_laws)) for point in branch.points):
        return

    def value(motion: PeriodicMotion) -> float:
        if not problem.plant.has_states or not (stability := stability_of(problem, motion)).has_all:
            return _determinant(even_part(problem, motion))
        return float(np.prod(1 - stability.multipliers).real)

    signs = [np.linalg.slogdet(even_part(problem, tracer.motion(point)))[0] for point in branch.points]
    for place, (first, second) in enumerate(pairwise(signs)):
        if first * second < 0:
            before, after = branch.points[place], branch.points[place + 1]
            motion = located_crossing(problem, before, after, tracer.n_laws, value)
            if motion is not None:
                even = _even(motion.harmonics, tracer.n_laws)
                way = _way(even_part(problem, motion), even, motion.harmonics, tracer.n_laws)
                yield Fork(motion, way, place, "symmetry")


def _is_symmetric(x: ComplexArray) -> bool:
    return bool(np.abs(x[::2]).max() <= SYMMETRIC * np.abs(x).max())


def _determinant(matrix: FloatArray) -> float:
    sign, size = np.linalg.slogdet(matrix)
    return float(sign * np.exp(min(size, 500.0)))


def located_doubling(
    problem: PeriodicProblem, before: BranchPoint, after: BranchPoint, n_laws: int, place: int = 0
) -> Fork | None:
    """Doubling between two points of a branch, of which the first has the number ``place``.

    What passes zero is the product of 1 + multiplier, and without multipliers the determinant of the odd part.
    """

    def value(motion: PeriodicMotion) -> float:
        if not problem.plant.has_states or not (stability := stability_of(problem, motion)).has_all:
            return _determinant(odd_part(problem, motion))
        return stability.doubling

    motion = located_crossing(problem, before, after, n_laws, value)
    if motion is None:
        return None
    harmonics = 2 * motion.harmonics + 1
    return Fork(motion, _way(odd_part(problem, motion), _odd(harmonics, n_laws), harmonics, n_laws), place)


def _way(part: FloatArray, places: FloatArray, harmonics: int, n_laws: int) -> ComplexArray:
    """Harmonics of the null vector of a part of the slope matrix, which has these places among the packed ones."""
    u = np.zeros(n_laws * (2 * harmonics + 1))
    u[places] = np.linalg.svd(part)[2][-1]
    return unpacked(u, n_laws)


def forked_branch(tracer: Tracer, fork: Fork, most: int) -> Iterator[BranchPoint]:
    """Yield points of the branch that begins at a fork, until it ends at another or comes back.

    ``tracer`` is that of the problem with the period of its motions.
    """
    motion, harmonics = fork.motion, tracer.harmonics
    doubles = fork.kind == "doubling"
    u = packed(doubled(motion.x, harmonics) if doubles else fitted(motion.x, harmonics))
    scale = tracer.scale(u, motion.parameter)
    along = np.append(packed(fitted(fork.way, harmonics)), 0.0) / scale
    new = (_odd if doubles else _even)(harmonics, tracer.n_laws)
    largest = 0.0
    for point in tracer.along(BranchPoint(motion.parameter, u, along / np.linalg.norm(along), scale), most):
        yield point
        size = float(np.linalg.norm(point.u[new]))
        largest = max(largest, size)
        # The new harmonics fade: the other end of the branch, where the motion is one of the branch that it left.
        if size < ENDS * largest and size < np.linalg.norm(point.tangent[new] * point.scale[new]) * LONGEST_STEP:
            return
