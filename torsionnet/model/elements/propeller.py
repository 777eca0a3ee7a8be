"""A ship's propeller: its inertia with the water it drags along, and what the water damps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.core.entries.scalars import PhysicalQuantity
from torsionnet.core.entries.spec import entry
from torsionnet.core.errors import Fault
from torsionnet.model.elements.element import Element, register
from torsionnet.model.elements.laws import Law, Part, Values, make_row
from torsionnet.model.elements.nodes import NodeName

_ARCHER = ("archer", "torque", "speed")


@register
@dataclass(frozen=True, eq=False, repr=False)
class Propeller(Element):
    """A ship's propeller with entrained water and damping.

    The inertia in water is J (1 + w), w the share of entrained water. The damping c acts between propeller and water,
    which stands for ground; it is given, or by Archer c = a Q/n with the mean torque Q in N m and the speed n in r/min
    of the propeller, so that c = a Q pi/(30 omega). Torque and speed may be parameters that follow the operating point;
    then c follows Q/n over speed. The factor a is mostly taken as 30 (S. Archer, Torsional vibration damping
    coefficients for marine propellers, Engineering, 1955).

    Examples
    --------
    >>> screw = Propeller("screw", node="prop", inertia="6200 kg*m^2", entrained_water="28 %",
    ...     archer=30, torque="188.7 kN*m", speed="151.8 rpm")
    >>> (law,) = screw.parts(Values({}))
    >>> float(law.inertia), round(float(law.damping))
    (7936.0, 37292)
    """

    kind: ClassVar[str] = "propeller"
    glyph: ClassVar[str] = "disc"
    sign: ClassVar[str] = "positive when the drivetrain drives the propeller in the positive sense"

    node: Any = entry(NodeName("the node it turns with", allow_ground=False))
    inertia: Any = entry(PhysicalQuantity("mass moment of inertia in air", "inertia", "J", usual=(1e-12, 1e10)))
    entrained_water: Any = entry(PhysicalQuantity("share that entrained water adds, as 25 %", "1", "w"), 0)
    damping: Any = entry(PhysicalQuantity("damping by the water", "damping", "c"), None)
    archer: Any = entry(PhysicalQuantity("instead: factor of Archer's formula, about 30", "1", "a"), None)
    torque: Any = entry(PhysicalQuantity("mean torque, for Archer's formula", "torque", "Q"), None)
    speed: Any = entry(
        PhysicalQuantity("speed of the propeller, for Archer's formula", "speed", "omega", exclusive=True), None
    )

    def contradictions(self) -> list[Fault]:
        given = [name for name in _ARCHER if getattr(self, name) is not None]
        if given and self.damping is not None:
            return [Fault("the damping is given or by Archer, not both", ("damping",), on_key=True)]
        if given and len(given) < len(_ARCHER):
            missing = " and ".join(name for name in _ARCHER if name not in given)
            return [Fault(f"damping by Archer needs archer, torque and speed; here is no {missing}", on_key=True)]
        return []

    def parts(self, value: Values) -> tuple[Part, ...]:
        row = make_row([(self.node, 1)])
        return (
            Law(row, inertia=value(self.inertia) * (1 + value(self.entrained_water)), damping=self._damping(value)),
        )

    def _damping(self, value: Values) -> Any:
        if self.archer is not None:
            return value(self.archer) * value(self.torque) * value.algebra.pi / (30 * value(self.speed))
        return 0 if self.damping is None else value(self.damping)
