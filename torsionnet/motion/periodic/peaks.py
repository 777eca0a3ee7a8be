"""Peaks of outputs along a branch between the motions that are listed, so that none hides between places asked for.

The points of the branch between two listed motions are looked at; where an output swings further at one of them than
at both, its largest swing is located over the arc length.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from torsionnet.linear.assembly.law_stiffness import Functional
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.motion.periodic.all_branches import FoundBranch
from torsionnet.motion.periodic.branch import BranchPoint, Tracer
from torsionnet.motion.periodic.harmonic_balance import fitted, packed, unpacked
from torsionnet.motion.periodic.periodic_problem import Harmonics, PeriodicMotion, PeriodicProblem, peak_to_peak

HIGHER = 1e-6
"""Share by which a peak is above the motions listed beside it."""
LOCATED = 1e-3
"""Part of two steps along a branch to which a peak is located: its height is known to the square of that."""
LOCATING = 64
"""Most harmonics of a period of the torques with which a peak is located."""


@dataclass(frozen=True, eq=False)
class ListedMotion:
    """Motion of a branch in a result, of a kind ``turn``, behind the point of the branch with the number ``place``."""

    place: int
    motion: PeriodicMotion
    turn: str = ""


def with_peaks(
    branch: FoundBranch, listed: Sequence[ListedMotion], readings: Sequence[Functional], harmonics: Harmonics,
    ends: tuple[float, float],
) -> Iterator[ListedMotion]:  # fmt: skip
    """Yield the motions listed along a branch with the peaks of readings between them, all inside the ``ends``."""
    tracer, points = branch.branch.tracer, branch.branch.points
    inside = [ends[0] <= point.p <= ends[1] for point in points]
    swings = np.array([_swings(branch.problem, tracer.motion(point), readings) for point in points])
    swings[np.logical_not(inside)] = 0.0
    bounds = [None, *listed, None]
    for before, after in pairwise(bounds):
        if before is not None:
            yield before
        first, last = 0 if before is None else before.place + 1, len(points) - 2 if after is None else after.place
        # A peak is looked for where a point of the branch swings further than the motions listed on both sides.
        own = swings[max(first, 1) : last + 1]
        beside = np.array([_swings(branch.problem, end.motion, readings) for end in (before, after) if end is not None])
        if not len(own):
            continue
        peaks: dict[int, ListedMotion] = {}
        for column in np.flatnonzero((own > (1 + HIGHER) * beside.max(axis=0, initial=0.0)).any(axis=0)).tolist():
            place = max(first, 1) + int(own[:, column].argmax())
            top = _top(branch, place, readings[column], harmonics)
            if top is not None and _lies_between(top[0], points[place], before, after, ends):
                peaks.setdefault(place, ListedMotion(place, top[1], "peak"))
        yield from (peaks[place] for place in sorted(peaks))


def _swings(problem: PeriodicProblem, motion: PeriodicMotion, readings: Sequence[Functional]) -> FloatArray:
    """Peaks to peaks (n_out,) of readings of a motion, from its harmonics."""
    return np.array([np.subtract(*peak_to_peak(column)[::-1]) for column in problem.readings(motion, readings).T])


def _top(
    branch: FoundBranch, place: int, reading: Functional, harmonics: Harmonics
) -> tuple[BranchPoint, PeriodicMotion] | None:
    """Largest swing of a reading between the points beside one of a branch, over the arc length: point and motion."""
    problem, (before, after) = branch.problem, (branch.branch.points[place - 1], branch.branch.points[place + 1])
    n_laws = branch.branch.tracer.n_laws
    beside = problem.solve(before.p, unpacked(before.u, n_laws), harmonics)
    if beside is None:
        return None
    # a top is found with few harmonics, and its motion then has as many as it needs
    tracer = Tracer(problem, min(beside.harmonics, LOCATING * problem.subharmonics))
    start = tracer.first(before.p, beside.x, float(np.sign(before.turns)))
    if start is None:
        return None
    other = packed(fitted(unpacked(after.u, n_laws), tracer.harmonics))
    length = float((np.append(other - start.u, after.p - start.p) / start.scale) @ start.tangent)

    def swing(along: float) -> float:
        stepped = tracer.step(start, along)
        return 0.0 if stepped is None else float(_swings(problem, tracer.motion(stepped[0]), [reading])[0])

    if length <= 0:  # with more harmonics the branch goes on the other way
        return None
    top = scipy.optimize.minimize_scalar(lambda along: -swing(along), bounds=(0, length), method="bounded",
                          options={"xatol": LOCATED * length})  # fmt: skip
    stepped = tracer.step(start, float(top.x))
    if stepped is None:
        return None
    motion = problem.solve(stepped[0].p, unpacked(stepped[0].u, n_laws), harmonics)
    return None if motion is None else (stepped[0], motion)


def _lies_between(
    top: BranchPoint, near: BranchPoint, before: ListedMotion | None, after: ListedMotion | None,
    ends: tuple[float, float],
) -> bool:  # fmt: skip
    """Whether a top lies between two listed motions, as the point of the branch near it does."""
    if top.turns * near.turns <= 0 or not ends[0] < top.p < ends[1]:
        return False
    behind = before is None or before.turn == "fold" or (top.p - before.motion.parameter) * top.turns > 0
    return behind and (after is None or after.turn == "fold" or (after.motion.parameter - top.p) * top.turns > 0)
