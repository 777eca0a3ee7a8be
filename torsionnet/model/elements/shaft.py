"""Shaft from its geometry, in equal segments."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar

from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import Count, OneOf, entry
from torsionnet.base.errors import Fault
from torsionnet.base.expression_reading import scalar
from torsionnet.base.expressions import Expression
from torsionnet.model.damping import DampingMeasure, DampingQuantity
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodePair
from torsionnet.model.element_base.laws import Law, Part, Row, Values, difference, make_row
from torsionnet.model.element_base.round_section import section_faults


@register
@dataclass(frozen=True, eq=False, repr=False)
class Shaft(Element):
    """A uniform round shaft, solid or hollow, in n equal segments.

    With the polar moment of area I_p = pi (D^4 - d^4) / 32 the whole shaft has stiffness k = G I_p / L and inertia
    J = rho I_p L; each segment has n k and J / n. The inertia of a segment is lumped half and half on its ends
    (J/2n each), or consistent with a linear twist: J/(6n) [[2, 1], [1, 2]], which is J/4n on the sum and J/12n on the
    difference of its end angles. With more segments the frequencies approach those of the continuum, lumped ones from
    below, consistent ones from above.

    Examples
    --------
    >>> steel = {"shear_modulus": "80 GPa", "density": "7850 kg/m^3"}
    >>> shaft = Shaft("shaft", nodes=("a", "b"), outer_diameter="70 mm", length="1.5 m", segments=3, **steel)
    >>> shaft.internal_nodes
    ('shaft.1', 'shaft.2')
    """

    kind: ClassVar[str] = "shaft"
    glyph: ClassVar[str] = "shaft"

    nodes: tuple[str, str] = entry(NodePair("its two ends; twist is the angle of the first minus the second"))
    outer_diameter: Expression = entry(
        PhysicalQuantity("outer diameter", "length", "D", exclusive=True, usual=(1e-3, 5))
    )
    length: Expression = entry(PhysicalQuantity("length", "length", "L", exclusive=True, usual=(1e-3, 2e4)))
    shear_modulus: Expression = entry(
        PhysicalQuantity("shear modulus", "shear modulus", "G", exclusive=True, usual=(1e5, 1e12)), "79.3 GPa"
    )
    density: Expression = entry(PhysicalQuantity("density", "density", "rho", usual=(100, 25e3)), "7850 kg/m^3")
    inner_diameter: Expression = entry(
        PhysicalQuantity("inner diameter, 0 for a solid shaft", "length", "d", usual=(1e-4, 5)), 0
    )
    segments: int = entry(Count("number of equal segments"), 1)
    inertia: str = entry(OneOf("how its inertia is modelled", ("consistent", "lumped", "none")), "consistent")
    damping: Expression | DampingMeasure = entry(
        DampingQuantity("viscous damping of the whole shaft in twist", "damping", "c"), 0
    )

    def contradictions(self) -> list[Fault]:
        return section_faults(self)

    @property
    def diameters(self) -> tuple[Expression, Expression]:
        return self.outer_diameter, self.inner_diameter

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return tuple(f"{self.name}.{index}" for index in range(1, self.segments))

    def twist(self, value: Values) -> Row:
        del value
        return difference(*self.nodes)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        n = value(scalar(self.segments))
        # k = G I_p/L and J = rho I_p L with the polar moment I_p of a ring
        polar = value.algebra.pi * (value(self.outer_diameter) ** 4 - value(self.inner_diameter) ** 4) / 32
        stiffness = value(self.shear_modulus) * polar / value(self.length)
        inertia = value(self.density) * polar * value(self.length) / n
        damping = n * viscous(self.damping, stiffness, value)
        stations = (self.nodes[0], *self.internal_nodes, self.nodes[1])
        parts: list[Part] = []
        for first, second in pairwise(stations):
            parts += self._segment(first, second, n * stiffness, damping, inertia)
        return tuple(parts)

    def _segment(self, first: str, second: str, stiffness: Any, damping: Any, inertia: Any) -> list[Part]:
        twist = difference(first, second)
        if self.inertia == "consistent":
            both = make_row([(first, 1), (second, 1)])
            elastic = Law(twist, stiffness=stiffness, damping=damping, inertia=inertia / 12)
            return [elastic, Law(both, inertia=inertia / 4)]
        elastic = Law(twist, stiffness=stiffness, damping=damping)
        if self.inertia == "none":
            return [elastic]
        ends = [make_row([(node, 1)]) for node in (first, second)]
        return [elastic, *(Law(row, inertia=inertia / 2) for row in ends if row)]
