"""Elastic and dissipative connections between two nodes, or between a node and ground."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.core.damping import DampingMeasure
from torsionnet.core.entries.scalars import PhysicalQuantity
from torsionnet.core.entries.spec import entry
from torsionnet.core.errors import Fault
from torsionnet.core.expressions import Expression
from torsionnet.model.element_base.damping_entries import DampingQuantity
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.laws import Law, Part, Values, difference
from torsionnet.model.element_base.nodes import NodePair
from torsionnet.model.element_base.round_section import section_faults

NODE_PAIR_DESCRIPTION = "the two nodes it connects, one may be ground; twist is the angle of the first minus the second"
OUTER_DIAMETER = PhysicalQuantity(
    "outer diameter of the shaft that it stands for, where its stress is judged", "length", "D", exclusive=True
)
INNER_DIAMETER = PhysicalQuantity("inner diameter there", "length", "d")


@register
@dataclass(frozen=True, eq=False, repr=False)
class Spring(Element):
    """A torsion spring, with a viscous damper in parallel if wanted: torque k gamma + c dgamma/dt.

    Examples
    --------
    >>> shaft = Spring("shaft", nodes=("a", "b"), stiffness="0.46 kN*m/rad", damping={"zeta": 0.02, "at": "8 Hz"})
    >>> float(shaft.stiffness.evaluate({}))
    460.0
    """

    kind: ClassVar[str] = "spring"
    glyph: ClassVar[str] = "spring"

    nodes: tuple[str, str] = entry(NodePair(NODE_PAIR_DESCRIPTION))
    stiffness: Expression = entry(PhysicalQuantity("torsional stiffness", "stiffness", "k"))
    damping: Expression | DampingMeasure = entry(
        DampingQuantity("viscous damping, or a damping measure at a frequency", "damping", "c"), 0
    )
    outer_diameter: Expression | None = entry(OUTER_DIAMETER, None)
    inner_diameter: Expression = entry(INNER_DIAMETER, 0)

    def contradictions(self) -> list[Fault]:
        return section_faults(self)

    @property
    def diameters(self) -> tuple[Expression, Expression] | None:
        return None if self.outer_diameter is None else (self.outer_diameter, self.inner_diameter)

    def parts(self, value: Values) -> tuple[Part, ...]:
        stiffness = value(self.stiffness)
        damping = viscous(self.damping, stiffness, value)
        return (Law(difference(*self.nodes), stiffness=stiffness, damping=damping),)


@register
@dataclass(frozen=True, eq=False, repr=False)
class Damper(Element):
    """A viscous damper: torque c dgamma/dt.

    Examples
    --------
    >>> Damper("bearing", nodes=("motor", "ground"), damping="0.3 N*m*s/rad").kind
    'damper'
    """

    kind: ClassVar[str] = "damper"
    glyph: ClassVar[str] = "damper"

    nodes: tuple[str, str] = entry(NodePair(NODE_PAIR_DESCRIPTION))
    damping: Expression = entry(PhysicalQuantity("viscous damping", "damping", "c"))

    def parts(self, value: Values) -> tuple[Part, ...]:
        return (Law(difference(*self.nodes), damping=value(self.damping)),)
