"""Spring with losses that do not depend on frequency."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Expression
from torsionnet.model.damping import DampingMeasure, DampingQuantity, LossFactor, loss_factor
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodePair
from torsionnet.model.element_base.laws import Law, Part, Values, difference
from torsionnet.model.element_base.round_section import section_faults
from torsionnet.model.elements.springs import INNER_DIAMETER, NODE_PAIR_DESCRIPTION, OUTER_DIAMETER


@register
@dataclass(frozen=True, eq=False, repr=False)
class HystereticSpring(Element):
    """A spring with rate-independent losses: torque k (1 + j eta) gamma at positive frequency.

    The loss per cycle, pi eta k gamma^2, does not depend on frequency. The law holds in the frequency domain only; in
    the limit of zero frequency its phase lag stays.

    Examples
    --------
    >>> rubber = HystereticSpring("rubber", nodes=("a", "b"), stiffness=460, loss_factor=0.3)
    >>> rubber.ports
    {'first': 'a', 'second': 'b'}
    """

    kind: ClassVar[str] = "hysteretic_spring"
    glyph: ClassVar[str] = "spring"

    nodes: tuple[str, str] = entry(NodePair(NODE_PAIR_DESCRIPTION))
    stiffness: Expression = entry(PhysicalQuantity("torsional stiffness, the real part", "stiffness", "k"))
    loss_factor: Expression | DampingMeasure = entry(
        LossFactor("loss factor, or another frequency-free damping measure", "1", "eta")
    )
    damping: Expression | DampingMeasure = entry(DampingQuantity("viscous damping in parallel", "damping", "c"), 0)
    outer_diameter: Expression | None = entry(OUTER_DIAMETER, None)
    inner_diameter: Expression = entry(INNER_DIAMETER, 0)

    def contradictions(self) -> list[Fault]:
        return section_faults(self)

    @property
    def diameters(self) -> tuple[Expression, Expression] | None:
        return None if self.outer_diameter is None else (self.outer_diameter, self.inner_diameter)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        stiffness = value(self.stiffness)
        eta = loss_factor(self.loss_factor, value.parameters, value.algebra)
        damping = viscous(self.damping, stiffness, value)
        return (Law(difference(*self.nodes), damping=damping, stiffness=stiffness, loss_factor=eta),)
