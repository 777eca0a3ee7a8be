"""Centrifugal pendulums on a shaft, tuned to an order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import Count, OneOf, entry
from torsionnet.base.expression_reading import scalar
from torsionnet.base.expressions import Expression
from torsionnet.model.element_base.element import Element, register
from torsionnet.model.element_base.element_entries import NodeName
from torsionnet.model.element_base.laws import Law, Part, Values, difference, make_row


@register
@dataclass(frozen=True, eq=False, repr=False)
class PendulumAbsorber(Element):
    r"""Pendulums in the centrifugal field of a shaft that turns at Omega: an absorber tuned to an order, at any speed.

    ``count`` masses m run on paths of radius r round points at R from the axis of the shaft. With theta the angle of
    the shaft and psi that of shaft and pendulum together, small motions at constant mean speed have the kinetic energy
    m (R dtheta/dt + r dpsi/dt)^2/2 and the restoring torque m R r Omega^2 (psi - theta). The mass swings at
    n = sqrt(R/r) periods a turn, and at that order its node stands still, whatever the speed and the inertia of the
    shaft. A mass hung at two points (bifilar) does not turn against the shaft; hung at one, it does, and its inertia J
    about its centre of mass makes n = sqrt(m R r/(m r^2 + J)).

    Circle, cycloid and epicycloid have the same law for small motions, r being the radius of curvature at the vertex.
    They differ in how the order follows the ``swing``, the length of path to one side over r: its square goes with
    1 - (1 - lambda^2 (1 + n^2)/n^2) swing^2/8, lambda 0 for a circle, 1 for a cycloid, n/sqrt(1 + n^2) for the
    epicycloid, which keeps its order (H. H. Denman, Tautochronic bifilar pendulum torsion absorbers for reciprocating
    engines, J. Sound Vib. 159 (1992) 251-277; here by harmonic balance to the square of the swing, of a shaft that
    turns evenly, n without J).

    Examples
    --------
    >>> pendulum = PendulumAbsorber("pendulum", node="crank", count=4, mass="0.4 kg", pivot_radius="80 mm",
    ...     path_radius="20 mm", speed="1500 rpm")
    >>> spring, masses, *_ = pendulum.parts(Values({}))
    >>> n = (spring.stiffness / masses.inertia) ** 0.5 / 0.02 / (1500 * 3.141592653589793 / 30)
    >>> round(n, 12)
    2.0
    """

    kind: ClassVar[str] = "pendulum_absorber"
    glyph: ClassVar[str] = "pendulum"
    sign: ClassVar[str] = "positive when the drivetrain drives the pendulums in the positive sense"

    node: str = entry(NodeName("the node it turns with", allow_ground=False))
    mass: Expression = entry(PhysicalQuantity("mass of one pendulum", "mass", "m", exclusive=True))
    pivot_radius: Expression = entry(
        PhysicalQuantity("from the axis of the shaft to the centre of the path", "length", "R", exclusive=True)
    )
    path_radius: Expression = entry(
        PhysicalQuantity("radius of the path of the centre of mass at its vertex", "length", "r", exclusive=True)
    )
    speed: Expression = entry(
        PhysicalQuantity("mean speed of the shaft, or a parameter that follows it", "speed", "Omega", exclusive=True)
    )
    count: int = entry(Count("how many pendulums, all alike and in phase", 1, 100), 1)
    own_inertia: Expression = entry(PhysicalQuantity("inertia of one mass about its centre of mass", "inertia", "J"), 0)
    suspension: str = entry(OneOf("whether the masses turn against the shaft", ("bifilar", "simple")), "bifilar")
    damping: Expression = entry(PhysicalQuantity("viscous damping between all masses and the shaft", "damping", "c"), 0)
    path: str = entry(OneOf("form of the path", ("circle", "cycloid", "epicycloid")), "circle")
    swing: Expression = entry(PhysicalQuantity("length of path to one side over r, as an angle", "angle", "alpha"), 0)

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return (f"{self.name}.mass",)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        (mass,) = self.internal_nodes
        count = value(scalar(self.count))
        total, own = count * value(self.mass), count * value(self.own_inertia)
        outer, inner = value(self.pivot_radius), value(self.path_radius)
        stiffness = total * outer * inner * value(self.speed) ** 2 * self._softening(outer / inner, value)
        field = Law(difference(self.node, mass), damping=value(self.damping), stiffness=stiffness)
        carried = Law(make_row([(self.node, outer), (mass, inner)]), inertia=total)
        turning = Law(make_row([(mass if self.suspension == "simple" else self.node, 1)]), inertia=own)
        return (field, carried, *([turning] if turning.acts else []))

    def _softening(self, squared_order: Any, value: Values) -> Any:
        """Dimensionless factor on the squared order of the pendulum by its swing; 1 for small swings."""
        squared = value(self.swing) ** 2 / 8
        if self.path == "epicycloid":
            return 1
        return 1 - squared if self.path == "circle" else 1 + squared / squared_order
