"""Base of fluid couplings and torque converters, with pump torque over speed ratio."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.scalars import PhysicalQuantity, RowColumn
from torsionnet.base.entries.spec import Spec, entry
from torsionnet.base.errors import EntryPath, Fault
from torsionnet.base.expressions import Expression, Number, Rows, outside_message
from torsionnet.model.element_base.characteristic import Characteristic
from torsionnet.model.element_base.curves import with_curve_ranges
from torsionnet.model.element_base.element import Element
from torsionnet.model.element_base.element_entries import NodeName
from torsionnet.model.element_base.hydrodynamic_curve import Capacity, CouplingCurve, Gain, StatorCurve
from torsionnet.model.element_base.laws import (
    GROUND,
    Action,
    Law,
    MotionLaw,
    MotionState,
    Part,
    Row,
    Values,
    WholePart,
    difference,
    make_row,
)

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
    working_point: ClassVar[tuple[str, ...]] = ("speed", "speed_ratio")
    more_tables: ClassVar[tuple[str, ...]] = ()
    """Names of the entries with further tables over the speed ratio."""

    pump: str = entry(NodeName("the node of the pump", allow_ground=False))
    turbine: str = entry(NodeName("the node of the turbine", allow_ground=False))
    speed: Expression | None = entry(
        PhysicalQuantity(
            "speed of the pump at the operating point; default: as that says", "speed", "omega_p", exclusive=True
        ),
        None,
    )
    speed_ratio: Expression | None = entry(
        PhysicalQuantity("speed of the turbine over that of the pump at the operating point", "1", "nu"), None
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
        if (self.speed is None) != (self.speed_ratio is None):
            given, missing = ("speed", "speed_ratio") if self.speed_ratio is None else ("speed_ratio", "speed")
            text = f"give {given} with {missing}, or none of them to take both from the operating point"
            return [Fault(text, (given,), on_key=True)]
        given_forms = [form for form in _FORMS if getattr(self, form) is not None]
        if len(given_forms) != 1:
            text = "give the capacity once: pump_torque with test_speed, performance with diameter, or k_factor"
            return [Fault(text, tuple(given_forms[1:2]))]
        lacking = [name for name in _FORMS[given_forms[0]] if getattr(self, name) is None]
        if lacking:
            return [Fault(f"{given_forms[0]} needs {lacking[0]}", (given_forms[0],), on_key=True)]
        if any(
            row[1].value < 0 or (given_forms[0] == "k_factor" and row[1].value == 0)
            for row in getattr(self, given_forms[0])
        ):
            return [Fault("a capacity must not be negative, and a K factor must be above zero", (given_forms[0],))]
        return [fault for name in (given_forms[0], *self.more_tables) for fault in self._uncovered(name)]

    def _uncovered(self, name: str) -> list[Fault]:
        if not isinstance(self.speed_ratio, Number):
            return []
        text = outside_message(getattr(self, name), self.speed_ratio.value)
        given = float(self.speed_ratio.value)
        return [Fault(f"{text} in {name}; speed_ratio is {given:g}", ("speed_ratio",))] if text else []

    def expressions(self) -> Iterator[tuple[EntryPath, Spec[object], Expression, str]]:
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

    def gain(self, value: Values) -> Gain | None:
        """Ratio of turbine torque to pump torque over the speed ratio; None where it is 1."""
        del value
        return None

    def twist(self, value: Values) -> Row:
        del value
        return difference(self.pump, self.turbine)

    def mean_speed_rows(self, value: Values) -> tuple[Row, ...]:
        """Tuple of at most one row of node speeds, which couples pump and turbine at the speed ratio that is given."""
        if self.speed_ratio is None:
            return ()
        ratio = value(self.speed_ratio)
        return (make_row([(self.turbine, 1), (self.pump, -ratio), (self.housing, ratio - 1)]),)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        if self.speed is None or self.speed_ratio is None:
            return self.tangent_parts(value)
        return self._parts_about(value(self.speed), value(self.speed_ratio), value)

    def own_tangent_parts(self, value: Values, states: Sequence[MotionState] = ()) -> tuple[Part, ...]:
        """Parts of the element for small motion about speeds; at rest it does nothing."""
        pump = states[0].sensed[0] if states and states[0].sensed else 0
        ratio = (pump - states[0].rate) / pump if pump else 0
        return self._parts_about(abs(pump), ratio, value)

    def own_whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        pump, capacity, gain = difference(self.pump, self.housing), self.capacity(value), self.gain(value)
        laws = [MotionLaw(difference(self.pump, self.turbine), CouplingCurve(capacity), sensed=(pump,))]
        if gain is not None:
            turbine = difference(self.turbine, self.housing)
            laws.append(MotionLaw(turbine, StatorCurve(capacity, gain), sensed=(pump,)))
        return (*laws, *self._masses(value))

    def _masses(self, value: Values) -> list[Law]:
        sides = ((self.pump, self.pump_inertia), (self.turbine, self.turbine_inertia))
        masses = [Law(make_row([(node, 1)]), inertia=value(inertia)) for node, inertia in sides]
        return [law for law in masses if law.acts]

    def _parts_about(self, speed: Any, ratio: Any, value: Values) -> tuple[Part, ...]:
        """Parts about a size of the speed of the pump in rad/s and a speed ratio."""
        gain = self.gain(value)
        (capacity, slope), (factor, factor_slope) = self.capacity(value).at(ratio), gain.at(ratio) if gain else (1, 0)
        by_pump, by_turbine = speed * (2 * capacity - ratio * slope), speed * slope
        pump, turbine = (difference(node, self.housing) for node in (self.pump, self.turbine))
        parts: list[Law | Action] = [
            Law(difference(self.pump, self.turbine), damping=-by_turbine),
            Action(difference(self.turbine, self.pump), pump, (0, by_pump + by_turbine)),
        ]
        # What the turbine has beyond the torque of the pump comes from the stator.
        surplus, rise = (factor - 1) * capacity, (factor - 1) * slope + factor_slope * capacity
        parts += [
            Law(turbine, damping=-speed * rise),
            Action(turbine, pump, (0, speed * (2 * surplus - ratio * rise))),
        ]
        return (parts[0], *(part for part in parts[1:] if part.acts), *self._masses(value))

    def capacity(self, value: Values) -> Capacity:
        """Capacity C = T_p / omega_p^2 in N m s^2/rad^2 over the speed ratio."""
        if self.k_factor is not None:
            return Capacity(self.k_factor, 900 / value.algebra.pi**2, of_k_factor=True, algebra=value.algebra)
        if self.performance is not None:
            factor = value(self.density) * value(self.diameter) ** 5
        else:
            factor = 1 / value(self.test_speed) ** 2
        return Capacity(self._capacity_table, factor, algebra=value.algebra)


def _ratio(row: tuple[Number, ...]) -> Any:
    return row[0].value
