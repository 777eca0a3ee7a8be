"""Tuned torsional damper: a ring on rubber on a hub."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.composite import one_at_most, one_exactly
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Expression
from torsionnet.model.damping import DampingMeasure, DampingQuantity, LossFactor, loss_factor
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodeName
from torsionnet.model.element_base.laws import Law, Part, Values, difference, make_row

_DAMPING = ("damping_ratio", "damping", "loss_factor")


@register
@dataclass(frozen=True, eq=False, repr=False)
class TunedDamper(Element):
    """A tuned torsional damper: a ring on an elastic and damping layer, mostly of rubber, on a hub.

    Its spring k is given, or by the natural frequency f_r of the ring on the hub held fast, k = J_r (2 pi f_r)^2. Its
    damping is a loss factor, k (1 + j eta), which suits rubber; or viscous, c itself or by the damping ratio of the
    ring on the hub held fast, c = 2 zeta sqrt(k J_r). On a mass on a spring, J with the hub and K, mu = J_r/J, the best
    viscous damper has f_r = sqrt(K/J)/(2 pi (1 + mu)) and zeta = sqrt(3 mu/(8 (1 + mu))); then theta is about
    sqrt(1 + 2/mu) times what the torque amplitude would turn the spring at rest (J. P. Den Hartog, Mechanical
    Vibrations, 4th ed., chapter 3).

    Examples
    --------
    >>> from math import pi, sqrt
    >>> J, K, mu = 2.0, 8e4, 0.1
    >>> best = TunedDamper("damper", node="nose", ring_inertia=mu * J,
    ...     natural_frequency=sqrt(K / J) / (1 + mu) / (2 * pi), damping_ratio=sqrt(3 * mu / (8 * (1 + mu))))
    >>> layer, ring = best.parts(Values({}))
    >>> round(layer.stiffness, 3), round(layer.damping, 6)
    (6611.57, 13.428163)
    """

    kind: ClassVar[str] = "tuned_damper"
    glyph: ClassVar[str] = "damper"
    sign: ClassVar[str] = "positive when the drivetrain drives the hub in the positive sense"

    node: str = entry(NodeName("the node its hub turns with", allow_ground=False))
    ring_inertia: Expression = entry(PhysicalQuantity("inertia of the ring", "inertia", "J_r", exclusive=True))
    stiffness: Expression | None = entry(
        PhysicalQuantity("stiffness of the layer", "stiffness", "k", exclusive=True), None
    )
    natural_frequency: Expression | None = entry(
        PhysicalQuantity("instead: natural frequency of the ring, hub held fast", "frequency", "f_r", exclusive=True),
        None,
    )
    loss_factor: Expression | DampingMeasure | None = entry(
        LossFactor("loss factor of the layer, or another measure of it", "1", "eta"), None
    )
    damping_ratio: Expression | None = entry(
        PhysicalQuantity("instead: damping ratio of the ring, hub held fast", "1", "zeta"), None
    )
    damping: Expression | DampingMeasure | None = entry(
        DampingQuantity("instead: viscous damping, or a measure at a frequency", "damping", "c"), None
    )
    hub_inertia: Expression = entry(PhysicalQuantity("inertia of the hub", "inertia", "J_h"), 0)

    def contradictions(self) -> list[Fault]:
        return one_exactly(self, "stiffness", "natural_frequency") + one_at_most(self, *_DAMPING, of="the damping")

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return (f"{self.name}.ring",)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        (ring,) = self.internal_nodes
        inertia, stiffness = value(self.ring_inertia), self._stiffness(value)
        damping = viscous(self.damping, stiffness, value)
        if self.damping_ratio is not None:
            damping = 2 * value(self.damping_ratio) * value.root(stiffness * inertia, "k J_r must not be negative")
        eta = loss_factor(self.loss_factor, value.parameters, value.algebra)
        layer = Law(difference(self.node, ring), damping=damping, stiffness=stiffness, loss_factor=eta)
        hub = Law(make_row([(self.node, 1)]), inertia=value(self.hub_inertia))
        return (layer, Law(make_row([(ring, 1)]), inertia=inertia), *([hub] if hub.acts else []))

    def _stiffness(self, value: Values) -> Any:
        if self.stiffness is not None:
            return value(self.stiffness)
        return value(self.ring_inertia) * (2 * value.algebra.pi * value(self.natural_frequency)) ** 2
