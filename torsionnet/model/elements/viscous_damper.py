"""Torsional vibration damper: a ring in a viscous film on a hub."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.core.damping import DampingMeasure
from torsionnet.core.entries.scalars import PhysicalQuantity
from torsionnet.core.entries.spec import entry
from torsionnet.core.errors import Fault
from torsionnet.core.expressions import Number
from torsionnet.model.elements.damping_entries import DampingQuantity
from torsionnet.model.elements.element import Element, register, viscous
from torsionnet.model.elements.laws import Law, Part, Row, Values, difference, make_row
from torsionnet.model.elements.nodes import NodeName


@register
@dataclass(frozen=True, eq=False, repr=False)
class ViscousDamper(Element):
    """A viscous torsional damper (Houde damper) on a shaft: a free ring in a film of silicone oil, in a hub.

    The ring, of inertia J_r, is dragged along by the film: J_r d2theta_r/dt2 = T_f, with T_f = c dgamma/dt + k gamma
    and gamma = theta - theta_r; the torque it takes from the shaft is J_h d2theta/dt2 + T_f. A film without stiffness
    (untuned) has its best damping on a mass on a spring, J and K, at c = 2 zeta J_r sqrt(K/J) with
    zeta = 1/sqrt(2 (1 + mu) (2 + mu)) and mu = J_r/J, J with the hub; then theta is at most (2 + mu)/mu times what the
    torque amplitude would turn the spring at rest (J. P. Den Hartog, Mechanical Vibrations, 4th ed., chapter 3).
    Silicone oils are stiff, too, and both values change with frequency and temperature: those here are constant.

    Examples
    --------
    >>> damper = ViscousDamper("damper", node="nose", ring_inertia="0.12 kg*m^2", damping="60 N*m*s/rad")
    >>> damper.internal_nodes
    ('damper.ring',)
    """

    kind: ClassVar[str] = "viscous_damper"
    glyph: ClassVar[str] = "damper"
    sign: ClassVar[str] = "positive when the drivetrain drives the hub in the positive sense"

    node: Any = entry(NodeName("the node its hub turns with", allow_ground=False))
    ring_inertia: Any = entry(PhysicalQuantity("inertia of the ring", "inertia", "J_r", exclusive=True))
    damping: Any = entry(DampingQuantity("viscous damping of the film, or a measure of its damping", "damping", "c"))
    stiffness: Any = entry(PhysicalQuantity("stiffness of the film", "stiffness", "k"), 0)
    hub_inertia: Any = entry(PhysicalQuantity("inertia of hub and casing", "inertia", "J_h"), 0)

    def contradictions(self) -> list[Fault]:
        if isinstance(self.damping, DampingMeasure) and self.damping.measure != "c" and self.stiffness == Number(0):
            return [Fault("a measure of damping needs a film with stiffness; give damping in N*m*s/rad", ("damping",))]
        return []

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return (f"{self.name}.ring",)

    def parts(self, value: Values) -> tuple[Part, ...]:
        (ring,) = self.internal_nodes
        stiffness = value(self.stiffness)
        film = Law(difference(self.node, ring), damping=viscous(self.damping, stiffness, value), stiffness=stiffness)
        hub = Law(make_row([(self.node, 1)]), inertia=value(self.hub_inertia))
        return (film, Law(make_row([(ring, 1)]), inertia=value(self.ring_inertia)), *([hub] if hub.acts else []))

    def holds(self, value: Values) -> tuple[Row, ...]:
        """The ring turns with the hub on average, whatever the film."""
        return (self.twist(value),)
