"""Starts of branches: from rest, with torques that grow from nothing, and from motions given or stepped over time.

From rest: first the springs k_0 beside the laws give way to the laws themselves under the mean torques alone, then the
torques that vibrate grow from zero. Both ways are followed by arc length, so that neither folds nor gaps stop them;
where the second way passes the full torques several times, each is a motion of its own.
"""

from __future__ import annotations

from collections.abc import Iterator
from copy import copy
from itertools import pairwise

import numpy as np

from torsionnet.linear.assembly.rows import ComplexArray
from torsionnet.motion.periodic.branch import BranchPoint, Tracer
from torsionnet.motion.periodic.harmonic_balance import fitted, unpacked
from torsionnet.motion.periodic.periodic_problem import PeriodicDrive, PeriodicMotion, PeriodicProblem

TRACED_HARMONICS = 16
"""Harmonics with which a way to a start is followed; the start itself has as many as it needs."""
MOST_POINTS = 400
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
    for following in tracer.along(point, MOST_POINTS):
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
    for following in tracer.along(point, MOST_POINTS):
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
