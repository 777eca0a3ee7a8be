"""Torques of laws of motion over a period of their twists, and how they change with it.

A law answers samples over one period. What it answers with is linear in small changes of the motion: its slope over
time times the change, for friction behind a spring also what the change was when it last stopped slipping.

Laws with steps, at which a row stands still while its torque takes any value between, have no torque over their motion
g, twist or rate. They have one over x = g + T/r, with any r above zero: T(x) is single-valued, with slopes from 0 to r
(the resolvent of a monotone law). Friction behind a spring k is such a law over the twist x = g + T/k of both together.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.model.element_base.laws import MotionLaw, MotionState
from torsionnet.model.motion_laws.describing_functions import (
    Describing,
    describing_function,
    has_steps,
    slider_describing_function,
)
from torsionnet.model.motion_laws.piece_curve import ROUNDING, Hold, PieceCurve, Slope
from torsionnet.model.motion_laws.smooth_curves import CubicCurve

PLACES = 257
"""Places over its range of motion at which a curve without corners is calculated: cubics between miss 1e-10 of it."""


@dataclass(frozen=True, eq=False)
class LawAnswer:
    """Torque (N,) in N m of a law over a period, with its slopes over the motion x and over its rate.

    ``since`` are, of friction behind a spring, the stretches in which it sticks, as shares (N,), each with the sample
    at which it last stopped slipping: the torque changes with x less what x was then.
    """

    torque: FloatArray
    slope: FloatArray
    rate_slope: FloatArray | None = None
    since: tuple[tuple[NDArray[np.bool_] | FloatArray, int], ...] = field(default=())


class Force(Protocol):
    """Protocol of a law that answers samples (N,) of its motion x and, where it asks for it, of the rate of x.

    ``power`` is that of s from the twist to the motion g, ``yielding`` is 1/r in x = g + T/r. ``behind_spring`` says
    that x itself is a motion, that of friction with a spring before it.
    """

    @property
    def power(self) -> int: ...

    @property
    def yielding(self) -> float: ...

    @property
    def needs_rate(self) -> bool: ...

    @property
    def behind_spring(self) -> bool: ...

    def answer_to(self, x: FloatArray, rate: FloatArray | None) -> LawAnswer:
        """Answer to samples over a period."""
        ...

    def describing(self, amplitude: float, mean: float, omega: float) -> Describing | None:
        """Describing function at an amplitude in rad about a mean; None where it has no closed form."""
        ...


@dataclass(frozen=True, eq=False)
class PieceForce:
    """Law of straight pieces without steps: corners (n - 1,), and torques, stiffnesses, dampings and sides (n,)."""

    corners: FloatArray
    torques: FloatArray
    stiffnesses: FloatArray
    dampings: FloatArray
    sides: FloatArray
    over_rate: bool
    law: MotionLaw
    power: int = 0
    yielding: float = 0.0
    behind_spring: bool = False

    def describing(self, amplitude: float, mean: float, omega: float) -> Describing | None:
        if self.sides.any() and self.dampings.any():
            return None
        return describing_function(self.law.curve, amplitude, mean, omega).scaled(float(self.law.scale))

    @property
    def needs_rate(self) -> bool:
        return self.over_rate or bool(self.dampings.any())

    def _share_until_change(self, acting: tuple[int, int], ends: FloatArray, follows: FloatArray) -> float:
        """Part of an interval between two samples that is over where the first of two acting pieces gives way.

        ``ends`` (2, 2) are twist and rate at both samples, ``follows`` (2,) what the corner lies on.
        """
        # The twist passes the corner between the pieces where it does so along a straight line.
        corner = self.corners[min(acting)]
        crosses = (follows[0] < corner) != (follows[1] < corner)
        places = [(corner - follows[0]) / (follows[1] - follows[0])] if crosses else []
        contact = max(acting, key=lambda number: abs(self.sides[number]))
        if self.sides[contact]:
            pushes = self._torque(contact, ends)
            # Contact closes where the last of twist and torque is above zero, and opens with the first below.
            if pushes[0] * pushes[1] < 0:
                places.append(pushes[0] / (pushes[0] - pushes[1]))
            return float(max(places) if acting[1] == contact else min(places)) if places else 0.5
        return float(places[0]) if places else 0.5

    def _torque(self, piece: int, state: FloatArray) -> FloatArray:
        """Torque in N m of a piece at twists and rates (2, ...)."""
        return np.asarray(self.torques[piece] + self.stiffnesses[piece] * state[0] + self.dampings[piece] * state[1])

    def _share_corners(
        self, acting: NDArray[np.intp], x: FloatArray, rate: FloatArray | None,
        answer: tuple[FloatArray, FloatArray, FloatArray | None],
    ) -> None:  # fmt: skip
        """Give the samples beside a corner the share of the interval in which each piece acts.

        So that slopes, and torques that jump, change evenly as the corner moves from sample to sample.
        """
        torque, slope, rate_slope = answer
        following = np.roll(acting, -1)
        for i in np.flatnonzero(np.abs(following - acting) == 1).tolist():
            j, a, b = (i + 1) % len(acting), int(acting[i]), int(following[i])
            ends = np.array([[x[i], x[j]], [0.0, 0.0] if rate is None else [rate[i], rate[j]]])
            theta = self._share_until_change((a, b), ends, ends[int(self.over_rate)])
            there = ends[:, 0] + theta * (ends[:, 1] - ends[:, 0])
            jump = float(self._torque(b, there) - self._torque(a, there))
            # trapezium 1/2, 1/2 against the shares theta, 1 - theta
            apart, pair = (0.5 - theta) / 2, [i, j]
            torque[pair] += apart * jump
            slope[pair] += apart * (self.stiffnesses[b] - self.stiffnesses[a])
            if rate_slope is not None:
                rate_slope[pair] += apart * (self.dampings[b] - self.dampings[a])
            if not self.over_rate and jump:
                # A torque that jumps at a twist jumps earlier, by dx/x', as the twist grows by dx.
                slope[pair] += np.array([1 - theta, theta]) * jump / (x[j] - x[i])

    def answer_to(self, x: FloatArray, rate: FloatArray | None) -> LawAnswer:
        torque, slope, rate_slope, acting = self.acting(x, rate)
        self._share_corners(acting, x, rate, (torque, slope, rate_slope))
        return LawAnswer(torque, slope, rate_slope)

    def acting(
        self, x: FloatArray, rate: FloatArray | None
    ) -> tuple[FloatArray, FloatArray, FloatArray | None, NDArray[np.intp]]:
        """Torques, slopes, slopes over the rate, and numbers of the pieces that act (N,) at single times."""
        followed = rate if self.over_rate and rate is not None else x
        piece = np.searchsorted(self.corners, followed, side="right")
        torque = self.torques[piece] + self.stiffnesses[piece] * x
        slope = self.stiffnesses[piece]
        rate_slope = None
        if rate is not None:
            rate_slope = self.dampings[piece]
            torque = torque + rate_slope * rate
        side = self.sides[piece]
        # Contacts push and never pull: max(0, k d + c d'); where they would pull, the gap beside them acts.
        pulls = side * torque < 0
        if pulls.any():
            torque, slope = np.where(pulls, 0.0, torque), np.where(pulls, 0.0, slope)
            rate_slope = None if rate_slope is None else np.where(pulls, 0.0, rate_slope)
        return torque, slope, rate_slope, np.where(pulls, piece - side.astype(int), piece)


@dataclass(frozen=True, eq=False)
class ResolvedForce:
    """Law with steps over x = g + T/r: corners (n,) of x with their torques (n,), straight between and beyond."""

    corners: FloatArray
    torques: FloatArray
    before: float
    after: float
    power: int
    yielding: float
    needs_rate: bool = False
    behind_spring: bool = False

    def describing(self, amplitude: float, mean: float, omega: float) -> Describing | None:
        del amplitude, mean, omega
        return None

    def answer_to(self, x: FloatArray, rate: FloatArray | None) -> LawAnswer:
        del rate
        places = np.searchsorted(self.corners, x, side="right")
        slopes = np.concatenate([[self.before], np.diff(self.torques) / np.diff(self.corners), [self.after]])
        at = np.clip(places - 1, 0, None)
        slope = slopes[places]
        return LawAnswer(self.torques[at] + slope * (x - self.corners[at]), slope)


@dataclass(frozen=True, eq=False)
class SliderForce:
    """Coulomb friction of a torque behind a spring, over the twist of both together."""

    stiffness: float
    torque: float
    power: int = 0
    needs_rate: bool = False
    behind_spring: bool = True

    @property
    def yielding(self) -> float:
        return 1 / self.stiffness

    def describing(self, amplitude: float, mean: float, omega: float) -> Describing | None:
        del mean, omega
        return Describing(0.0, slider_describing_function(self.stiffness, self.torque, amplitude))

    def answer_to(self, x: FloatArray, rate: FloatArray | None) -> LawAnswer:
        del rate
        n, k, most = len(x), self.stiffness, self.torque
        # Neighbours may be equal, as on both sides of a top: the twist turns where it moves on the other way.
        ahead = np.sign(np.roll(x, -1) - x)
        moving = np.flatnonzero(ahead)
        turns = moving[ahead[moving] != np.roll(ahead[moving], 1)]
        if not len(turns) or k * (x.max() - x.min()) <= 2 * most:  # it sticks for good, from the middle of its swing
            ends = int(x.argmax()), int(x.argmin())
            half = np.full(n, 0.5)
            return LawAnswer(k * (x - x[[*ends]].mean()), np.full(n, k), None, tuple((half, at) for at in ends))
        # From the largest twist on, where it slips, monotone from reversal to reversal.
        order = np.roll(turns, -int(np.argmax(x[turns])))
        torque, stuck = np.zeros(n), np.zeros(n, dtype=bool)
        last, at = most, int(order[0])
        since: list[tuple[NDArray[np.bool_], int]] = []
        mask = np.zeros(n, dtype=bool)
        for start, end in pairwise([*order.tolist(), int(order[0])]):
            own = np.arange(start, end if end > start else end + n) % n
            free = last + k * (x[own] - x[start])
            torque[own] = np.clip(free, -most, most)
            sticks = np.abs(free) < most
            sticks[0] = True
            mask[own[sticks]] = True
            last = float(np.clip(last + k * (x[end % n] - x[start]), -most, most))
            if not sticks.all() or abs(last) >= most:
                since.append((mask, at))
                stuck |= mask
                mask, at = np.zeros(n, dtype=bool), int(end % n)
        return LawAnswer(torque, np.where(stuck, k, 0.0), None, tuple(since))


@dataclass(frozen=True, eq=False)
class CurveForce:
    """Law of a curve without corners."""

    law: MotionLaw
    power: int = 0
    yielding: float = 0.0
    behind_spring: bool = False

    def describing(self, amplitude: float, mean: float, omega: float) -> Describing | None:
        if not isinstance(self.law.curve, CubicCurve):
            return None
        return describing_function(self.law.curve, amplitude, mean, omega).scaled(float(self.law.scale))

    @property
    def needs_rate(self) -> bool:
        return self.law.curve.over == "rate"

    def answer_to(self, x: FloatArray, rate: FloatArray | None) -> LawAnswer:
        curve, scale = self.law.curve, float(self.law.scale)
        if isinstance(curve, CubicCurve):
            k, third = float(curve.stiffness), float(curve.cubic)
            return LawAnswer(scale * (k * x + third * x**3), scale * (k + 3 * third * x**2))
        if rate is not None and self.needs_rate:
            torque, slope = self._interpolated(rate)
            return LawAnswer(scale * torque, np.zeros_like(x), scale * slope)
        torque, slope = self._interpolated(x)
        return LawAnswer(scale * torque, scale * slope)

    def _interpolated(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Torques and slopes (N,) at twists or rates, by cubics through torques and slopes at some of them."""
        curve, low, high = self.law.curve, float(values.min()), float(values.max())
        inside = [float(corner) for corner in curve.corners() if low < float(corner) < high]
        places = np.unique([*np.linspace(low, high, PLACES).tolist(), *inside])
        states = [MotionState(0.0, at) if self.needs_rate else MotionState(at) for at in places.tolist()]
        torques = np.array([float(curve.torque(state.twist, state.rate)) for state in states])
        slopes = np.array([float(curve.slopes(state)[int(self.needs_rate)]) for state in states])
        if len(places) == 1:
            return np.full(len(values), torques[0]), np.full(len(values), slopes[0])
        from scipy.interpolate import CubicHermiteSpline

        course = CubicHermiteSpline(places, torques, slopes)
        return np.asarray(course(values)), np.asarray(course(values, 1))


