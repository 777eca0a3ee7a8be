"""Torque curve of straight pieces over twist or over rate, with steps at which the row stands still."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from torsionnet.model.element_base.torque_curve import MotionState, TorqueCurve


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
        return torque if self.side * torque >= 0 else 0 * torque


@dataclass(frozen=True)
class Hold:
    """Step of a curve at which the row stands still while its torque lies between ``low`` and ``high`` in N m.

    ``at`` is the twist in rad, or over the rate the rate in rad/s, at which it stands. The range may be wider than the
    torques of the pieces beside it: friction at rest may hold more than sliding friction.
    """

    at: Any
    low: Any
    high: Any


@dataclass(frozen=True)
class PieceCurve(TorqueCurve):
    """Torque of straight pieces in rising order over the twist or over the rate, with steps between them.

    Examples
    --------
    A clearance of 0.2 rad with a stiffness of 100 N m/rad on either side:

    >>> gap = PieceCurve("twist", (Slope(10, 100, 0, None, -0.1, -1), Slope(lower=-0.1, upper=0.1),
    ...     Slope(-10, 100, 0, 0.1, None, 1)))
    >>> [round(gap.torque(twist, 0), 9) for twist in (-0.2, 0, 0.1, 0.3)], round(gap.energy(0.3), 9)
    ([-10.0, 0, 0.0, 20.0], 2.0)
    >>> gap.slopes(MotionState(twist=0.1))
    (100, 0)
    """

    over: Literal["twist", "rate"]
    pieces: tuple[Slope | Hold, ...]

    def number_at(self, twist: Any, rate: Any) -> int:
        """Number of the piece in force at a twist in rad and a rate in rad/s; at a corner that of the piece above.

        At a step it is the number of the step.
        """
        at = twist if self.over == "twist" else rate
        found = 0
        for number, piece in enumerate(self.pieces):
            if isinstance(piece, Hold):
                if at == piece.at:
                    return number
            elif piece.lower is None or at >= piece.lower:
                found = number
        return found

    def _slope_at(self, state: MotionState) -> Slope:
        """Straight piece in force at a state, that above it at a step."""
        number = self.number_at(state.twist, state.rate) if state.piece is None else state.piece
        piece = self.pieces[number]
        if isinstance(piece, Hold):
            piece = self.pieces[number + 1] if number + 1 < len(self.pieces) else self.pieces[number - 1]
        if isinstance(piece, Hold):
            raise TypeError("two steps of a curve follow each other")
        return piece

    def torque(self, twist: Any, rate: Any, *sensed: Any) -> Any:
        del sensed
        return self._slope_at(MotionState(twist, rate)).at(twist, rate)

    def energy(self, twist: Any) -> Any:
        if self.over == "rate":
            return 0 * twist
        low, high = (0, twist) if twist >= 0 else (twist, 0)
        total = 0 * twist
        for piece in self.pieces:
            if isinstance(piece, Slope):
                start = low if piece.lower is None or piece.lower < low else piece.lower
                end = high if piece.upper is None or piece.upper > high else piece.upper
                if start < end:
                    total += piece.torque * (end - start) + piece.stiffness * (end**2 - start**2) / 2
        return total if twist >= 0 else -total

    def slopes(self, state: MotionState) -> tuple[Any, ...]:
        piece = self._slope_at(state)
        return piece.stiffness, piece.damping

    def holds(self, state: MotionState) -> bool:
        number = self.number_at(state.twist, state.rate) if state.piece is None else state.piece
        return isinstance(self.pieces[number], Hold)
