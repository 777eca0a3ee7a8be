"""Branches of periodic motions over a parameter, followed by their arc length through folds.

A point is (x, p), harmonics of the laws and the parameter. From one point the branch goes on along its tangent (v, q),
J v + R_p q = 0, by the length ds; Newton's method brings the prediction back onto R(x, p) = 0 on the plane across the
tangent (H. B. Keller; R. Seydel, Practical Bifurcation and Stability Analysis, chapter 4). Where q changes its sign the
branch folds back.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.motion.periodic.periodic_problem import (
    LEFT_OUT,
    MORE,
    PeriodicMotion,
    PeriodicProblem,
    fitted,
    packed,
    unpacked,
)

FIRST_STEP, LONGEST_STEP, SHORTEST_STEP = 0.02, 0.08, 1e-7
"""Lengths of steps along a branch, over the parameter and the size of the motion."""
BEND = 0.9
"""Least cosine between the directions of two steps: more bend asks for shorter ones."""
MOST_ITERATIONS, FEW = 10, 3
"""Newton steps from which a step along the branch is taken back, and up to which the next one is longer."""
CORNER, PAST = 1e-4, 1e-3
"""Length of steps below which a corner of the branch is supposed, and share of the parameter by which it is passed."""
CLOSE = 1e-8
"""Last Newton step of a point along the branch."""
DIFFERENCE = 1e-7
"""Share of the parameter over which its slope is taken as a difference."""
LOCATED = 1e-6
"""Length along the branch, a share of the motion, to which a fold is located: its parameter is known far better."""


@dataclass(frozen=True, eq=False)
class BranchPoint:
    """Point of a branch: parameter p, packed motion u, and its tangent, that of the parameter last.

    Lengths count over ``scale``, sizes of the motion and of the parameter.
    """

    p: float
    u: FloatArray
    tangent: FloatArray
    scale: FloatArray

    @property
    def turns(self) -> float:
        """Component of the parameter in the direction of the branch, which passes zero at a fold."""
        return float(self.tangent[-1])


@dataclass(frozen=True, eq=False)
class Fold:
    """Motion at which a branch folds back: ``kind`` "maximum" or "minimum" of the parameter."""

    motion: PeriodicMotion
    kind: Literal["maximum", "minimum"]


class Tracer:
    """Steps along branches of a problem with a fixed number of harmonics.

    ``stopped`` says why the last way along a branch went no further, empty where nothing stopped it.
    """

    stopped = ""

    def __init__(self, problem: PeriodicProblem, harmonics: int) -> None:
        self.problem, self.harmonics = problem, harmonics
        self.n_laws = len(problem.forces)
        self.least = problem.least_size

    def first(self, parameter: float, x: ComplexArray, direction: float) -> BranchPoint | None:
        """Point at a parameter from a motion near it; the branch goes on with the parameter in ``direction``."""
        motion = self.problem.solve(parameter, fitted(x, self.harmonics), self.harmonics)
        if motion is None:
            return None
        u = packed(motion.x)
        scale = self.scale(u, parameter)
        across = np.zeros(len(u) + 1)
        across[-1] = direction
        _, J, slope = self._equations(u, parameter)
        return BranchPoint(parameter, u, self._tangent(J, slope, across, scale), scale)

    def scale(self, u: FloatArray, parameter: float) -> FloatArray:
        """Sizes of the packed motion and of the parameter over which lengths count."""
        sizes = np.maximum(np.linalg.norm(unpacked(u, self.n_laws)[1:], axis=0), self.least)
        return np.append(np.repeat(sizes, 2 * self.harmonics + 1), self.problem.parameter_scale or abs(parameter))

    def _equations(self, u: FloatArray, parameter: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Packed residual, its Jacobian over the motion, and its slope over the parameter."""
        x = unpacked(u, self.n_laws)
        balance = self.problem.balance(parameter, self.harmonics)
        left, answers, torques = balance.residual(x)
        step = DIFFERENCE * (self.problem.parameter_scale or abs(parameter))
        moved = self.problem.balance(parameter + step, self.harmonics)
        known = None if any(force.needs_rate for force in self.problem.forces) else torques
        further = moved.residual(x)[0] if known is None else moved.left(x, known)
        return packed(left), balance.slopes(answers), packed(further - left) / step

    @staticmethod
    def _tangent(J: FloatArray, slope: FloatArray, along: FloatArray, scale: FloatArray) -> FloatArray:
        # [J R_p; along] t = (0, 1), in scaled lengths
        whole = np.vstack([np.hstack([J, slope[:, None]]) * scale, along])
        right = np.zeros(len(along))
        right[-1] = 1.0
        tangent = np.linalg.solve(whole, right)
        return np.asarray(tangent / np.linalg.norm(tangent))

    def step(self, point: BranchPoint, ds: float) -> tuple[BranchPoint, int] | None:
        """Point a length ds further, with the Newton steps that it took; None where these do not get there."""
        scale, along = point.scale, point.tangent
        start = np.append(point.u, point.p)
        at = start + ds * along * scale
        for number in range(MOST_ITERATIONS):
            left, J, slope = self._equations(at[:-1], float(at[-1]))
            if not np.isfinite(left).all():
                return None
            # Pseudo-arclength: R(x, p) = 0 and t.step = ds in scaled lengths, which passes folds like other points.
            whole = np.vstack([np.hstack([J, slope[:, None]]) * scale, along])
            over = float(along @ ((at - start) / scale)) - ds
            try:
                change = np.linalg.solve(whole, np.append(left, over))
            except np.linalg.LinAlgError:
                return None
            at = at - change * scale
            # A change as large as the scale leads to another branch, if anywhere.
            if np.abs(change).max() > 1:
                return None
            if np.abs(change).max() <= CLOSE:
                tangent = self._tangent(J, slope, along, scale)
                u, p = at[:-1], float(at[-1])
                following = self.scale(u, p)
                tangent = tangent * scale / following
                return BranchPoint(p, u, tangent / np.linalg.norm(tangent), following), number + 1
        return None

    def along(self, point: BranchPoint, most: int) -> Iterator[BranchPoint]:
        """Yield points along the branch, each some length further, until it gets lost or ``most`` are found."""
        ds, self.stopped = FIRST_STEP, ""
        for _ in range(most):
            while True:
                stepped = self.step(point, ds)
                if stepped is not None:
                    moved = stepped[0].tangent * stepped[0].scale / point.scale
                    if moved @ point.tangent >= BEND * np.linalg.norm(moved) or ds <= 100 * SHORTEST_STEP:
                        break
                ds /= 2
                if CORNER / 2 <= ds < CORNER and (beyond := self._past_corner(point)) is not None:
                    stepped, ds = (beyond, MOST_ITERATIONS), FIRST_STEP
                    break
                if ds < SHORTEST_STEP:
                    self.stopped = "Newton's method finds no motion further on, however short the step"
                    return
            point, count = stepped
            yield point
            if count <= FEW:
                ds = min(1.5 * ds, LONGEST_STEP)
        self.stopped = f"it goes on, but only {most} points of it are followed, not to its end"

    def _past_corner(self, point: BranchPoint) -> BranchPoint | None:
        """Point a little further in the parameter, where a branch bends at once by more than a right angle.

        So it may where friction behind a spring begins to slip: no plane across the tangent meets it there.
        """
        way = float(np.sign(point.turns))
        if not way:  # a fork, where the parameter stands: neither side of it is past a corner
            return None
        moved = self.problem.solve(
            point.p + PAST * way * point.scale[-1],
            unpacked(point.u, self.n_laws),
            self.harmonics,
        )
        if moved is None or np.linalg.norm((packed(moved.x) - point.u) / point.scale[:-1]) > LONGEST_STEP:
            return None
        return self.first(moved.parameter, moved.x, way)

    def motion(self, point: BranchPoint) -> PeriodicMotion:
        """Motion of a point."""
        x = unpacked(point.u, self.n_laws)
        return self.problem.motion(point.p, x, self.problem.balance(point.p, self.harmonics))