def force_of(owner: str, law: MotionLaw, spring_before: Callable[[], float], size: float) -> Force:
    """Force of a law; ``spring_before`` gives the stiffness of a spring before friction, 0 where there is none.

    ``size`` is a typical torque over motion, the r of laws with steps.
    """
    curve, scale = law.curve, float(law.scale)
    if not isinstance(curve, PieceCurve):
        return CurveForce(law)
    slopes = [piece for piece in curve.pieces if isinstance(piece, Slope)]
    if not has_steps(curve):
        corners = [float(piece.upper) for piece in slopes[:-1]]
        parts = ([scale * float(getattr(line, name)) for line in slopes] for name in ("torque", "stiffness", "damping"))
        torques, stiffnesses, dampings = map(np.array, parts)
        sides = np.array([float(piece.side) for piece in slopes])
        return PieceForce(np.array(corners), torques, stiffnesses, dampings, sides, curve.over == "rate", law)
    if curve.over == "twist":
        return _resolved(owner, curve, scale, size, 0)
    spring = spring_before()
    if not spring:
        return _resolved(owner, curve, scale, size, 1)
    most = slopes[-1]
    # Jenkins element: a spring behind friction that sticks with the torque with which it slips.
    held = max(float(piece.high) for piece in curve.pieces if isinstance(piece, Hold))
    if len(curve.pieces) != 3 or most.damping or held != float(most.torque):
        text = "friction behind a spring that changes with the slip or sticks with more than it slips"
        raise UsageError(f"{owner}: periodic motion does not work out {text}; use simulate", kind="unsupported-law")
    return SliderForce(spring, scale * float(most.torque))


