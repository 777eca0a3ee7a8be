"""Vehicle as a mass driven by its wheels, and tyres with slip on the road."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.composite import one_exactly
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import OneOf, entry
from torsionnet.base.errors import Fault
from torsionnet.base.expression_reading import scalar
from torsionnet.base.expressions import Expression
from torsionnet.model.damping import DampingMeasure, DampingQuantity
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodeName, NodePair
from torsionnet.model.element_base.laws import Constraint, Law, Part, Row, Values, difference, make_row

# Vehicle as a mass driven by its wheels, damped by air drag and rolling resistance.

GRAVITY = "9.80665"
"""Standard acceleration of gravity in m/s^2, with which the weight of a vehicle makes rolling resistance."""


@register
@dataclass(frozen=True, eq=False, repr=False)
class Vehicle(Element):
    """A vehicle of mass m on wheels of rolling radius r: inertia m r^2 + J_w on the node that turns with the wheels.

    Air drag F = rho A_d v^2 / 2 with the drag area A_d = c_w A, and a rolling resistance F = m g (f_0 + f_1 v), make a
    damping at the speed v: c = r^2 dF/dv = r^2 (rho A_d v + m g f_1). Constant parts, as f_0 or a gradient, only load
    the drivetrain in the mean (M. Mitschke, H. Wallentowitz, Dynamik der Kraftfahrzeuge).
    The speed may be a parameter that follows the operating point, as v = n*r with n {by: speed, of: hub}.

    Examples
    --------
    >>> car = Vehicle("car", node="road", mass="1500 kg", wheel_radius="0.3 m", speed="20 m/s", drag_area="0.6 m^2")
    >>> (law,) = car.parts(Values({}))
    >>> float(law.inertia), round(float(law.damping), 4)
    (135.0, 1.3003)
    """

    kind: ClassVar[str] = "vehicle"
    glyph: ClassVar[str] = "disc"
    sign: ClassVar[str] = "positive when the drivetrain drives the vehicle in the positive sense"

    node: str = entry(NodeName("the node that turns with the wheels, behind the tyres", allow_ground=False))
    mass: Expression = entry(PhysicalQuantity("mass of the vehicle", "mass", "m", exclusive=True, usual=(1, 1e7)))
    wheel_radius: Expression = entry(
        PhysicalQuantity("rolling radius of the wheels", "length", "r", exclusive=True, usual=(0.02, 3))
    )
    wheel_inertia: Expression = entry(
        PhysicalQuantity("inertia of wheels that no drive shaft turns", "inertia", "J_w"), 0
    )
    speed: Expression | None = entry(PhysicalQuantity("speed of the vehicle, for what damps", "velocity", "v"), None)
    drag_area: Expression | None = entry(PhysicalQuantity("drag coefficient times frontal area", "area", "A_d"), None)
    air_density: Expression = entry(PhysicalQuantity("density of the air", "density", "rho"), "1.204 kg/m^3")
    rolling_slope: Expression = entry(
        PhysicalQuantity("growth of the rolling resistance coefficient with speed", "per velocity", "f_1"), 0
    )

    def contradictions(self) -> list[Fault]:
        if self.drag_area is not None and self.speed is None:
            return [
                Fault("air drag damps by the speed; give speed too, as 100 km/h", ("drag_area",), kind="missing-entry")
            ]
        if self.drag_area is None and self.speed is not None:
            return [
                Fault(
                    "the speed counts for air drag only; give drag_area, as 0.65 m^2, too",
                    ("speed",),
                    kind="needless-entry",
                )
            ]
        return []

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        mass, radius = value(self.mass), value(self.wheel_radius)
        # dF/dv at the speed v: m g f_1 of the tyres' rolling, and rho A_d v of the drag rho A_d v^2 / 2.
        slope = mass * value(scalar(GRAVITY)) * value(self.rolling_slope)
        if self.drag_area is not None:
            slope += value(self.air_density) * value(self.drag_area) * value(self.speed)
        # v = r omega: the mass m is an inertia m r^2 at the wheels, and dF/dv a damping r^2 dF/dv.
        inertia = mass * radius**2 + value(self.wheel_inertia)
        return (Law(make_row([(self.node, 1)]), inertia=inertia, damping=slope * radius**2),)


# Tyre with its torsional stiffness in series with the slip on the road.


@register
@dataclass(frozen=True, eq=False, repr=False)
class Tyre(Element):
    """A tyre between rim and road: carcass and sidewall as a spring, and longitudinal slip as a damper behind it.

    At the speed v a slip of 1 makes the force C, so that the torque T = C r^2 (omega_rim - omega_road) / v is that of a
    damper c = C r^2 / v. In series with the stiffness k the torque follows the slip with a first-order lag:
    sigma/v dT/dt + T = c (omega_rim - omega_road), with the relaxation length sigma = C r^2 / k (H. B. Pacejka, Tire
    and Vehicle Dynamics, 3rd ed., chapter 7). Standing on the road, without slip, only the spring is left. The belt is
    the node ``NAME.belt``; it may have an inertia of its own. The node of the road turns with the vehicle, v / r.

    Examples
    --------
    >>> tyre = Tyre("tyre", nodes=("hub", "road"), radius="0.3 m", slip_stiffness="80 kN", relaxation_length="0.4 m",
    ...     speed="20 m/s")
    >>> spring, slip = tyre.parts(Values({}))
    >>> float(spring.stiffness), float(slip.damping)
    (18000.0, 360.0)
    """

    kind: ClassVar[str] = "tyre"
    glyph: ClassVar[str] = "spring"

    nodes: tuple[str, str] = entry(NodePair("rim and road; twist is the angle of the first minus the second"))
    state: str = entry(OneOf("whether it rolls, with slip, or stands without", ("rolling", "standing")), "rolling")
    radius: Expression | None = entry(
        PhysicalQuantity("rolling radius", "length", "r", exclusive=True, usual=(0.02, 3)), None
    )
    slip_stiffness: Expression | None = entry(
        PhysicalQuantity("longitudinal force per slip", "force", "C", exclusive=True, usual=(500, 1e8)), None
    )
    speed: Expression | None = entry(PhysicalQuantity("speed on the road", "velocity", "v", exclusive=True), None)
    stiffness: Expression | None = entry(
        PhysicalQuantity("torsional stiffness of rim against road", "stiffness", "k", exclusive=True), None
    )
    relaxation_length: Expression | None = entry(
        PhysicalQuantity("instead of the stiffness: relaxation length", "length", "sigma", exclusive=True), None
    )
    damping: Expression | DampingMeasure = entry(
        DampingQuantity("viscous damping in parallel to the stiffness", "damping", "d"), 0
    )
    belt_inertia: Expression = entry(PhysicalQuantity("inertia of belt and tread", "inertia", "J_b"), 0)

    def contradictions(self) -> list[Fault]:
        wrong = one_exactly(self, "stiffness", "relaxation_length")
        if wrong:
            return wrong
        needed = ["radius", "slip_stiffness", "speed"] if self.state == "rolling" else []
        if self.relaxation_length is not None:
            needed = needed or ["radius", "slip_stiffness"]
        missing = [name for name in needed if getattr(self, name) is None]
        if not missing:
            return []
        why = "a rolling tyre" if self.state == "rolling" else "a stiffness by the relaxation length"
        hint = "; one that stands still has state: standing" if self.state == "rolling" else ""
        return [
            Fault(
                f"{why} needs {', '.join(needed)}; here is no {' and no '.join(missing)}{hint}",
                on_key=True,
                kind="missing-entry",
            )
        ]

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return (f"{self.name}.belt",)

    def twist(self, value: Values) -> Row:
        del value
        return difference(*self.nodes)

    def mean_speed_rows(self, value: Values) -> tuple[Row, ...]:
        """Rows of node speeds that tie rim, belt and road to one mean speed.

        The slip of a driven tyre is a few percent at most.
        """
        return tuple(part.row for part in self.parts(value)[:2])

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        (rim, road), (belt,) = self.nodes, self.internal_nodes
        # Spring to the belt and slip behind it are in series: the torque follows the slip with the lag sigma/v.
        stiffness = self._stiffness(value)
        spring = Law(difference(rim, belt), stiffness=stiffness, damping=viscous(self.damping, stiffness, value))
        body = Law(make_row([(belt, 1)]), inertia=value(self.belt_inertia))
        return (spring, self._contact(difference(belt, road), value), *([body] if body.acts else []))

    def _contact(self, row: Row, value: Values) -> Part:
        if self.state == "standing":
            return Constraint(row)
        return Law(row, damping=value(self.slip_stiffness) * value(self.radius) ** 2 / value(self.speed))

    def _stiffness(self, value: Values) -> Any:
        if self.stiffness is not None:
            return value(self.stiffness)
        return value(self.slip_stiffness) * value(self.radius) ** 2 / value(self.relaxation_length)
