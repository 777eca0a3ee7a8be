"""Kinematic rows, and the laws, constraints and actions on rows that make up an element.

Every mechanical element acts on a scalar gamma = a^T theta, the *row* a being a sparse map from node to coefficient.
A :class:`Law` answers the motion gamma with a torque kappa(s) gamma; a :class:`Constraint` holds gamma at zero. An
:class:`Action` drives one gamma by the motion of another. A :class:`MotionLaw` answers gamma and its rate with a torque
that is not proportional to them; linear solvers use its tangent, a :class:`Law`.
Coefficients are numbers, exact rationals or symbols alike.

Here as well: base class of torque curves over twist and rate of one row, and the states about which slopes replace
them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from torsionnet.base.expressions import RATIONAL, Algebra, Expression

if TYPE_CHECKING:
    from torsionnet.model.element_base.dynamic_stiffness import DynamicStiffness

GROUND = "ground"
"""Name of the node that never moves, whose angle is zero; its coefficient drops out of every row."""

Row: TypeAlias = dict[str, Any]
"""Type of a row, the weight of every node's angle in a sum, by node."""


@dataclass(frozen=True)
class Law:
    """Torque kappa(s) gamma against the motion of the row gamma, kappa(s) = J s^2 + c s + k (1 + j eta) + table(omega).

    ``inertia`` kg m^2, ``damping`` N m s/rad, ``stiffness`` N m/rad, ``loss_factor`` eta without unit,
    ``table`` what depends on frequency. A law has a loss factor or a table, whose own loss is in it; with both it
    raises `ValueError`.
    """

    row: Row
    inertia: Any = 0
    damping: Any = 0
    stiffness: Any = 0
    loss_factor: Any = 0
    table: DynamicStiffness | None = None

    def __post_init__(self) -> None:
        if self.table is not None and self.loss_factor:
            raise ValueError("a law has a loss factor or a table over frequency: yield two laws on the same row")

    @property
    def is_elastic(self) -> bool:
        """Whether the law is a spring, which a table is even if its stiffness vanishes at rest."""
        return bool(self.stiffness != 0) or (self.table is not None and self.table.is_elastic)

    @property
    def holds_at_rest(self) -> bool:
        """Whether the law makes a torque against a constant angle gamma."""
        return bool(self.stiffness != 0) or (self.table is not None and self.table.holds_at_rest)

    @property
    def acts(self) -> bool:
        """Whether the law makes any torque: a coefficient differs from zero, or there is a table."""
        return self.is_elastic or self.table is not None or bool(self.inertia != 0) or bool(self.damping != 0)


@dataclass(frozen=True)
class Constraint:
    """Rigid condition that a row's weighted sum of node angles is zero.

    Its multiplier is the torque that the constraint carries.
    """

    row: Row


@dataclass(frozen=True)
class Action:
    """Torque in N m on one row of nodes, kappa(s) times the motion of another row of nodes; a positive torque drives.

    kappa(s) = (n_0 + n_1 s + ...)/(d_0 + d_1 s + ...) e^(-s delay) in N m/rad, ``numerator`` and ``denominator``
    ascending in s, ``delay`` in s. A law that opposes its own motion is a :class:`Law`; an action need not be passive,
    nor the same both ways.
    """

    row: Row
    sensed: Row
    numerator: tuple[Any, ...]
    denominator: tuple[Any, ...] = (1,)
    delay: Any = 0

    @property
    def acts(self) -> bool:
        """Whether the action makes any torque: neither row nor numerator is zero."""
        return bool(self.row) and bool(self.sensed) and any(bool(value != 0) for value in self.numerator)

    @property
    def acts_at_rest(self) -> bool:
        """Whether a constant sensed angle makes the action give a torque."""
        # N/D at s = 0 is not zero unless N has the higher lowest power of s.
        above, below = (
            next((power for power, value in enumerate(part) if value != 0), len(part))
            for part in (self.numerator, self.denominator)
        )
        return self.acts and above <= below