@dataclass(frozen=True, eq=False)
class MotionBranch:
    """Points along a branch in their order, and how it was found in words.

    ``stops`` are the motions at which it could not be followed further inside the range, each with the reason.
    """

    tracer: Tracer
    points: tuple[BranchPoint, ...]
    way: str
    stops: tuple[tuple[PeriodicMotion, str], ...] = ()

    def at(self, parameter: float) -> list[PeriodicMotion]:
        """Motions of the branch at a parameter, with as many harmonics as they need, in the order of the branch."""
        solved = (self.tracer.problem.solve(parameter, x) for x in self.near(parameter))
        return [motion for motion in solved if motion is not None]

    def near(self, parameter: float) -> Iterator[ComplexArray]:
        """Yield the harmonics at a parameter, straight between points of the branch, in its order."""
        for before, after in pairwise(self.points):
            if (before.p - parameter) * (after.p - parameter) < 0 or before.p == parameter:
                share = (parameter - before.p) / (after.p - before.p) if after.p != before.p else 0.0
                yield unpacked(before.u + share * (after.u - before.u), self.tracer.n_laws)
        if self.points and self.points[-1].p == parameter:
            yield unpacked(self.points[-1].u, self.tracer.n_laws)

    def folds(self) -> list[Fold]:
        """Motions at which the branch folds back, located with as many harmonics as they need."""
        folds = []
        for before, after in pairwise(self.points):
            if before.turns * after.turns < 0:
                fold = located_fold(self.tracer.problem, before, after, self.tracer.n_laws)
                if fold is not None:
                    folds.append(fold)
        return folds


