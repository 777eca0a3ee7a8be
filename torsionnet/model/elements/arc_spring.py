"""Arc springs that rub in a curved channel, as an element without masses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry
from torsionnet.base.expressions import Expression
from torsionnet.model.arc_spring.linear_law import arc_stiffness, arc_values
from torsionnet.model.damping import DampingMeasure, DampingQuantity
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodePair
from torsionnet.model.element_base.laws import Law, Part, Values, difference
from torsionnet.model.elements.masses_and_springs import NODE_PAIR_DESCRIPTION


@register
@dataclass(frozen=True, eq=False, repr=False)
class ArcSpring(Element):
    r"""Arc springs in a curved channel, which rub under their centrifugal force and the spring force turned with them.

    With C = m r^2 Omega^2, u = T + C/psi and e = mu psi the torque falls along sliding coils as du/ds = -e u over the
    share s of the arc. A swing of amplitude a about a mean torque moves the coils to a depth z and locks those beyond.
    Linear results take the first harmonic of the slow loop at the amplitude ``swing``, k' + j k'': while coils are
    locked k''/k' = 1/2, and the secant stiffness is k_s = 3 pi/8 k', its loss factor 4/(3 pi). Both fall with the
    root of the swing and rise with mean torque and speed. Where the flange leaves the springs in a cycle, a chain of
    segments with Coulomb's friction is marched instead.

    ``torque`` and ``speed`` follow the operating point as parameters ``by: mean_torque`` and ``by: speed``; ``swing``
    follows the vibration as one ``by: vibratory_torque`` with a table. Loops are slow, far below sqrt(k/J)/2 in Hz with
    J = m r^2, the first frequency of coils without friction: at a third of it k' is some 6 % below. Over time, beside
    other laws of motion or from a given start, a chain of segments without mass has this friction, as many as give the
    loss of a cycle of ``swing`` about ``torque`` to 1 %.

    Examples
    --------
    >>> arcs = ArcSpring("arcs", nodes=("a", "b"), stiffness=700, arc_angle=2.6, friction_coefficient=0.12,
    ...     spring_mass=0.9, spring_radius="110 mm", speed="3000 rpm", torque="276.2278 N*m", swing="2 deg")
    >>> (law,) = arcs.parts(Values({}))
    >>> round(law.stiffness, 2), round(law.loss_factor, 4)
    (2490.37, 0.5)
    """

    kind: ClassVar[str] = "arc_spring"
    glyph: ClassVar[str] = "spring"
    working_point: ClassVar[tuple[str, ...]] = ("torque", "swing")

    nodes: tuple[str, str] = entry(NodePair(NODE_PAIR_DESCRIPTION))
    stiffness: Expression = entry(
        PhysicalQuantity("stiffness of all arc springs without friction", "stiffness", "k", exclusive=True)
    )
    arc_angle: Expression = entry(PhysicalQuantity("angle on which a spring lies", "angle", "psi", exclusive=True))
    friction_coefficient: Expression = entry(PhysicalQuantity("between springs and channel", "1", "mu"))
    spring_mass: Expression = entry(PhysicalQuantity("mass of all arc springs", "mass", "m"))
    spring_radius: Expression = entry(PhysicalQuantity("radius on which they lie", "length", "r"))
    speed: Expression = entry(PhysicalQuantity("speed that presses them outward", "speed", "Omega", None))
    torque: Expression = entry(PhysicalQuantity("mean torque about which they swing", "torque", "T", None))
    swing: Expression = entry(PhysicalQuantity("amplitude of the twist", "angle", "alpha", exclusive=True))
    damping: Expression | DampingMeasure = entry(DampingQuantity("viscous damping in parallel", "damping", "c"), 0)

    @property
    def over_time(self) -> Self:
        from torsionnet.model.arc_spring.arc_curve import LawsOverTime  # of motion alone

        return self.with_laws(LawsOverTime(self)) if self.other_laws is None else super().over_time

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        stiffness, eta = arc_stiffness(value.algebra, *(value(number) for number in arc_values(self)))
        damping = viscous(self.damping, stiffness, value)
        return (Law(difference(*self.nodes), damping=damping, stiffness=stiffness, loss_factor=eta),)