@dataclass(frozen=True)
class MotionLaw:
    """Torque T(gamma, gamma') against the motion of the row gamma that does not follow it in proportion.

    The torque is ``scale`` times that of ``curve``. A scenario may give ``scale`` over time under the name
    ``scaled_by``, as the clamp torque of a clutch; ``sensed`` are rows whose rates the curve follows besides its own.
    With a time constant ``lag`` tau in s the torque T of the motion follows that of the curve, T + tau dT/dt = T_curve.
    """

    row: Row
    curve: TorqueCurve
    scale: Any = 1
    scaled_by: str = ""
    sensed: tuple[Row, ...] = ()
    lag: Any = 0

    def torque(self, twist: Any, rate: Any, *sensed: Any) -> Any:
        """Torque in N m against the motion at a twist gamma in rad, a rate in rad/s, and rates of sensed rows."""
        return self.scale * self.curve.torque(twist, rate, *sensed)

    def energy(self, twist: Any) -> Any:
        """Energy in J that the law has stored at a twist in rad, 0 at twist 0."""
        return self.scale * self.curve.energy(twist)

    def tangent(self, state: MotionState) -> tuple[Law | Constraint | Action, ...]:
        """Linear parts in place of the law for small motion about a state.

        These are a :class:`Law` with the slopes of the curve, a :class:`Constraint` where the curve holds the row
        still, and an :class:`Action` for each sensed row.
        """
        if self.curve.holds(state):
            return (Constraint(self.row),)
        stiffness, damping, *others = self.curve.slopes(state)
        law = Law(self.row, stiffness=self.scale * stiffness, damping=self.scale * damping)
        # A sensed motion drives the row, by s times the slope, where a law resists: hence the sign.
        pairs = zip(self.sensed, others, strict=True)
        return (law, *(Action(self.row, row, (0, -self.scale * slope)) for row, slope in pairs))


Part: TypeAlias = Law | Constraint | Action
"""Type of the linear parts of an element."""
WholePart: TypeAlias = Part | MotionLaw
"""Type of the parts of an element with its laws of motion in full."""


def make_row(entries: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    """Weight of every node's angle, by node, from pairs (node, weight).

    Coefficients of one node are added, ground and exact zeros drop out.
    """
    row: Row = {}
    for node, coefficient in entries:
        if node != GROUND:
            row[node] = row[node] + coefficient if node in row else coefficient
    return {node: coefficient for node, coefficient in row.items() if coefficient != 0}


def difference(first: str, second: str) -> dict[str, Any]:
    """Weights 1 and -1 of two nodes' angles, which make the twist theta_first - theta_second."""
    return make_row([(first, 1), (second, -1)])


@dataclass(frozen=True)
class Values:
    """Evaluator of an element's expressions in SI units in one algebra: exact rationals, floats or sympy."""

    parameters: Mapping[str, Any]
    algebra: Algebra = RATIONAL

    def __call__(self, scalar: Expression | None) -> Any:
        if not isinstance(scalar, Expression):
            raise TypeError(f"{scalar!r} was not coerced to an expression")
        return scalar.evaluate(self.parameters, self.algebra)

    def root(self, square: Any, reason: str) -> Any:
        """Square root in the algebra of the values, or an ArithmeticError with ``reason`` if it does not exist."""
        try:
            return self.algebra.sqrt(square)
        except ArithmeticError:
            raise ArithmeticError(reason) from None


def own_node(ports: Mapping[str, str]) -> str:
    """Node of an element, the first but ground, to whose shaft its values belong."""
    return next((node for node in ports.values() if node != GROUND), GROUND)


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
        return MotionState(
            ratio * self.twist, ratio * self.rate, tuple(ratio * motion for motion in self.sensed), self.piece
        )


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
        moved = (self.ratio * motion for motion in (twist, rate, *sensed))
        return self.ratio * self.curve.torque(*moved)

    def energy(self, twist: Any) -> Any:
        return self.curve.energy(self.ratio * twist)

    def slopes(self, state: MotionState) -> tuple[Any, ...]:
        return tuple(self.ratio**2 * slope for slope in self.curve.slopes(state.scaled(self.ratio)))

    def holds(self, state: MotionState) -> bool:
        return self.curve.holds(state.scaled(self.ratio))

    def states_at(self, torque: Any) -> tuple[MotionState, ...] | None:
        states = self.curve.states_at(torque / self.ratio)
        if states is None:
            return None
        own = tuple(state.scaled(1 / self.ratio) for state in states)
        return own[::-1] if self.ratio < 0 else own

    def corners(self) -> tuple[Any, ...]:
        corners = tuple(place / self.ratio for place in self.curve.corners())
        return corners[::-1] if self.ratio < 0 else corners

    def range(self) -> tuple[Any, Any]:
        lower, upper = (None if end is None else end / self.ratio for end in self.curve.range())
        return (upper, lower) if self.ratio < 0 else (lower, upper)