def _resolved(owner: str, curve: PieceCurve, scale: float, r: float, power: int) -> ResolvedForce:
    """Law with steps over x = g + T/r, by its corners (g, T) turned to (g + T/r, T)."""
    rate = curve.over == "rate"
    points: list[tuple[float, float]] = []
    ends: list[float] = []
    sticks_more = False
    for number, piece in enumerate(curve.pieces):
        if isinstance(piece, Hold):
            points += [(float(piece.at), scale * float(piece.low)), (float(piece.at), scale * float(piece.high))]
            following = curve.pieces[number + 1]
            assert isinstance(following, Slope)
            sticks_more |= bool(piece.high > (1 + ROUNDING) * following.at(piece.at, piece.at))
            continue
        slope = scale * float(piece.damping if rate else piece.stiffness)
        if number == 0 or number == len(curve.pieces) - 1:
            ends.append(slope)
        if number + 1 < len(curve.pieces) and isinstance(curve.pieces[number + 1], Slope):
            corner = float(piece.upper)
            points.append((corner, scale * float(piece.torque) + slope * corner))
    g, torque = np.array(points).T
    x = g + torque / r
    if sticks_more or (np.diff(x) <= 0).any() or (np.diff(torque) < 0).any():
        text = "its torque falls with the motion, or as it lets go; periodic motion does not work that out"
        raise UsageError(f"{owner}: {text}; use simulate", kind="unsupported-law")
    # dT/dx of a slope k behind r in series, k r / (k + r).
    before, after = (slope * r / (slope + r) for slope in (ends[0], ends[-1]))
    return ResolvedForce(x, torque, before, after, power, 1 / r)


def slope_matrix(coefficients: ComplexArray, harmonics: int) -> ComplexArray:
    """Harmonics (H + 1, 2 H + 1) of s(t) x(t) over the real and imaginary parts of those of x, of which 0 is real.

    ``coefficients`` are S_0 .. S_2H of s(t) = sum S_n e^(jnwt). With x_m one-sided, (s x)_k is the sum over m > 0 of
    S_(k-m) x_m + S_(k+m) conj(x_m), and 2 S_k x_0 (half of it all for k = 0): Toeplitz and Hankel.
    """
    H = harmonics
    k, m = np.arange(H + 1)[:, None], np.arange(1, H + 1)
    apart = k - m
    toeplitz = np.where(apart >= 0, coefficients[np.abs(apart)], coefficients[np.abs(apart)].conj())
    hankel = coefficients[k + m]
    over_x = np.empty((H + 1, 2 * H + 1), dtype=complex)
    over_x[:, 0] = 2 * coefficients[: H + 1]
    over_x[:, 1 : H + 1], over_x[:, H + 1 :] = toeplitz + hankel, 1j * (toeplitz - hankel)
    over_x[0] *= 0.5
    return over_x
