"""Period doubling along branches: where it begins, and the motions of twice the period beyond it.

A motion of one period is one of two periods whose odd harmonics, in the numbers of two periods, are zero. Its slope
matrix over two periods falls apart into even and odd harmonics; where the odd part is singular a multiplier passes -1,
and its null vector is the way into the doubled motions.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.motion.periodic.branch import LONGEST_STEP, BranchPoint, MotionBranch, Tracer
from torsionnet.motion.periodic.crossings import located_crossing
from torsionnet.motion.periodic.harmonic_balance import fitted, packed, unpacked
from torsionnet.motion.periodic.periodic_problem import PeriodicMotion, PeriodicProblem
from torsionnet.motion.periodic.stability import stability_of

ENDS = 0.3
"""Share of the largest odd harmonics along a branch of doubled motions below which its end is near."""


@dataclass(frozen=True, eq=False)
class Doubling:
    """Motion at which a multiplier passes -1, and the harmonics over two periods of the way to the doubled motion.

    ``place`` is the number of the point of the branch before it.
    """

    motion: PeriodicMotion
    way: ComplexArray
    place: int = 0


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
    found = np.zeros((2 * len(x) - 1, x.shape[1]), dtype=complex)
    found[::2] = x
    return fitted(found, harmonics)


def _odd(harmonics: int, n_laws: int) -> FloatArray:
    """Places of odd harmonics among packed ones."""
    own = np.arange(1, harmonics + 1, 2)
    per_law = np.concatenate([own, harmonics + own])
    return np.concatenate([per_law + law * (2 * harmonics + 1) for law in range(n_laws)])


def doublings(branch: MotionBranch) -> Iterator[Doubling]:
    """Yield the doublings along a branch in its order."""
    problem, tracer = branch.tracer.problem, branch.tracer
    signs = [np.linalg.slogdet(odd_part(problem, tracer.motion(point)))[0] for point in branch.points]
    for place, ((before, first), (after, second)) in enumerate(pairwise(zip(branch.points, signs, strict=True))):
        if first * second < 0:
            found = located_doubling(problem, before, after, tracer.n_laws, place)
            if found is not None:
                yield found


def located_doubling(
    problem: PeriodicProblem, before: BranchPoint, after: BranchPoint, n_laws: int, place: int = 0
) -> Doubling | None:
    """Doubling between two points of a branch, of which the first has the number ``place``.

    What passes zero is the product of 1 + multiplier, and without multipliers the determinant of the odd part.
    """

    def value(motion: PeriodicMotion) -> float:
        if not problem.plant.has_states or not (stability := stability_of(problem, motion)).has_all:
            sign, size = np.linalg.slogdet(odd_part(problem, motion))
            return float(sign * np.exp(min(size, 500.0)))
        return stability.doubling

    motion = located_crossing(problem, before, after, n_laws, value)
    return None if motion is None else Doubling(motion, _way(problem, motion), place)


def _way(problem: PeriodicProblem, motion: PeriodicMotion) -> ComplexArray:
    _, _, right = np.linalg.svd(odd_part(problem, motion))
    harmonics = 2 * motion.harmonics + 1
    u = np.zeros(len(problem.forces) * (2 * harmonics + 1))
    u[_odd(harmonics, len(problem.forces))] = right[-1]
    return unpacked(u, len(problem.forces))


def doubled_branch(tracer: Tracer, doubling: Doubling, most: int) -> Iterator[BranchPoint]:
    """Yield points of the branch of doubled motions from a doubling on, until it ends at another or comes back.

    ``tracer`` is that of the problem of twice the period.
    """
    motion, harmonics = doubling.motion, tracer.harmonics
    u = packed(doubled(motion.x, harmonics))
    scale = tracer.scale(u, motion.parameter)
    along = np.append(packed(fitted(doubling.way, harmonics)), 0.0) / scale
    odd = _odd(harmonics, tracer.n_laws)
    largest = 0.0
    for point in tracer.along(BranchPoint(motion.parameter, u, along / np.linalg.norm(along), scale), most):
        yield point
        size = float(np.linalg.norm(point.u[odd]))
        largest = max(largest, size)
        # The odd harmonics fade: the other end of the branch, where the motion is a single one again.
        if size < ENDS * largest and size < np.linalg.norm(point.tangent[odd] * point.scale[odd]) * LONGEST_STEP:
            return