def located_fold(problem: PeriodicProblem, before: BranchPoint, after: BranchPoint, n_laws: int) -> Fold | None:
    """Fold between two points of a branch, by secants over the length from the first."""
    kind: Literal["maximum", "minimum"] = "maximum" if before.turns > 0 else "minimum"
    beside = problem.solve(before.p, unpacked(before.u, n_laws))
    if beside is None:
        return None
    harmonics = beside.harmonics
    while True:
        tracer = Tracer(problem, harmonics)
        start = tracer.first(before.p, beside.x, float(np.sign(before.turns)))
        point = None if start is None else _turning_point(tracer, start, after)
        if point is None:
            return None
        motion = tracer.motion(point)
        if motion.left_out < LEFT_OUT or harmonics >= problem.most_harmonics:
            return Fold(motion, kind)
        harmonics = int(MORE * harmonics)


def _turning_point(tracer: Tracer, start: BranchPoint, after: BranchPoint) -> BranchPoint | None:
    """Point at which the parameter stands, by the rule of false positions (Illinois) between two sides of the fold."""
    # the chord to the point beyond, and on until the parameter has turned
    other = fitted(unpacked(after.u, tracer.n_laws), tracer.harmonics)
    chord = (np.append(packed(other), after.p) - np.append(start.u, start.p)) / start.scale
    length = float(chord @ start.tangent)
    for _ in range(20):
        stepped_on = tracer.step(start, length)
        if stepped_on is None:
            length /= 2
            continue
        if stepped_on[0].turns * start.turns < 0:
            break
        start, length = stepped_on[0], max(length, FIRST_STEP / 10)
    else:
        return None
    a, b = 0.0, length
    fa, fb = start.turns, stepped_on[0].turns
    point = stepped_on[0]
    for _ in range(40):
        c = (a * fb - b * fa) / (fb - fa)
        stepped = tracer.step(start, c)
        if stepped is None:
            return None
        point = stepped[0]
        fc = point.turns
        if fc * fb < 0:
            a, fa = b, fb
        else:
            fa /= 2
        moved, b, fb = abs(c - b), c, fc
        if moved <= LOCATED or fc == 0:
            break
    return point
