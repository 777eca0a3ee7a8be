"""Vehicle as a mass driven by its wheels, damped by air drag and rolling resistance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import Fault
from torsionnet.base.expression_reading import scalar
from torsionnet.base.expressions import Expression
from torsionnet.model.element_base.element import Element, register
from torsionnet.model.element_base.element_entries import NodeName
from torsionnet.model.element_base.laws import Law, Part, Values, make_row

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
            return [Fault("air drag damps by the speed; give speed too, as 100 km/h", ("drag_area",))]
        if self.drag_area is None and self.speed is not None:
            return [Fault("the speed counts for air drag only; give drag_area, as 0.65 m^2, too", ("speed",))]
        return []

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        mass, radius = value(self.mass), value(self.wheel_radius)
        slope = mass * value(scalar(GRAVITY)) * value(self.rolling_slope)
        if self.drag_area is not None:
            slope += value(self.air_density) * value(self.drag_area) * value(self.speed)
        inertia = mass * radius**2 + value(self.wheel_inertia)
        return (Law(make_row([(self.node, 1)]), inertia=inertia, damping=slope * radius**2),)
