"""Uniform shaft with distributed stiffness and inertia."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Expression
from torsionnet.model.damping import DampingMeasure, LossFactor
from torsionnet.model.element_base.element import Element, register
from torsionnet.model.element_base.element_entries import NodePair
from torsionnet.model.element_base.laws import Law, Part, Row, Values, difference, make_row
from torsionnet.model.element_base.round_section import section_faults
from torsionnet.model.element_base.shaft_stiffness import ShaftEnd, ShaftTwist

INNER_NODE_POSITION = Fraction(382, 1000)
"""Position of the shaft's inner node over its length, as the golden section is far from the node of low modes."""


@register
@dataclass(frozen=True, eq=False, repr=False)
class ContinuousShaft(Element):
    """A uniform round shaft, solid or hollow, by the exact solution of the wave equation: no segments.

    With k = G I_p / L, J = rho I_p L, I_p = pi (D^4 - d^4) / 32 and x = omega sqrt(J/k) = omega L sqrt(rho/G), the
    torques into its ends are k x cot x on the own angle and -k x / sin x on the other one. It has infinitely many
    modes; those of a drivetrain are counted by the algorithm of Wittrick and Williams (1971), so that none is missed.
    A loss factor makes the shear modulus G (1 + j eta). Shafts with steps or a taper are several in series.

    An inner node ``NAME.inside`` at 0.382 L shows how it moves between its ends, also where these stand still. Each of
    the two pieces, with its own length in K = k (1 + j eta) and in x, is a spring K x / sin x between its ends, and
    -K x tan(x/2) on each of them.

    Examples
    --------
    >>> pipe = ContinuousShaft("pipe", nodes=("a", "b"), outer_diameter="127 mm", length="1 km", inner_diameter=0.1)
    >>> pipe.internal_nodes
    ('pipe.inside',)
    """

    kind: ClassVar[str] = "continuous_shaft"
    glyph: ClassVar[str] = "shaft"

    nodes: tuple[str, str] = entry(NodePair("its two ends; twist is the angle of the first minus the second"))
    outer_diameter: Expression = entry(
        PhysicalQuantity("outer diameter", "length", "D", exclusive=True, usual=(1e-3, 5))
    )
    length: Expression = entry(PhysicalQuantity("length", "length", "L", exclusive=True, usual=(1e-3, 2e4)))
    shear_modulus: Expression = entry(
        PhysicalQuantity("shear modulus", "shear modulus", "G", exclusive=True, usual=(1e5, 1e12)), "79.3 GPa"
    )
    density: Expression = entry(
        PhysicalQuantity("density", "density", "rho", exclusive=True, usual=(100, 25e3)), "7850 kg/m^3"
    )
    inner_diameter: Expression = entry(
        PhysicalQuantity("inner diameter, 0 for a solid shaft", "length", "d", usual=(1e-4, 5)), 0
    )
    loss_factor: Expression | DampingMeasure = entry(
        LossFactor("loss factor of the material, or another frequency-free damping measure", "1", "eta"), 0
    )

    def contradictions(self) -> list[Fault]:
        return section_faults(self)

    @property
    def diameters(self) -> tuple[Expression, Expression]:
        return self.outer_diameter, self.inner_diameter

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return (f"{self.name}.inside",)

    def twist(self, value: Values) -> Row:
        del value
        return difference(*self.nodes)

    def mean_speed_rows(self, value: Values) -> tuple[Row, ...]:
        del value
        inside = self.internal_nodes[0]
        return difference(self.nodes[0], inside), difference(inside, self.nodes[1])

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        # k = G I_p/L and J = rho I_p L with the polar moment I_p of a ring
        polar = value.algebra.pi * (value(self.outer_diameter) ** 4 - value(self.inner_diameter) ** 4) / 32
        stiffness = value(self.shear_modulus) * polar / value(self.length)
        inertia = value(self.density) * polar * value(self.length)
        eta = self.loss_factor
        loss = eta.loss_factor(value.parameters, value.algebra) if isinstance(eta, DampingMeasure) else value(eta)
        (inside,) = self.internal_nodes
        parts: list[Part] = []
        pieces = ((self.nodes[0], inside, INNER_NODE_POSITION), (inside, self.nodes[1], 1 - INNER_NODE_POSITION))
        for number, (first, second, share) in enumerate(pieces, 1):
            numbers = stiffness / share, inertia * share, loss
            parts.append(Law(difference(first, second), table=ShaftTwist(*numbers, f"twist_{number}")))
            ends = [make_row([(node, 1)]) for node in (first, second)]
            parts += [Law(row, table=ShaftEnd(*numbers, f"end_{number}")) for row in ends if row]
        return tuple(parts)
