"""Search for all branches of periodic motions from starts at rest and over time, and for the peaks along them.

From rest at both ends and in the middle of the range; from starts of other sizes and phases, for branches that nothing
joins to these; from motions simulated from a given state; from forks. There may be more: nothing short of a search
of all starts would rule that out.

Starts of branches: from rest, with torques that grow from nothing, and from motions given or stepped over time.

From rest: first the springs k_0 beside the laws give way to the laws themselves under the mean torques alone, then the
torques that vibrate grow from zero. Both ways are followed by arc length, so that neither folds nor gaps stop them;
where the second way passes the full torques several times, each is a motion of its own.

Peaks of outputs along a branch between the motions that are listed, so that none hides between places asked for.

The points of the branch between two listed motions are looked at; where an output swings further at one of them than
at both, its largest swing is located over the arc length.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from copy import copy
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import scipy

from torsionnet.linear.assembly.law_stiffness import Functional
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.motion.contact_states import MotionStart
from torsionnet.motion.periodic.branch import BranchPoint, MotionBranch, Tracer
from torsionnet.motion.periodic.forks import Fork, doublings, forked_branch, losses_of_symmetry, second_frequencies
from torsionnet.motion.periodic.periodic_problem import (
    Harmonics,
    PeriodicDrive,
    PeriodicMotion,
    PeriodicProblem,
    fitted,
    harmonics_of,
    over_time,
    packed,
    peak_to_peak,
    unpacked,
)
from torsionnet.motion.scenarios.scenario import REST
from torsionnet.motion.simulation import simulate_torques

# Starts of branches: from rest, with torques that grow from nothing, and from motions given or stepped over time.

TRACED_HARMONICS = 16
"""Harmonics with which a way to a start is followed; the start itself has as many as it needs."""
MOST_START_POINTS = 400
"""Most points on a way from rest."""
FURTHEST = 2.5
"""Share of the full torques at which a way from rest ends: beyond it few come back."""


def _scaled_loads(problem: PeriodicProblem, parameter: float, *, vibrates: bool) -> PeriodicDrive:
    loads, omega = problem.drive.loads(parameter), problem.drive.omega(parameter)
    means = np.zeros_like(loads)
    means[0] = loads[0]
    speed = problem.drive.speed(parameter)
    return PeriodicDrive(lambda _: omega, lambda p: means + p * (loads - means) if vibrates else means, lambda _: speed)


def mean_start(problem: PeriodicProblem, parameter: float) -> ComplexArray | None:
    """Motion x (2, n_laws) at rest under the mean torques at a parameter; None where the way to it gets lost."""
    way = copy(problem)
    laws_over_twist = np.array([bool(law.reference) for law in problem.plant.laws])
    way.shares = lambda parameter: np.where(laws_over_twist, parameter, 1.0)
    # Continuation of loads and laws over the twist from nothing (p = 0) to the whole (p = 1).
    way.drive, way.parameter_scale = _scaled_loads(problem, parameter, vibrates=False), 1.0
    start = way.balance(0.0, 1).driven
    way.least_size = np.maximum(np.abs(start[0]), way.least_size)
    tracer = Tracer(way, 1)
    point = tracer.first(0.0, start, 1.0)
    if point is None:
        return None
    for following in tracer.along(point, MOST_START_POINTS):
        if following.p >= 1:
            share = (1 - point.p) / (following.p - point.p)
            between = point.u + share * (following.u - point.u)
            motion = way.solve(1.0, unpacked(between, len(problem.forces)), 1)
            return None if motion is None else motion.x
        point = following
    return None


def from_rest(problem: PeriodicProblem, parameter: float) -> Iterator[PeriodicMotion]:
    """Yield motions at a parameter to which torques that grow from nothing lead."""
    for before, after in pairwise(_way(problem, parameter)[1]):
        if (before.p - 1) * (after.p - 1) <= 0 and before.p != after.p:
            share = (1 - before.p) / (after.p - before.p)
            between = before.u + share * (after.u - before.u)
            motion = problem.solve(parameter, unpacked(between, len(problem.forces)))
            if motion is not None:
                yield motion


def _way(problem: PeriodicProblem, parameter: float) -> tuple[Tracer | None, list[BranchPoint]]:
    """Points on the way on which torques that vibrate grow from nothing, none without a start at rest."""
    rest = mean_start(problem, parameter)
    if rest is None:
        return None, []
    way = problem.with_drive(_scaled_loads(problem, parameter, vibrates=True), parameter_scale=1.0)
    harmonics = max(TRACED_HARMONICS, problem.driven_to) * problem.subharmonics
    tracer = Tracer(way, harmonics)
    point = tracer.first(0.0, fitted(rest, harmonics), 1.0)
    if point is None:
        return tracer, []
    points = [point]
    for following in tracer.along(point, MOST_START_POINTS):
        points.append(following)
        if not 0 <= following.p <= FURTHEST:
            break
    return tracer, points


def without_start(problem: PeriodicProblem, parameter: float, unit: str) -> str:
    """Message that no periodic motion was reached at a parameter, with how far the way from rest went, and why."""
    tracer, points = _way(problem, parameter)
    text = f"from rest no periodic motion was reached at {parameter:.6g} {unit}"
    if tracer is None or not points:
        reached = "under the mean torques alone nothing stays at rest"
    else:
        furthest = max(points, key=lambda point: point.p)
        owner, swing = tracer.problem.largest_twist(tracer.motion(furthest))
        reached = f"torques that grow reach {100 * furthest.p:.3g} % of theirs, where {owner} swings by {swing:.4g} rad"
        reached += f", and there {tracer.stopped}" if tracer.stopped else ""
    return f"{text}: {reached}; a time simulation shows what the drivetrain does"


# Starts of branches from motions simulated over time: the last period of a simulation, then harmonic balance.

PERIODS = 50
"""Periods of the torques that are simulated."""
SAMPLES = 64
"""Samples in a period."""
REPEATS = 0.05
"""Share of a swing by which a motion may change within a period that counts as its own."""
TAKEN = 16
"""Harmonics of a period of the torques that are taken from a simulation."""


def from_simulation(
    problem: PeriodicProblem, parameter: float, state: str | MotionStart, most: int
) -> Iterator[PeriodicMotion]:
    """Yield the motion to which a simulation from a state comes at a parameter, of up to ``most`` periods of torques.

    None where it does not repeat after all periods.
    """
    angles = _simulated(problem, parameter, state)
    assembly = problem.plant.assembly
    q = np.linalg.lstsq(assembly.T, angles, rcond=None)[0]
    twists = problem.plant.rows @ q
    count = problem.subharmonics
    while count <= most:
        last, before = twists[:, -count * SAMPLES :], twists[:, -2 * count * SAMPLES : -count * SAMPLES]
        swing = np.ptp(last, axis=1)
        if (np.abs(last - before).max(axis=1) <= REPEATS * np.maximum(swing, REPEATS * swing.max())).all():
            own = problem.with_subharmonics(count)
            motion = own.solve(parameter, _motions(own, parameter, last))
            if motion is not None:
                yield motion
            return
        count *= 2


def _simulated(problem: PeriodicProblem, parameter: float, state: str | MotionStart) -> FloatArray:
    """Angles (n_nodes, n) in rad over the time simulated."""
    plant = problem.plant
    omega, loads = problem.drive.omega(parameter), problem.drive.loads(parameter)
    period = max(SAMPLES, 2 ** math.ceil(math.log2(8 * len(loads))))
    n = SAMPLES * (period // SAMPLES)
    torques = {
        channel.of if channel.against is None else f"{channel.of}-{channel.against}": np.append(
            np.tile(over_time(loads[:, place], n), PERIODS), over_time(loads[:, place], n)[:1]
        )
        for place, channel in enumerate(plant.inputs)
    }
    nodes = list(plant.assembly.nodes)
    rate = n * omega / (2 * math.pi)
    record = simulate_torques(plant.drivetrain, nodes, torques, rate, state)
    return np.array([record[node].values[: -1 : n // SAMPLES] for node in nodes])


def _motions(problem: PeriodicProblem, parameter: float, twists: FloatArray) -> ComplexArray:
    """Harmonics (n, n_laws) of x = g + T/r of twists (n_laws, n) over one period of the motion."""
    harmonics = TAKEN * problem.subharmonics
    g = np.stack([harmonics_of(samples_of, harmonics) for samples_of in twists], axis=1)
    balance = problem.balance(parameter, harmonics)
    s = 1j * balance.omega * np.arange(harmonics + 1)[:, None]
    g = g * s ** np.array([force.power for force in problem.forces])
    yielding = np.array([force.yielding for force in problem.forces])
    if not yielding.any():
        return np.asarray(g)
    # G tau = driven - g and tau = T (1 + k_0/r) - k_0 x = T - k_0 g
    tau = np.stack(
        [np.linalg.lstsq(G, left, rcond=1e-9)[0] for G, left in zip(balance.G, balance.driven - g, strict=True)]
    )
    return np.asarray(g + (tau + problem.plant.references * g) * yielding)


# Search for all branches of periodic motions over a range of a parameter, each with the way by which it was found.

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


# Peaks of outputs along a branch between the motions that are listed, so that none hides between places asked for.

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
