"""Base class of torque curves over twist and rate of one row, and the states about which slopes replace them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal


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

    def scaled(self, ratio: Any) -> MotionState:
        """State of a shaft that turns ``ratio`` times as fast, in the same piece."""
        ratio = float(ratio) if self.twist or self.rate or any(self.sensed) else 1.0
        return MotionState(ratio * self.twist, ratio * self.rate, tuple(ratio * one for one in self.sensed), self.piece)


AT_REST = MotionState()
"""State of a row without twist, in which nothing moves."""
END_SLACK = 1e-9
"""Share of the range of a curve by which a state may lie beyond its end: far more than rounding, far less than data."""


class TorqueCurve:
    """Base class of torques over the twist gamma and the rate gamma' of a row, with coefficients in one algebra."""

    over: Literal["twist", "rate"]
    """Motion of the row that the curve follows, and over which it may end."""

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

    def states_at(self, torque: Any) -> tuple[MotionState, ...] | None:
        """States in which the curve gives a torque in N m, by rising twist or rate; None where it cannot invert itself.

        None lets solvers bracket the states between the :meth:`corners`.
        """
        del torque
        return None

    def corners(self) -> tuple[Any, ...]:
        """Twists in rad, of a curve over the rate rates in rad/s, between which the torque rises or falls throughout.

        They are corners, steps and extremes, by rising twist or rate.
        """
        return ()

    def range(self) -> tuple[Any, Any]:
        """Twists in rad, of a curve over the rate rates in rad/s, between which the torque is given.

        None where the curve has no end. Beyond an end the last piece goes on, so that solvers may step over it; what
        they report is refused with :meth:`left`.
        """
        return None, None

    def left(self, twist: float, rate: float = 0.0, *sensed: float) -> str:
        """Message that a twist in rad, of a curve over the rate a rate in rad/s, lies beyond an end; else empty.

        A twist that misses the end by a rounding error is no fault. Curves over the rates of sensed rows need these.
        """
        del sensed
        at, unit = (twist, "rad") if self.over == "twist" else (rate, "rad/s")
        lower, upper = self.range()
        slack = END_SLACK * max(abs(float(end)) for end in (lower or 0, upper or 0))
        if (lower is None or at >= float(lower) - slack) and (upper is None or at <= float(upper) + slack):
            return ""
        ends = [f"{word} {float(end):.6g} {unit}" for word, end in (("from", lower), ("to", upper)) if end is not None]
        what = "twist" if self.over == "twist" else "slip speed"
        reached = f"and the {what} is {float(at):.6g} {unit}"
        return f"the torque is given {' '.join(ends)}, {reached}; extend the table or the last stage"

    def scaled(self, ratio: Any) -> TorqueCurve:
        """Curve r T(r gamma, r gamma') of a shaft whose angles are 1/r times those for which this curve holds.

        The energy is that of the curve at r gamma.
        """
        return ScaledCurve(self, ratio)


@dataclass(frozen=True)
class ScaledCurve(TorqueCurve):
    """Torque r T(r gamma, r gamma') of a curve quoted at a shaft that turns r times as fast."""

    curve: TorqueCurve
    ratio: Any

    @property
    def over(self) -> Literal["twist", "rate"]:  # type: ignore[override]
        """Motion of the row that the curve follows."""
        return self.curve.over

    def torque(self, twist: Any, rate: Any, *sensed: Any) -> Any:
        moved = (self.ratio * one for one in (twist, rate, *sensed))
        return self.ratio * self.curve.torque(*moved)

    def energy(self, twist: Any) -> Any:
        return self.curve.energy(self.ratio * twist)

    def slopes(self, state: MotionState) -> tuple[Any, ...]:
        return tuple(self.ratio**2 * slope for slope in self.curve.slopes(state.scaled(self.ratio)))

    def holds(self, state: MotionState) -> bool:
        return self.curve.holds(state.scaled(self.ratio))

    def states_at(self, torque: Any) -> tuple[MotionState, ...] | None:
        found = self.curve.states_at(torque / self.ratio)
        if found is None:
            return None
        own = tuple(state.scaled(1 / self.ratio) for state in found)
        return own[::-1] if self.ratio < 0 else own

    def corners(self) -> tuple[Any, ...]:
        found = tuple(place / self.ratio for place in self.curve.corners())
        return found[::-1] if self.ratio < 0 else found

    def range(self) -> tuple[Any, Any]:
        lower, upper = (None if end is None else end / self.ratio for end in self.curve.range())
        return (upper, lower) if self.ratio < 0 else (lower, upper)
