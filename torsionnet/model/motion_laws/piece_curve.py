"""Torque curve of straight pieces over twist or over rate, with steps at which the row stands still."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any, Literal

from torsionnet.model.element_base.laws import MotionState, TorqueCurve, Values
from torsionnet.model.element_base.spring_stage import SpringStage, stage_spans
from torsionnet.model.element_base.spring_stages import NumberRows

ROUNDING = 1e-14
"""Share of a twist or rate by which rounding may carry it over the corner that it lies on."""


@dataclass(frozen=True)
class Slope:
    """Straight piece T = torque + stiffness gamma + damping gamma' of a curve, from ``lower`` to ``upper``.

    Bounds are twists in rad or rates in rad/s as the curve says, None where the piece has no end. With ``side`` 1 the
    torque is never below zero, with -1 never above: two bodies that touch push, but do not pull.
    """

    torque: Any = 0
    stiffness: Any = 0
    damping: Any = 0
    lower: Any = None
    upper: Any = None
    side: Literal[-1, 0, 1] = 0

    def at(self, twist: Any, rate: Any) -> Any:
        """Torque in N m at a twist in rad and a rate in rad/s."""
        torque = self.torque + self.stiffness * twist + self.damping * rate
        return torque - torque if self.side and self.side * torque < 0 else torque

    def mirrored(self) -> Slope:
        """Piece -T(-gamma, -gamma') on the other side of zero."""
        lower, upper = (None if end is None else -end for end in (self.upper, self.lower))
        side: Literal[-1, 0, 1] = 0 if not self.side else -1 if self.side > 0 else 1
        return replace(self, torque=-self.torque, lower=lower, upper=upper, side=side)

    def scaled(self, ratio: Any) -> Slope:
        """Piece r T(r gamma, r gamma') for a ratio r above zero."""
        lower, upper = (None if end is None else end / ratio for end in (self.lower, self.upper))
        stiffness, damping = self.stiffness * ratio**2, self.damping * ratio**2
        return Slope(self.torque * ratio, stiffness, damping, lower, upper, self.side)


@dataclass(frozen=True)
class Hold:
    """Step of a curve at which the row stands still while its torque lies between ``low`` and ``high`` in N m.

    ``at`` is the twist in rad, or over the rate the rate in rad/s, at which it stands. The range may be wider than the
    torques of the pieces beside it: friction at rest may hold more than sliding friction.
    """

    at: Any
    low: Any
    high: Any

    def mirrored(self) -> Hold:
        """Step on the other side of zero."""
        return Hold(-self.at, -self.high, -self.low)

    def scaled(self, ratio: Any) -> Hold:
        """Step of the curve r T(r gamma, r gamma') for a ratio r above zero."""
        return Hold(self.at / ratio, self.low * ratio, self.high * ratio)


@dataclass(frozen=True)
class PieceCurve(TorqueCurve):
    """Torque of straight pieces in rising order over the twist or over the rate, with steps between them.

    ``rest`` is the number of the piece in force at twist and rate zero where bounds may be symbols; None lets the curve
    compare numbers.

    Examples
    --------
    A clearance of 0.2 rad with a stiffness of 100 N m/rad on either side:

    >>> gap = PieceCurve("twist", (Slope(10, 100, 0, None, -0.1, -1), Slope(lower=-0.1, upper=0.1),
    ...     Slope(-10, 100, 0, 0.1, None, 1)))
    >>> [round(gap.torque(twist, 0), 9) for twist in (-0.2, 0, 0.1, 0.3)], round(gap.energy(0.3), 9)
    ([-10.0, 0, 0.0, 20.0], 2.0)
    >>> gap.slopes(MotionState(twist=0.1))
    (100, 0)
    >>> [state.twist for state in gap.states_at(20)]
    [0.3]
    """

    over: Literal["twist", "rate"]
    pieces: tuple[Slope | Hold, ...]
    rest: int | None = None

    def number_at(self, twist: Any, rate: Any) -> int:
        """Number of the piece in force at a twist in rad and a rate in rad/s; at a corner that of the piece above.

        At a step it is the number of the step.
        """
        at = twist if self.over == "twist" else rate
        if self.rest is not None and at == 0:
            return self.rest
        in_force = 0
        for number, piece in enumerate(self.pieces):
            if isinstance(piece, Hold):
                if at == piece.at:
                    return number
            elif piece.lower is None or not at < piece.lower:
                in_force = number
        return in_force

    def slope_at(self, state: MotionState) -> Slope:
        """Straight piece in force at a state, at a step that above it."""
        number = self.number_at(state.twist, state.rate) if state.piece is None else state.piece
        piece = self.pieces[number]
        if isinstance(piece, Hold):
            piece = self.pieces[number + 1] if number + 1 < len(self.pieces) else self.pieces[number - 1]
        if isinstance(piece, Hold):
            raise TypeError("two steps of a curve follow each other")
        return piece

    def torque(self, twist: Any, rate: Any, *sensed: Any) -> Any:
        del sensed
        return self.slope_at(MotionState(twist, rate)).at(twist, rate)

    def energy(self, twist: Any) -> Any:
        if self.over == "rate":
            return 0 * twist
        # Integral of T over the twist from 0: pieces between, and the outer ones beyond their ends.
        low, high = (twist, 0) if twist < 0 else (0, twist)
        total = 0 * twist
        for place, piece in enumerate(self.pieces):
            if isinstance(piece, Slope):
                first, last = (outer in (place, None) for outer in self._outer_slopes())
                start = low if first or piece.lower is None or piece.lower < low else piece.lower
                end = high if last or piece.upper is None or piece.upper > high else piece.upper
                if start < end:
                    total += piece.torque * (end - start) + piece.stiffness * (end**2 - start**2) / 2
        # Below 0 the integral runs backwards.
        return -total if twist < 0 else total

    def _outer_slopes(self) -> tuple[int, int]:
        """Numbers of the first and the last straight piece, which go on beyond their ends."""
        slopes = [number for number, piece in enumerate(self.pieces) if isinstance(piece, Slope)]
        return slopes[0], slopes[-1]

    def slopes(self, state: MotionState) -> tuple[Any, ...]:
        piece = self.slope_at(state)
        return piece.stiffness, piece.damping

    def holds(self, state: MotionState) -> bool:
        number = self.number_at(state.twist, state.rate) if state.piece is None else state.piece
        return isinstance(self.pieces[number], Hold)

    def range(self) -> tuple[Any, Any]:
        first, last = self.pieces[0], self.pieces[-1]
        lower = first.lower if isinstance(first, Slope) else first.at
        upper = last.upper if isinstance(last, Slope) else last.at
        return lower, upper

    def corners(self) -> tuple[Any, ...]:
        ends = (piece.at if isinstance(piece, Hold) else piece.upper for piece in self.pieces)
        return tuple(dict.fromkeys(end for end in ends if end is not None))

    def states_at(self, torque: Any) -> tuple[MotionState, ...]:
        """States in which the curve gives a torque in N m, by rising twist or rate, each with its piece.

        Of a level piece it is the point next to zero, at a corner that of the piece above, at the end of a step the
        step, which a torque has to exceed. No state lies beyond an end of the curve.
        """
        states: list[MotionState] = []
        reach, level_before = None, False
        for number, piece in enumerate(self.pieces):
            ends = self._places_on(piece, torque)
            if ends is None:
                continue
            lower, upper = ends
            level = lower is None or upper is None or lower < upper
            # Neighbours meet at a corner and give the torque both: it is one state.
            if reach is not None and lower is not None and not reach < lower:
                before = self.pieces[states[-1].piece or 0]
                if isinstance(before, Hold) or (level_before and not level and not isinstance(piece, Hold)):
                    continue
                states.pop()
            at = float(lower if lower is not None and lower > 0 else upper if upper is not None and upper < 0 else 0)
            states.append(
                MotionState(at, 0.0, (), number) if self.over == "twist" else MotionState(0.0, at, (), number)
            )
            reach, level_before = upper, level
        return tuple(states)

    def _places_on(self, piece: Slope | Hold, torque: Any) -> tuple[Any, Any] | None:
        """Twists or rates from and to which a piece gives a torque, None where it does not."""
        if isinstance(piece, Hold):
            return None if torque < piece.low or torque > piece.high else (piece.at, piece.at)
        slope = piece.stiffness if self.over == "twist" else piece.damping
        # A level piece gives its torque anywhere.
        if slope == 0:
            return (piece.lower, piece.upper) if torque == piece.torque else None
        at = (torque - piece.torque) / slope
        slack = ROUNDING * abs(float(at))
        if piece.lower is not None and at < piece.lower:
            return None if at < piece.lower - slack else (piece.lower, piece.lower)
        if piece.upper is not None and at > piece.upper:
            return None if at > piece.upper + slack else (piece.upper, piece.upper)
        return at, at

    def entered(self, number: Callable[[Fraction], Any]) -> PieceCurve:
        """Curve with its exact fractions brought into an algebra; what is of that algebra stays.

        Slopes and corners of plain numbers so have the rounding error of one conversion.
        """

        def moved(piece: Slope | Hold) -> Slope | Hold:
            exact = {key: number(fraction) for key, fraction in vars(piece).items() if isinstance(fraction, Fraction)}
            return replace(piece, **exact)

        return replace(self, pieces=tuple(moved(piece) for piece in self.pieces))

    def scaled(self, ratio: Any) -> PieceCurve:
        if not ratio < 0:
            return replace(self, pieces=tuple(piece.scaled(ratio) for piece in self.pieces))
        # A negative ratio turns both axes: pieces are mirrored, and come in reverse order.
        pieces = tuple(piece.scaled(-ratio).mirrored() for piece in reversed(self.pieces))
        rest = None if self.rest is None else len(pieces) - 1 - self.rest
        return PieceCurve(self.over, pieces, rest)


def symmetric_curve(over: Literal["twist", "rate"], above: tuple[Slope | Hold, ...]) -> PieceCurve:
    """Curve with T(-gamma, -gamma') = -T(gamma, gamma'), made from its pieces from zero on.

    Where these begin with a torque other than zero, a step at zero joins them to their mirrored ones.

    >>> symmetric_curve("rate", (Slope(5, lower=0),)).pieces[1]
    Hold(at=0, low=-5, high=5)
    """
    first, *others = above
    below = tuple(piece.mirrored() for piece in reversed(above))
    # Without a torque at zero the first piece goes on into its mirror image.
    if isinstance(first, Slope) and not first.torque > 0:
        middle = (replace(first, lower=None if first.upper is None else -first.upper),)
        return PieceCurve(over, (*below[:-1], *middle, *others), len(others))
    if isinstance(first, Hold):
        return PieceCurve(over, (*below[:-1], *above), len(others))
    # A torque at zero, as of dry friction, jumps there from -T to T.
    return PieceCurve(over, (*below, Hold(0, -first.torque, first.torque), *above), len(above))


# Torque curves of dry friction over the slip speed, constant or by rows, with the torque that sticks.


def friction_curve(torque: Any, stick: Any) -> PieceCurve:
    """Curve of Coulomb friction: T sgn(gamma') against the slip, and anything from -T_s to T_s while it sticks.

    >>> friction_curve(20, 30).torque(0, -1), friction_curve(20, 30).pieces[1]
    (-20, Hold(at=0, low=-30, high=30))
    """
    return symmetric_curve("rate", (Hold(0, -stick, stick), Slope(torque, lower=0)))


def slip_curve(rows: NumberRows, stick: Any = None) -> PieceCurve:
    """Curve of friction by rows [slip speed, torque] from slip zero on, the same both ways, up to the last row.

    It sticks up to ``stick``, by default the torque at slip zero.

    >>> slip_curve(((0, 20.0), (10, 15.0))).torque(0, -4)
    -18.0
    """
    above = _slopes(rows)
    held = rows[0][1] if stick is None else stick
    return symmetric_curve("rate", (Hold(0, -held, held), *above))


def clutch_curve(rows: NumberRows, stick: Any = None) -> PieceCurve:
    """Curve of the faces of a clutch by rows [slip speed, torque or friction coefficient], up to the last row.

    Rows from slip zero on hold both ways and stick up to ``stick``, by default the first of them; rows through negative
    slips hold as they are, without a step.

    >>> curve = clutch_curve(((0, 20.0), (10, 15.0)))
    >>> curve.torque(0, -4), curve.pieces[1]
    (-18.0, Hold(at=0, low=-20.0, high=20.0))
    """
    if stick is not None:
        return slip_curve(rows, stick)
    slopes = _slopes(rows)
    return symmetric_curve("rate", slopes) if rows[0][0] == 0 else PieceCurve("rate", slopes)


def _slopes(rows: NumberRows) -> tuple[Slope, ...]:
    """Straight pieces over the slip between rows [slip speed, torque]."""
    slopes = []
    for (start, low), (end, high) in pairwise(rows):
        slope = (high - low) / (end - start)
        # The torque of a piece is that of its line at slip 0.
        slopes.append(Slope(low - slope * start, 0, slope, start, end))
    return tuple(slopes)


# Torque curves over twist: springs in stages with preload, rows of twist and torque, and clearances.


def stage_curve(stages: Sequence[SpringStage], value: Values) -> PieceCurve:
    """Curve of a spring in stages, the same both ways, in numbers of the algebra of ``value``.

    On stage i the torque is T_i + k_i (gamma - gamma_i), which begins at the end gamma_i of the stage before it, with
    T_i the torque there plus the preload P_i of the stage. Where P_i is not zero, the twist stands still at gamma_i
    while the torque lies between T_i - P_i and T_i, and at zero between -P_1 and P_1.

    Examples
    --------
    >>> from torsionnet.base.expressions import FLOAT
    >>> stages = (SpringStage(100, "0.1 rad"), SpringStage(400, preload="5 N*m"))
    >>> curve = stage_curve(stages, Values({}, FLOAT))
    >>> curve.torque(0.05, 0), curve.torque(0.1, 0), round(curve.torque(0.2, 0), 9), curve.torque(-0.05, 0)
    (5.0, 15.0, 55.0, -5.0)
    >>> [state.twist for state in curve.states_at(12)]
    [0.1]
    """
    above: list[Slope | Hold] = []
    for place, span in enumerate(stage_spans(stages, value)):
        twist, low = span.begin.twist, span.begin.torque
        torque = low + span.preload
        if span.preload > 0:
            above.append(Hold(twist, low if place else -span.preload, torque))
        upper = None if span.end is None else span.end.twist
        above.append(Slope(torque - span.stiffness * twist, span.stiffness, 0, twist, upper))
    return symmetric_curve("twist", tuple(above)).entered(value.algebra.number)


def twist_table_curve(rows: NumberRows) -> PieceCurve:
    """Curve of rows [twist, torque] in numbers of one algebra, joined by straight lines, which ends at the last row.

    Rows from zero on hold both ways; a torque in the first of them is that under which the springs are installed.

    Examples
    --------
    >>> curve = twist_table_curve(((-1.0, -5.0), (0.0, 20.0), (2.0, 30.0)))
    >>> curve.torque(-0.5, 0), curve.torque(1, 0), curve.energy(1), curve.range()
    (7.5, 25.0, 22.5, (-1.0, 2.0))
    """
    slopes = []
    for (start, low), (end, high) in pairwise(rows):
        stiffness = (high - low) / (end - start)
        slopes.append(Slope(low - stiffness * start, stiffness, 0, start, end))
    if rows[0][0] == 0:
        return symmetric_curve("twist", tuple(slopes))
    return PieceCurve("twist", tuple(slopes))


def clearance_curve(gap: Any, stiffness: Any, damping: Any) -> PieceCurve:
    """Curve of a clearance: no torque from -gap/2 to gap/2, beyond it max(0, k d + c d') at the penetration d.

    On the positive side d = gamma - gap/2 and d' = gamma'; the negative side is its mirror image.

    >>> clearance_curve(0.2, 100, 1).torque(0.3, -50), clearance_curve(0.2, 100, 1).torque(-0.3, 0)
    (0.0, -20.0)
    """
    contact = Slope(-stiffness * gap / 2, stiffness, damping, gap / 2, None, 1)
    return symmetric_curve("twist", (Slope(lower=0, upper=gap / 2), contact))
