"""Load of constant power, whose torque falls with its speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Expression
from torsionnet.model.element_base.element import Element, register
from torsionnet.model.element_base.element_entries import NodeName
from torsionnet.model.element_base.laws import Law, MotionLaw, MotionState, Part, Row, Values, WholePart, difference
from torsionnet.model.motion_laws.power_curve import PowerCurve


@register
@dataclass(frozen=True, eq=False, repr=False)
class ConstantPowerLoad(Element):
    """A load that takes the power P at any speed, as a generator behind a fast converter: negative damping.

    Its torque P/omega falls with the speed, so that small changes of speed are driven: dT/domega = -P/omega^2. A
    machine of negative power feeds a constant one in; that damps. The speed is that of the node against its housing,
    at which P is taken; it may be a parameter that follows the operating point.

    P/omega is its law of motion in time, over the absolute speed. Without ``speed`` linear results take the slope at
    the operating point; without one the load does nothing.

    Examples
    --------
    >>> load = ConstantPowerLoad("converter", node="rotor", power="2 MW", speed="100 rad/s")
    >>> (law,) = load.parts(Values({}))
    >>> float(law.damping)
    -200.0
    """

    kind: ClassVar[str] = "constant_power_load"
    glyph: ClassVar[str] = "load"
    sign: ClassVar[str] = "positive when the drivetrain drives the load in the positive sense"
    may_feed: ClassVar[bool] = True
    working_point: ClassVar[tuple[str, ...]] = ("speed",)

    node: str = entry(NodeName("the node it turns with", allow_ground=False))
    power: Expression = entry(PhysicalQuantity("power that it takes; negative: that it gives", "power", "P", None))
    speed: Expression | None = entry(
        PhysicalQuantity(
            "speed at which it takes it; default: that of the operating point", "speed", "Omega", exclusive=True
        ),
        None,
    )
    housing: str = entry(NodeName("the node that takes its torque"), "ground")

    def contradictions(self) -> list[Fault]:
        if self.node == self.housing:
            return [Fault("the load and its housing are on one node; give two different nodes", ("housing",))]
        return []

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        return self._parts_about(None if self.speed is None else value(self.speed), value)

    def own_tangent_parts(self, value: Values, states: Sequence[MotionState] = ()) -> tuple[Part, ...]:
        """Parts of the load for small motion about a speed; at rest it does nothing."""
        return self._parts_about(states[0].rate if states and states[0].rate else None, value)

    def own_whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        return (MotionLaw(difference(self.node, self.housing), PowerCurve(value(self.power), 1, -1)),)

    def _parts_about(self, speed: Any, value: Values) -> tuple[Part, ...]:
        damping = 0 if speed is None else -value(self.power) / speed**2
        return (Law(difference(self.node, self.housing), damping=damping),)

    def mean_speed_rows(self, value: Values) -> tuple[Row, ...]:
        """No rows of mean speeds, because the load turns freely in its housing."""
        del value
        return ()
