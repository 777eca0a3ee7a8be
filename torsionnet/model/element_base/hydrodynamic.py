"""Base of fluid couplings and torque converters, with pump torque over speed ratio, linearised."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.core.entries.number_table import RowColumn
from torsionnet.core.entries.scalars import PhysicalQuantity
from torsionnet.core.entries.spec import Spec, entry
from torsionnet.core.errors import Fault, Path
from torsionnet.core.expressions import Expression, Number
from torsionnet.core.piecewise_linear import Rows, outside_message, slope_at, value_at
from torsionnet.model.element_base.characteristic import Characteristic
from torsionnet.model.element_base.curves import with_curve_ranges
from torsionnet.model.element_base.element import Element
from torsionnet.model.element_base.laws import GROUND, Action, Law, Part, Row, Values, difference, make_row
from torsionnet.model.element_base.nodes import NodeName

SPEED_RATIO_COLUMN = RowColumn("speed ratio")
"""Specification of the first column in tables over the speed ratio of a fluid coupling or torque converter."""
_FORMS = {"pump_torque": ("test_speed",), "performance": ("diameter",), "k_factor": ()}


@dataclass(frozen=True, eq=False, repr=False)
class Hydrodynamic(Element):
    """Base class of fluid couplings and torque converters.

    Pump torque T_p = C(nu) omega_p^2 with nu = omega_t / omega_p.
    """

    glyph: ClassVar[str] = "hydrodynamic"
    sign: ClassVar[str] = "positive when the drivetrain drives the pump in the positive sense"
    may_feed: ClassVar[bool] = True
    more_tables: ClassVar[tuple[str, ...]] = ()
    """Names of the entries with further tables over the speed ratio."""

    pump: str = entry(NodeName("the node of the pump", allow_ground=False))
    turbine: str = entry(NodeName("the node of the turbine", allow_ground=False))
    speed: Expression = entry(
        PhysicalQuantity("speed of the pump at the operating point", "speed", "omega_p", exclusive=True)
    )
    speed_ratio: Expression = entry(
        PhysicalQuantity("speed of the turbine over that of the pump at the operating point", "1", "nu")
    )
    pump_torque: Rows | None = entry(
        Characteristic(
            "rows [speed ratio, pump torque at test_speed]", (SPEED_RATIO_COLUMN, RowColumn("torque", "torque"))
        ),
        None,
    )
    test_speed: Expression | None = entry(
        PhysicalQuantity("speed of the pump that pump_torque was measured at", "speed", "omega_0", exclusive=True), None
    )
    performance: Rows | None = entry(
        Characteristic(
            "instead: rows [speed ratio, performance coefficient lambda]", (SPEED_RATIO_COLUMN, RowColumn("lambda"))
        ),
        None,
    )
    diameter: Expression | None = entry(
        PhysicalQuantity("diameter of the circuit, for performance", "length", "D", exclusive=True), None
    )
    density: Expression = entry(PhysicalQuantity("density of the oil, for performance", "density", "rho"), "840 kg/m^3")
    k_factor: Rows | None = entry(
        Characteristic(
            "instead: rows [speed ratio, K factor in (r/min)/sqrt(N*m)]", (SPEED_RATIO_COLUMN, RowColumn("K"))
        ),
        None,
    )
    pump_inertia: Expression = entry(PhysicalQuantity("inertia of the pump with its oil", "inertia", "J_p"), 0)
    turbine_inertia: Expression = entry(PhysicalQuantity("inertia of the turbine with its oil", "inertia", "J_t"), 0)
    housing: str = entry(NodeName("the node against which both turn, and that carries a stator"), GROUND)

    def contradictions(self) -> list[Fault]:
        if len({self.pump, self.turbine, self.housing}) < 3:
            return [Fault("pump, turbine and housing must be on different nodes", ("turbine",))]
        given = [form for form in _FORMS if getattr(self, form) is not None]
        if len(given) != 1:
            text = "give the capacity once: pump_torque with test_speed, performance with diameter, or k_factor"
            return [Fault(text, tuple(given[1:2]))]
        missing = [name for name in _FORMS[given[0]] if getattr(self, name) is None]
        if missing:
            return [Fault(f"{given[0]} needs {missing[0]}", (given[0],), on_key=True)]
        if any(row[1].value < 0 or (given[0] == "k_factor" and row[1].value == 0) for row in getattr(self, given[0])):
            return [Fault("a capacity must not be negative, and a K factor must be above zero", (given[0],))]
        return [fault for name in (given[0], *self.more_tables) for fault in self._uncovered(name)]

    def _uncovered(self, name: str) -> list[Fault]:
        if not isinstance(self.speed_ratio, Number):
            return []
        text = outside_message(getattr(self, name), self.speed_ratio.value)
        given = float(self.speed_ratio.value)
        return [Fault(f"{text} in {name}; speed_ratio is {given:g}", ("speed_ratio",))] if text else []

    def expressions(self) -> Iterator[tuple[Path, Spec[object], Expression, str]]:
        """Path, specification, expression and dimension of every expression in the element's entries.

        The speed ratio has to lie within every table over it.
        """
        tables = [self._capacity_table, *(getattr(self, name) for name in self.more_tables)]
        first, last = max((table[0] for table in tables), key=_ratio), min((table[-1] for table in tables), key=_ratio)
        yield from with_curve_ranges(super().expressions(), {"speed_ratio": ((first, last), 1)})

    @property
    def _capacity_table(self) -> Rows:
        table: Rows = next(getattr(self, form) for form in _FORMS if getattr(self, form) is not None)
        return table

    def torque_ratio_at(self, value: Values) -> tuple[Any, Any]:
        """Ratio of turbine torque to pump torque, and the slope of that ratio over the speed ratio."""
        del value
        return 1, 0

    def twist(self, value: Values) -> Row:
        del value
        return difference(self.pump, self.turbine)

    def mean_speed_rows(self, value: Values) -> tuple[Row, ...]:
        """Tuple of one row of node speeds, which couples pump and turbine at the speed ratio of the operating point."""
        ratio = value(self.speed_ratio)
        return (make_row([(self.turbine, 1), (self.pump, -ratio), (self.housing, ratio - 1)]),)

    def parts(self, value: Values) -> tuple[Part, ...]:
        speed, ratio = value(self.speed), value(self.speed_ratio)
        (capacity, slope), (gain, gain_slope) = self.capacity(value), self.torque_ratio_at(value)
        by_pump, by_turbine = speed * (2 * capacity - ratio * slope), speed * slope
        pump, turbine = (difference(node, self.housing) for node in (self.pump, self.turbine))
        parts: list[Law | Action] = [
            Law(difference(self.pump, self.turbine), damping=-by_turbine),
            Action(difference(self.turbine, self.pump), pump, (0, by_pump + by_turbine)),
        ]
        # What the turbine has beyond the torque of the pump comes from the stator.
        surplus, rise = (gain - 1) * capacity, (gain - 1) * slope + gain_slope * capacity
        parts += [
            Law(turbine, damping=-speed * rise),
            Action(turbine, pump, (0, speed * (2 * surplus - ratio * rise))),
            Law(make_row([(self.pump, 1)]), inertia=value(self.pump_inertia)),
            Law(make_row([(self.turbine, 1)]), inertia=value(self.turbine_inertia)),
        ]
        return (parts[0], *(part for part in parts[1:] if part.acts))

    def capacity(self, value: Values) -> tuple[Any, Any]:
        """Capacity C = T_p / omega_p^2 in N m s^2/rad^2 at the speed ratio, and its slope over the speed ratio."""
        table, ratio = self._capacity_table, value(self.speed_ratio)
        level, slope = value_at(table, ratio), value.algebra.number(slope_at(table, ratio))
        if self.k_factor is not None:
            per_minute = 900 / value.algebra.pi**2
            return per_minute / level**2, -2 * per_minute * slope / level**3
        if self.performance is not None:
            factor = value(self.density) * value(self.diameter) ** 5
        else:
            factor = 1 / value(self.test_speed) ** 2
        return factor * level, factor * slope


def _ratio(row: tuple[Number, ...]) -> Any:
    return row[0].value
