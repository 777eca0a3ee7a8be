"""Clearance between two nodes, with contact on either side that pushes but never pulls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry
from torsionnet.base.expressions import Expression
from torsionnet.model.damping import DampingMeasure, DampingQuantity
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodePair
from torsionnet.model.element_base.laws import MotionLaw, Part, Values, WholePart, difference
from torsionnet.model.motion_laws.spring_curves import clearance_curve


@register
@dataclass(frozen=True, eq=False, repr=False)
class Clearance(Element):
    r"""A clearance, as of splines, claws or teeth: no torque while -gap/2 < gamma < gap/2, contact beyond.

    The law of motion at a penetration d > 0 is T = max(0, k d + c d'), with d = gamma - gap/2 and d' = gamma' on the
    positive side; the negative side is its mirror image. Contact pushes and never pulls: where k d + c d' is below
    zero the bodies part though d > 0.

    Linear results take the slope at the operating point: k and c in contact, nothing in the gap, where the two sides
    move freely against each other. Without an operating point gamma is 0.

    Examples
    --------
    >>> from torsionnet.base.expressions import FLOAT
    >>> mesh = Clearance("mesh", nodes=("a", "b"), gap="0.2 rad", stiffness="100 N*m/rad", damping="1 N*m*s/rad")
    >>> (law,) = mesh.whole_parts(Values({}, FLOAT))
    >>> [round(law.torque(*state), 9) for state in ((0.05, 0), (0.3, 0), (0.3, -5), (0.3, -50), (-0.3, 0))]
    [0.0, 20.0, 15.0, 0.0, -20.0]
    """

    kind: ClassVar[str] = "clearance"
    glyph: ClassVar[str] = "clearance"

    nodes: tuple[str, str] = entry(
        NodePair("the two nodes it connects, one may be ground; twist is the angle of the first minus the second")
    )
    gap: Expression = entry(
        PhysicalQuantity("whole free angle, from one contact to the other", "angle", "b", exclusive=True)
    )
    stiffness: Expression = entry(PhysicalQuantity("stiffness in contact", "stiffness", "k", exclusive=True))
    damping: Expression | DampingMeasure = entry(
        DampingQuantity("viscous damping in contact, or a damping measure at a frequency", "damping", "c"), 0
    )

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        return self.tangent_parts(value)

    def own_whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        stiffness = value(self.stiffness)
        damping = viscous(self.damping, stiffness, value)
        return (MotionLaw(difference(*self.nodes), clearance_curve(value(self.gap), stiffness, damping)),)
