"""Tyre with its torsional stiffness in series with the slip on the road."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.composite import one_exactly
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import OneOf, entry
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Expression
from torsionnet.model.damping import DampingMeasure, DampingQuantity
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodePair
from torsionnet.model.element_base.laws import Constraint, Law, Part, Row, Values, difference, make_row


@register
@dataclass(frozen=True, eq=False, repr=False)
class Tyre(Element):
    """A tyre between rim and road: carcass and sidewall as a spring, and longitudinal slip as a damper behind it.

    At the speed v a slip of 1 makes the force C, so that the torque T = C r^2 (omega_rim - omega_road) / v is that of a
    damper c = C r^2 / v. In series with the stiffness k the torque follows the slip with a first-order lag:
    sigma/v dT/dt + T = c (omega_rim - omega_road), with the relaxation length sigma = C r^2 / k (H. B. Pacejka, Tire
    and Vehicle Dynamics, 3rd ed., chapter 7). Standing on the road, without slip, only the spring is left. The belt is
    the node ``NAME.belt``; it may have an inertia of its own. The node of the road turns with the vehicle, v / r.

    Examples
    --------
    >>> tyre = Tyre("tyre", nodes=("hub", "road"), radius="0.3 m", slip_stiffness="80 kN", relaxation_length="0.4 m",
    ...     speed="20 m/s")
    >>> spring, slip = tyre.parts(Values({}))
    >>> float(spring.stiffness), float(slip.damping)
    (18000.0, 360.0)
    """

    kind: ClassVar[str] = "tyre"
    glyph: ClassVar[str] = "spring"

    nodes: tuple[str, str] = entry(NodePair("rim and road; twist is the angle of the first minus the second"))
    state: str = entry(OneOf("whether it rolls, with slip, or stands without", ("rolling", "standing")), "rolling")
    radius: Expression | None = entry(
        PhysicalQuantity("rolling radius", "length", "r", exclusive=True, usual=(0.02, 3)), None
    )
    slip_stiffness: Expression | None = entry(
        PhysicalQuantity("longitudinal force per slip", "force", "C", exclusive=True, usual=(500, 1e8)), None
    )
    speed: Expression | None = entry(PhysicalQuantity("speed on the road", "velocity", "v", exclusive=True), None)
    stiffness: Expression | None = entry(
        PhysicalQuantity("torsional stiffness of rim against road", "stiffness", "k", exclusive=True), None
    )
    relaxation_length: Expression | None = entry(
        PhysicalQuantity("instead of the stiffness: relaxation length", "length", "sigma", exclusive=True), None
    )
    damping: Expression | DampingMeasure = entry(
        DampingQuantity("viscous damping in parallel to the stiffness", "damping", "d"), 0
    )
    belt_inertia: Expression = entry(PhysicalQuantity("inertia of belt and tread", "inertia", "J_b"), 0)

    def contradictions(self) -> list[Fault]:
        wrong = one_exactly(self, "stiffness", "relaxation_length")
        if wrong:
            return wrong
        needed = ["radius", "slip_stiffness", "speed"] if self.state == "rolling" else []
        if self.relaxation_length is not None:
            needed = needed or ["radius", "slip_stiffness"]
        missing = [name for name in needed if getattr(self, name) is None]
        if not missing:
            return []
        why = "a rolling tyre" if self.state == "rolling" else "a stiffness by the relaxation length"
        hint = "; one that stands still has state: standing" if self.state == "rolling" else ""
        return [Fault(f"{why} needs {', '.join(needed)}; here is no {' and no '.join(missing)}{hint}", on_key=True)]

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return (f"{self.name}.belt",)

    def twist(self, value: Values) -> Row:
        del value
        return difference(*self.nodes)

    def mean_speed_rows(self, value: Values) -> tuple[Row, ...]:
        """Rows of node speeds that tie rim, belt and road to one mean speed.

        The slip of a driven tyre is a few percent at most.
        """
        return tuple(part.row for part in self.parts(value)[:2])

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        (rim, road), (belt,) = self.nodes, self.internal_nodes
        stiffness = self._stiffness(value)
        spring = Law(difference(rim, belt), stiffness=stiffness, damping=viscous(self.damping, stiffness, value))
        body = Law(make_row([(belt, 1)]), inertia=value(self.belt_inertia))
        return (spring, self._contact(difference(belt, road), value), *([body] if body.acts else []))

    def _contact(self, row: Row, value: Values) -> Part:
        if self.state == "standing":
            return Constraint(row)
        return Law(row, damping=value(self.slip_stiffness) * value(self.radius) ** 2 / value(self.speed))

    def _stiffness(self, value: Values) -> Any:
        if self.stiffness is not None:
            return value(self.stiffness)
        return value(self.slip_stiffness) * value(self.radius) ** 2 / value(self.relaxation_length)
