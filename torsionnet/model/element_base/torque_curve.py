"""Base class of torque curves over twist and rate of one row, and the states about which slopes replace them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class MotionState:
    """Mean twist in rad and rate in rad/s of a row, rates of sensed rows, and the piece of the curve in force there.

    ``piece`` is the number of a piece of :class:`.PieceCurve`, so that curves with symbols as coefficients need no
    comparison; None lets the curve find it from numbers.
    """

    twist: float = 0.0
    rate: float = 0.0
    sensed: tuple[float, ...] = ()
    piece: int | None = None


AT_REST = MotionState()
"""State of a row without twist, in which nothing moves."""


class TorqueCurve:
    """Base class of torques over the twist gamma and the rate gamma' of a row, with coefficients in one algebra."""

    def torque(self, twist: Any, rate: Any, *sensed: Any) -> Any:
        """Torque in N m against the motion, at a corner that of the piece above it."""
        raise NotImplementedError

    def energy(self, twist: Any) -> Any:
        """Energy in J that the curve has stored at a twist in rad: the integral of its torque at rate 0 from twist 0.

        Curves over the rate store none.
        """
        raise NotImplementedError

    def slopes(self, state: MotionState) -> tuple[Any, ...]:
        """Slopes of the torque at a state: over the twist in N m/rad, over the rate and the rates of sensed rows."""
        raise NotImplementedError

    def holds(self, state: MotionState) -> bool:
        """Whether the row stands still at a state, where the torque may take any value of a range."""
        del state
        return False
