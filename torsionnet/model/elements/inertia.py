"""Rigid rotating mass at a node."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.core.entries.scalars import PhysicalQuantity
from torsionnet.core.entries.spec import entry
from torsionnet.core.expressions import Expression
from torsionnet.model.element_base.element import Element, register
from torsionnet.model.element_base.laws import Law, Part, Values, make_row
from torsionnet.model.element_base.nodes import NodeName


@register
@dataclass(frozen=True, eq=False, repr=False)
class Inertia(Element):
    """A rigid rotating mass at a node: torque J d2theta/dt2.

    Examples
    --------
    >>> Inertia("flywheel", node="primary", inertia="0.6 kg*m^2 GD2").inertia.evaluate({})
    Fraction(3, 20)
    """

    kind: ClassVar[str] = "inertia"
    glyph: ClassVar[str] = "disc"
    sign: ClassVar[str] = "positive when the drivetrain accelerates the inertia in the positive sense"

    node: str = entry(NodeName("the node it turns with", allow_ground=False))
    inertia: Expression = entry(PhysicalQuantity("mass moment of inertia", "inertia", "J", usual=(1e-12, 1e10)))

    def parts(self, value: Values) -> tuple[Part, ...]:
        return (Law(make_row([(self.node, 1)]), inertia=value(self.inertia)),)
