"""Synchronous generator on a grid, by its data in per unit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.composite import superfluous
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Expression, Number
from torsionnet.model.element_base.element import Element, register
from torsionnet.model.element_base.element_entries import NodeName
from torsionnet.model.element_base.laws import Law, Part, Row, Values, difference, make_row

_BEHIND_A_REACTANCE = ("emf", "grid_voltage", "reactance", "power")
POLE_PAIRS_RTOL = 0.01
"""Relative distance of the pole pairs from a whole number that is allowed, as line frequencies are rounded: 377 rad/s
for 60 Hz."""


@register
@dataclass(frozen=True, eq=False, repr=False)
class GridGenerator(Element):
    """A synchronous generator on a grid, by inertia constant and coefficients in per unit, as in power system studies.

    With rated power S, speed omega and line frequency omega_0 = 2 pi f its mechanical values are

        J = 2 H S/omega^2,    k = K_s S omega_0/omega^2,    c = K_D S/omega^2,

    H the inertia constant, K_s the synchronising torque over the electrical angle and K_D the damping torque over the
    change of speed, both per unit. Alone on an infinite bus (the grid is ground) it swings at
    f_n = sqrt(K_s omega_0/(2 H))/(2 pi) with the damping ratio K_D/(2 sqrt(2 H K_s omega_0)) (P. Kundur, Power System
    Stability and Control, chapter 12). Instead of K_s: K_s = sqrt((E V/X)^2 - P^2), which is E V cos(delta)/X, of the
    voltage E behind the reactance X to a bus of voltage V at the power P, all per unit. It stays linear in time;
    a synchronous machine with its pull-out torque follows the sine of the load angle.

    Examples
    --------
    >>> generator = GridGenerator("generator", node="rotor", rated_power="555 MW", speed="3600 rpm",
    ...     grid_frequency="60 Hz", inertia_constant="3.5 s", synchronising_coefficient=0.757)
    >>> field, rotor = generator.parts(Values({}))
    >>> round((float(field.stiffness) / float(rotor.inertia)) ** 0.5 / 6.283185307, 4)
    1.0162
    """

    kind: ClassVar[str] = "grid_generator"
    glyph: ClassVar[str] = "machine"
    sign: ClassVar[str] = "positive when the drivetrain drives the rotor in the positive sense"
    working_point: ClassVar[tuple[str, ...]] = ("power",)

    node: str = entry(NodeName("the node of the rotor", allow_ground=False))
    rated_power: Expression = entry(PhysicalQuantity("power that is 1 per unit", "power", "S", exclusive=True))
    speed: Expression = entry(PhysicalQuantity("synchronous speed of the rotor", "speed", "Omega", exclusive=True))
    grid_frequency: Expression = entry(PhysicalQuantity("frequency of the line", "frequency", "f", exclusive=True))
    inertia_constant: Expression = entry(
        PhysicalQuantity("stored energy over rated power, of all masses that stand for it", "time", "H")
    )
    synchronising_coefficient: Expression | None = entry(
        PhysicalQuantity("synchronising torque per electrical rad, per unit", "1", "K_s", exclusive=True), None
    )
    emf: Expression | None = entry(
        PhysicalQuantity("instead: voltage behind the reactance, per unit", "1", "E", exclusive=True), None
    )
    grid_voltage: Expression | None = entry(
        PhysicalQuantity("voltage of the bus, per unit", "1", "V", exclusive=True), None
    )
    reactance: Expression | None = entry(
        PhysicalQuantity("reactance from E to V, per unit", "1", "X", exclusive=True), None
    )
    power: Expression | None = entry(PhysicalQuantity("power it gives, per unit", "1", "P"), None)
    damping_coefficient: Expression = entry(
        PhysicalQuantity("damping torque per change of speed, both per unit", "1", "K_D"), 0
    )
    grid: str = entry(NodeName("the grid: ground is an infinite bus; else a node that turns at its speed"), "ground")

    def contradictions(self) -> list[Fault]:
        if self.node == self.grid:
            return [Fault("generator and grid are on one node; give two different nodes", ("grid",))]
        given = [name for name in _BEHIND_A_REACTANCE if getattr(self, name) is not None]
        if self.synchronising_coefficient is not None and given:
            return [superfluous("the synchronising coefficient is given", given[0])]
        if self.synchronising_coefficient is None and len(given) < len(_BEHIND_A_REACTANCE):
            wanted = " and ".join([", ".join(_BEHIND_A_REACTANCE[:-1]), _BEHIND_A_REACTANCE[-1]])
            return [Fault(f"a generator on a grid needs synchronising_coefficient, or {wanted}", on_key=True)]
        return [*self._speed_faults(), *self._power_faults()]

    def _speed_faults(self) -> list[Fault]:
        frequency, speed = self.grid_frequency, self.speed
        if not (isinstance(frequency, Number) and isinstance(speed, Number) and speed.value > 0):
            return []
        pairs = 2 * math.pi * float(frequency.value) / float(speed.value)
        if pairs > 1 - POLE_PAIRS_RTOL and abs(pairs - round(pairs)) < POLE_PAIRS_RTOL * pairs:
            return []
        near = 60 * float(frequency.value) / max(round(pairs), 1)
        return [Fault(f"no synchronous speed at {frequency}; the nearest is {near:g} rpm", ("speed",))]

    def _power_faults(self) -> list[Fault]:
        data = [getattr(self, name) for name in _BEHIND_A_REACTANCE]
        if not all(isinstance(one, Number) for one in data):
            return []
        emf, voltage, reactance, power = (float(one.value) for one in data)
        if reactance <= 0 or power < emf * voltage / reactance:
            return []
        return [
            Fault(
                f"power must be below emf*grid_voltage/reactance = {emf * voltage / reactance:.4g} per unit", ("power",)
            )
        ]

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        unit = value(self.rated_power) / value(self.speed) ** 2
        line = 2 * value.algebra.pi * value(self.grid_frequency)
        stiffness, damping = self._coefficient(value) * unit * line, value(self.damping_coefficient) * unit
        field = Law(difference(self.node, self.grid), damping=damping, stiffness=stiffness)
        return (field, Law(make_row([(self.node, 1)]), inertia=2 * value(self.inertia_constant) * unit))

    def mean_speed_rows(self, value: Values) -> tuple[Row, ...]:
        """Tuple of at most one row of node speeds, which couples the rotor to the grid on average.

        Ground stands for the steadily turning field.
        """
        return () if self.grid == "ground" else (self.twist(value),)

    def _coefficient(self, value: Values) -> Any:
        if self.synchronising_coefficient is not None:
            return value(self.synchronising_coefficient)
        most = value(self.emf) * value(self.grid_voltage) / value(self.reactance)
        return value.root(most**2 - value(self.power) ** 2, "the power must not be above E V/X")
