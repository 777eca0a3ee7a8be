"""Torsional damper of leaf or sleeve springs between an inner star and an outer ring, with oil between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Expression, Rows
from torsionnet.model.damping import DampingMeasure, DampingQuantity
from torsionnet.model.element_base.curves import LookupCurve
from torsionnet.model.element_base.dynamic_stiffness import ScaledStiffness
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodeName
from torsionnet.model.element_base.frequency_curves import stiffness_from_curves
from torsionnet.model.element_base.laws import Law, Part, Values, difference, make_row


@register
@dataclass(frozen=True, eq=False, repr=False)
class SpringDamper(Element):
    """A torsional vibration damper of steel springs and oil: an inner star on the shaft, an outer ring on leaf springs.

    Springs k and oil act between star and ring. The oil that the springs displace through gaps damps with c; it is a
    constant, or a measure at a frequency, as {eta: 0.4, at: 25 Hz}. Makers state the hydrodynamic damping by
    eta(f) = c omega/k, the undimensioned damping factor, and the dynamic stiffness by k(f) over that at rest; both
    over frequency make the law k(f) (1 + j eta(f)), between the rows by powers of the frequency.

    Examples
    --------
    >>> damper = SpringDamper("damper", node="nose", ring_inertia="180 kg*m^2", stiffness="2.4 MN*m/rad",
    ...     loss_over_frequency={"10 Hz": 0.3, "40 Hz": 0.6}, stiffness_over_frequency={"10 Hz": 1.1, "40 Hz": 1.3})
    >>> import numpy as np
    >>> damper.parts(Values({}))[0].table.kappa(2 * np.pi * np.array([10.0, 40.0])).round()
    array([2640000. +792000.j, 3120000.+1872000.j])
    """

    kind: ClassVar[str] = "spring_damper"
    glyph: ClassVar[str] = "damper"
    sign: ClassVar[str] = "positive when the drivetrain drives the inner star in the positive sense"

    node: str = entry(NodeName("the node its inner star turns with", allow_ground=False))
    ring_inertia: Expression = entry(PhysicalQuantity("inertia of the outer ring", "inertia", "J_r", exclusive=True))
    stiffness: Expression = entry(PhysicalQuantity("stiffness of the springs", "stiffness", "k", exclusive=True))
    damping: Expression | DampingMeasure | None = entry(
        DampingQuantity("damping by the oil, or a measure at a frequency", "damping", "c"), None
    )
    loss_over_frequency: Rows = entry(
        LookupCurve("instead: c omega/k", "frequency", exclusive=True, shown="{10 Hz: 0.3, 40 Hz: 0.6}"),
        None,
    )
    stiffness_over_frequency: Rows = entry(
        LookupCurve("k(f) over the stiffness", "frequency", exclusive=True, shown="{10 Hz: 1.1, 40 Hz: 1.3}"), None
    )
    hub_inertia: Expression = entry(PhysicalQuantity("inertia of the inner star", "inertia", "J_h"), 0)

    def contradictions(self) -> list[Fault]:
        if self.loss_over_frequency and self.damping is not None:
            return [Fault("the damping is given, or over frequency, not both", ("damping",), on_key=True)]
        if self.stiffness_over_frequency and not self.loss_over_frequency:
            text = "a stiffness over frequency needs the damping over frequency, too: loss_over_frequency"
            return [Fault(text, ("stiffness_over_frequency",), on_key=True)]
        return []

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return (f"{self.name}.ring",)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        (ring,) = self.internal_nodes
        hub = Law(make_row([(self.node, 1)]), inertia=value(self.hub_inertia))
        inertia = Law(make_row([(ring, 1)]), inertia=value(self.ring_inertia))
        return (self._springs(ring, value), inertia, *([hub] if hub.acts else []))

    def _springs(self, ring: str, value: Values) -> Law:
        row = difference(self.node, ring)
        if self.loss_over_frequency:
            table = stiffness_from_curves(1.0, self.stiffness_over_frequency, self.loss_over_frequency, viscous=True)
            return Law(row, table=ScaledStiffness(table, value(self.stiffness)))
        stiffness = value(self.stiffness)
        return Law(row, damping=viscous(self.damping, stiffness, value), stiffness=stiffness)
