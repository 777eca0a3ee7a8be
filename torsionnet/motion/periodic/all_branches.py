"""Search for all branches of periodic motions over a range of a parameter, each with the way by which it was found.

From rest at both ends and in the middle of the range; from starts of other sizes and phases, for branches that nothing
joins to these; from motions simulated from a given state; from forks. There may be more: nothing short of a search
of all starts would rule that out.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsionnet.linear.assembly.rows import ComplexArray
from torsionnet.motion.contact_states import MotionStart
from torsionnet.motion.periodic.branch import BranchPoint, MotionBranch, Tracer
from torsionnet.motion.periodic.crossings import second_frequencies
from torsionnet.motion.periodic.doubling import Fork, doublings, forked_branch, losses_of_symmetry
from torsionnet.motion.periodic.harmonic_balance import fitted
from torsionnet.motion.periodic.periodic_problem import Harmonics, PeriodicMotion, PeriodicProblem
from torsionnet.motion.periodic.starts import from_rest, mean_start
from torsionnet.motion.periodic.stepped_starts import from_simulation
from torsionnet.motion.scenarios.scenario import REST

TRACED = 20
"""Harmonics with which branches are followed; motions at the parameters asked for have as many as they need."""
MOST_POINTS, MOST_FOLLOWED, OWN = 400, 600, 100
"""Most points of a branch in a direction, and of all together, since some have no end; from rest each has some."""
FEWEST_ROUND = 5
"""Fewest points of a branch that comes back to where it began."""
WIDER = 1e-3
"""Share by which a branch is followed beyond the range, so that its ends are inside."""
SAME = 1e-3
"""Share of a motion by which another may differ and still be the same one."""
FINER = (1, 2, 4)
"""Harmonics, over those with which branches are followed, that are tried from a fork on: few see it a little aside."""
NEAR = 0.2
"""Share of a motion by which one between two points of a branch may differ that may lead to it."""
STARTS = tuple((size, phase) for size in (1.0, 3.0, 10.0) for phase in (1.0, -1.0, 1j, -1j))
"""Sizes and phases, over the motion with springs in place of the laws, of starts for branches that nothing joins."""


@dataclass(frozen=True, eq=False)
class FoundBranch:
    """Branch with its forks, and the fork at which it begins, if it does.

    ``second_frequencies`` are the motions at which a second frequency sets in or ends, each with the number of the
    point before it, and ``unfollowed`` the forks whose branches were one too many.
    """

    branch: MotionBranch
    forks: tuple[Fork, ...]
    second_frequencies: tuple[tuple[int, PeriodicMotion], ...] = ()
    begins: Fork | None = None
    unfollowed: tuple[Fork, ...] = ()

    @property
    def problem(self) -> PeriodicProblem:
        """Problem whose period the motions have."""
        return self.branch.tracer.problem


def all_branches(
    problem: PeriodicProblem,
    low: float,
    high: float,
    harmonics: Harmonics = "auto",
    subharmonics: int = 1,
    state: str | MotionStart | None = None,
) -> list[FoundBranch]:
    """Branches between two parameters, with motions of up to ``subharmonics`` periods of the torques.

    From a ``state`` motions are simulated as well, at both ends and in the middle.
    """
    traced = max(TRACED, problem.driven_to) if harmonics == "auto" else harmonics
    branches: list[FoundBranch] = []

    def left() -> int:
        return MOST_FOLLOWED - sum(len(each.branch.points) for each in branches)

    # Starts from which branches are reached: torques that grow from nothing, other sizes, a simulated motion.
    middle = np.sqrt(low * high)
    for at in dict.fromkeys((high, low, middle)):
        for motion in from_rest(problem, at):
            if not _lies_on_a_branch(branches, motion):
                most = max(left(), OWN)
                branches.append(_with_crossings(_both_ways(problem, motion, (low, high), traced, "from rest", most)))
    for motion in _other_starts(problem, (middle, low, high), traced):
        if left() > 0 and not _lies_on_a_branch(branches, motion):
            way = "from a start of another size, joined to no other"
            branches.append(_with_crossings(_both_ways(problem, motion, (low, high), traced, way, left())))
    for at in dict.fromkeys((high, low, middle)) if state is not None else ():
        for motion in from_simulation(problem, at, state or REST, subharmonics):
            if not _lies_on_a_branch(branches, motion):
                own = problem.with_subharmonics(motion.subharmonics)
                count = traced * motion.subharmonics
                way = "from a simulated motion"
                branches.append(_with_crossings(_both_ways(own, motion, (low, high), count, way, max(left(), OWN))))
    # Branches that fork off those found, which may fork again; a branch met twice is the same in its middle.
    place, tried = 0, 0
    while place < len(branches):
        origin, unfollowed = branches[place], []
        for fork in origin.forks:
            if fork.periods > subharmonics:
                continue
            if (most := left() - tried) <= 0:
                unfollowed.append(fork)
                continue
            counts = [more * min(fork.periods, 2) * traced for more in (FINER if harmonics == "auto" else (1,))]
            branch = _forked(origin.problem, fork, (low, high), counts, most)
            if branch is None:
                continue
            if _lies_on_a_branch(branches, branch.tracer.motion(branch.points[len(branch.points) // 2])):
                tried += len(branch.points)
            else:
                branches.append(replace(_with_crossings(branch), begins=fork))
        branches[place] = replace(origin, unfollowed=tuple(unfollowed))
        place += 1
    return branches


def _with_crossings(branch: MotionBranch) -> FoundBranch:
    forks = (*doublings(branch), *losses_of_symmetry(branch))
    return FoundBranch(branch, forks, tuple(second_frequencies(branch)))


def _lies_on_a_branch(branches: list[FoundBranch], motion: PeriodicMotion) -> bool:
    """Whether a motion lies on a branch."""
    return any(
        _alike(x, motion.x, NEAR)
        and (other := branch.problem.solve(motion.parameter, x)) is not None
        and _alike(other.x, motion.x, SAME)
        for branch in branches
        if branch.problem.subharmonics == motion.subharmonics
        for x in branch.branch.near(motion.parameter)
    )


def _alike(first: ComplexArray, second: ComplexArray, share: float) -> bool:
    """Whether two motions differ by at most a share, but for a shift by periods of the torques."""
    count = max(len(first), len(second))
    a, b = (np.abs(fitted(motion, count - 1)) for motion in (first, second))
    return bool(np.abs(a - b).max() <= share * b.max())


def _both_ways(
    problem: PeriodicProblem, motion: PeriodicMotion, ends: tuple[float, float], harmonics: int, way: str, most: int
) -> MotionBranch:
    """Branch through a motion, with up to ``most`` points, in both directions to the ends of the range."""
    tracer = Tracer(problem, harmonics)
    parts: list[list[BranchPoint]] = []
    stops: list[tuple[PeriodicMotion, str]] = []
    for direction in (1.0, -1.0):
        first = tracer.first(motion.parameter, motion.x, direction)
        if first is None:
            continue
        parts.append([first, *_inside(tracer.along(first, min(MOST_POINTS, most)), ends, first)])
        most = max(most - len(parts[-1]), 1)
        if tracer.stopped:
            stops.append((tracer.motion(parts[-1][-1]), tracer.stopped))
            tracer.stopped = ""
    if not parts:
        return MotionBranch(tracer, (), way)
    forth, back = parts[0], parts[-1] if len(parts) > 1 else parts[0][:1]
    # Backwards the tangents point the other way.
    turned = [BranchPoint(point.p, point.u, -point.tangent, point.scale) for point in reversed(back[1:])]
    return MotionBranch(tracer, (*turned, *forth), way, tuple(stops))


def _inside(points: Iterator[BranchPoint], ends: tuple[float, float], first: BranchPoint) -> Iterator[BranchPoint]:
    """Yield points until one lies beyond the range, or the branch is back where it began."""
    low, high = ends[0] * (1 - WIDER), ends[1] * (1 + WIDER)
    for number, point in enumerate(points):
        yield point
        if not low <= point.p <= high:
            return
        apart = (np.append(point.u, point.p) - np.append(first.u, first.p)) / first.scale
        if (
            number > 5
            and np.linalg.norm(apart) < 0.5 * np.linalg.norm(first.tangent) * 0.1
            and point.turns * first.turns > 0
        ):
            return


def _other_starts(problem: PeriodicProblem, parameters: tuple[float, ...], harmonics: int) -> Iterator[PeriodicMotion]:
    for at in parameters:
        driven = problem.balance(at, harmonics).driven
        # about the twists under the mean torques: a spring in place of a clearance would stand in the gap
        rest = mean_start(problem, at)
        reached: list[ComplexArray] = []
        for size, phase in STARTS:
            start = size * phase * driven
            start[0] = driven[0] if rest is None else rest[0]
            motion = problem.solve(at, start, harmonics)
            # many starts lead to the same few motions, which cost much with all their harmonics
            if motion is not None and not any(_alike(motion.x, x, SAME) for x in reached):
                reached.append(motion.x)
                full = problem.solve(at, motion.x)
                if full is not None:
                    yield full


def _forked(
    problem: PeriodicProblem, fork: Fork, ends: tuple[float, float], counts: Sequence[int], most: int
) -> MotionBranch | None:
    """Branch from a fork on, with the first of some numbers of harmonics that leads away from it."""
    low, high = ends[0] * (1 - WIDER), ends[1] * (1 + WIDER)
    for harmonics in counts:
        tracer = Tracer(problem.with_subharmonics(fork.periods), harmonics)
        points: list[BranchPoint] = []
        for point in forked_branch(tracer, fork, min(MOST_POINTS, most)):
            points.append(point)
            if not low <= point.p <= high:
                break
        if len(points) >= 2:
            stops = ((tracer.motion(points[-1]), tracer.stopped),) if tracer.stopped else ()
            return MotionBranch(tracer, tuple(points), fork.kind, stops)
    return None
