"""Fluid couplings and torque converters, with torques by tables over the speed ratio of pump and turbine."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar

from torsionnet.base.entries.scalars import PhysicalQuantity, RowColumn
from torsionnet.base.entries.spec import Spec, entry
from torsionnet.base.errors import EntryPath, Fault
from torsionnet.base.expressions import RATIONAL, Algebra, Expression, Number, Rows, outside_message, slope_at, value_at
from torsionnet.model.element_base.curves import Characteristic, with_curve_ranges
from torsionnet.model.element_base.element import Element, register
from torsionnet.model.element_base.element_entries import NodeName
from torsionnet.model.element_base.laws import (
    END_SLACK,
    GROUND,
    Action,
    Law,
    MotionLaw,
    MotionState,
    Part,
    Row,
    TorqueCurve,
    Values,
    WholePart,
    difference,
    make_row,
)

# Torque curves of fluid couplings and torque converters over the speeds of pump and turbine.


@dataclass(frozen=True)
class Capacity:
    """Capacity C = T_p/omega_p^2 of a pump in N m s^2/rad^2 over the speed ratio nu.

    It is ``factor`` times the second column of rows over nu, or divided by the square of that column where the rows are
    K factors. Between rows the column is straight. Beyond them its last piece goes on; a K factor stays there.
    """

    rows: Rows
    factor: Any
    of_k_factor: bool = False
    algebra: Algebra = RATIONAL

    def at(self, ratio: Any) -> tuple[Any, Any]:
        """Capacity at a speed ratio, and its slope over the ratio."""
        if not self.of_k_factor:
            level, slope = value_at(self.rows, ratio), self.algebra.number(slope_at(self.rows, ratio))
            return self.factor * level, self.factor * slope
        first, last = self.rows[0][0].value, self.rows[-1][0].value
        if ratio < first or ratio > last:
            # A straight line of K might come to 0, where C = factor/K^2 has a pole: K stays.
            level = value_at(self.rows, first if ratio < first else last)
            return self.factor / level**2, 0 * self.factor
        level, slope = value_at(self.rows, ratio), self.algebra.number(slope_at(self.rows, ratio))
        # C = factor/K^2, so that C' = -2 factor K'/K^3.
        return self.factor / level**2, -2 * self.factor * slope / level**3

    def ratios_at(self, capacity: float) -> Iterator[float]:
        """Speed ratios within the rows at which the pump has a capacity in N m s^2/rad^2, rising."""
        if self.of_k_factor:
            if capacity <= 0:
                return
            # K = sqrt(factor/C), K being above 0.
            level = math.sqrt(float(self.factor) / capacity)
        else:
            level = capacity / float(self.factor)
        last: float | None = None
        points = [(float(row[0].value), float(row[1].value)) for row in self.rows]
        for (start, low), (end, high) in pairwise(points):
            # A level at a row belongs to the pieces on both sides of it, and with rounding perhaps to neither.
            slack = END_SLACK * max(abs(low), abs(high))
            if high == low or not min(low, high) - slack <= level <= max(low, high) + slack:
                continue
            ratio = start + min(max((level - low) / (high - low), 0.0), 1.0) * (end - start)
            # The row between two pieces counts once.
            if last is None or ratio - last > END_SLACK:
                yield ratio
            last = ratio


@dataclass(frozen=True)
class Gain:
    """Turbine torque over pump torque by rows over the speed ratio, straight between them."""

    rows: Rows
    algebra: Algebra = RATIONAL

    def at(self, ratio: Any) -> tuple[Any, Any]:
        """Torque ratio at a speed ratio, and its slope over the speed ratio."""
        return value_at(self.rows, ratio), self.algebra.number(slope_at(self.rows, ratio))


@dataclass(frozen=True)
class CouplingCurve(TorqueCurve):
    """Torque C(nu) omega_p^2 between pump and turbine over gamma' = omega_p - omega_t and, sensed, omega_p.

    nu = omega_t/omega_p; both speeds are against the housing. Where the pump turns backwards the torque has the other
    sign, and none where it stands.

    >>> from fractions import Fraction
    >>> from torsionnet.base.expressions import FLOAT, Number
    >>> rows = tuple((Number(nu), Number(torque)) for nu, torque in ((Fraction(9, 10), 900), (1, 0)))
    >>> curve = CouplingCurve(Capacity(rows, 1 / 150**2, algebra=FLOAT))
    >>> round(curve.torque(0, 4.5, 150.0), 9)
    270.0
    >>> [round(slope, 9) for slope in curve.slopes(MotionState(0, 4.5, (150.0,)))]
    [0, 60.0, 1.8]
    >>> [round(state.rate, 9) for state in curve.states_at(270, 150.0)]
    [4.5]
    """

    over = "rate"

    capacity: Capacity

    def ratio(self, rate: Any, pump: Any) -> Any:
        """Speed ratio at the rate of the row and the speed of the pump; 0 where the pump stands."""
        return (pump - rate) / pump if pump != 0 else 0 * pump

    def factor(self, ratio: Any) -> tuple[Any, Any]:
        """Torque over the square of the pump's speed at a speed ratio, and its slope over the ratio."""
        return self.capacity.at(ratio)

    def torque(self, twist: Any, rate: Any, *sensed: Any) -> Any:
        del twist
        (pump,) = sensed
        return self.factor(self.ratio(rate, pump))[0] * pump * abs(pump)

    def energy(self, twist: Any) -> Any:
        return 0 * twist

    def slopes(self, state: MotionState) -> tuple[Any, ...]:
        (pump,) = state.sensed or (0.0,)
        ratio = self.ratio(state.rate, pump)
        level, slope = self.factor(ratio)
        # T = C(nu) omega_p |omega_p| with nu = 1 - gamma'/omega_p: to gamma' the slope is -C' |omega_p|,
        # and to omega_p it is (2 C + (1 - nu) C') |omega_p|.
        by_turbine = abs(pump) * slope
        return 0, -by_turbine, abs(pump) * (2 * level - ratio * slope) + by_turbine

    def states_at(self, torque: Any, *sensed: float) -> tuple[MotionState, ...] | None:
        """States in which the coupling passes on a torque in N m at a speed of the pump in rad/s, by rising ratio.

        None where that speed is not given.
        """
        if not sensed or not sensed[0]:
            return None
        (pump,) = sensed
        # C = T/(omega_p |omega_p|), which a coupling may have at several speed ratios.
        ratios = self.capacity.ratios_at(float(torque) / (pump * abs(pump)))
        return tuple(MotionState(0.0, pump * (1 - ratio), (pump,)) for ratio in ratios)

    def tables(self) -> tuple[Rows, ...]:
        """Tables over the speed ratio that the curve follows."""
        return (self.capacity.rows,)

    def left(self, twist: float, rate: float = 0.0, *sensed: float) -> str:
        del twist
        if not sensed or not sensed[0]:
            return ""
        ratio = float(self.ratio(rate, sensed[0]))
        first, last = (
            pick(float(rows[place][0].value) for rows in self.tables()) for pick, place in ((max, 0), (min, -1))
        )
        if first - END_SLACK <= ratio <= last + END_SLACK:
            return ""
        return f"the table goes from speed ratio {first:.6g} to {last:.6g}, and the ratio is {ratio:.6g}; extend it"


@dataclass(frozen=True)
class StatorCurve(CouplingCurve):
    """Torque -(mu(nu) - 1) C(nu) omega_p^2 on the turbine of a converter, over omega_t and, sensed, omega_p.

    It is what the turbine has beyond the torque of the pump, by the torque ratio mu; the stator takes it to the
    housing.
    """

    gain: Gain

    def ratio(self, rate: Any, pump: Any) -> Any:
        return rate / pump if pump != 0 else 0 * pump

    def factor(self, ratio: Any) -> tuple[Any, Any]:
        capacity, slope = self.capacity.at(ratio)
        gain, rise = self.gain.at(ratio)
        return -(gain - 1) * capacity, -((gain - 1) * slope + rise * capacity)

    def slopes(self, state: MotionState) -> tuple[Any, ...]:
        (pump,) = state.sensed or (0.0,)
        ratio = self.ratio(state.rate, pump)
        level, slope = self.factor(ratio)
        return 0, abs(pump) * slope, abs(pump) * (2 * level - ratio * slope)

    def states_at(self, torque: Any, *sensed: float) -> tuple[MotionState, ...] | None:
        """None for every torque: that between pump and turbine tells the ratio, not what the stator adds."""
        del torque, sensed
        return None

    def tables(self) -> tuple[Rows, ...]:
        return (self.capacity.rows, self.gain.rows)


# Base of fluid couplings and torque converters, with pump torque over speed ratio.

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
            return [Fault("pump, turbine and housing must be on different nodes", ("turbine",), kind="same-node")]
        if (self.speed is None) != (self.speed_ratio is None):
            given, missing = ("speed", "speed_ratio") if self.speed_ratio is None else ("speed_ratio", "speed")
            text = f"give {given} with {missing}, or none of them to take both from the operating point"
            return [Fault(text, (given,), on_key=True, kind="missing-entry")]
        given_forms = [form for form in _FORMS if getattr(self, form) is not None]
        if len(given_forms) != 1:
            text = "give the capacity once: pump_torque with test_speed, performance with diameter, or k_factor"
            return [Fault(text, tuple(given_forms[1:2]), kind="contradicting-entries")]
        lacking = [name for name in _FORMS[given_forms[0]] if getattr(self, name) is None]
        if lacking:
            return [Fault(f"{given_forms[0]} needs {lacking[0]}", (given_forms[0],), on_key=True, kind="missing-entry")]
        if any(
            row[1].value < 0 or (given_forms[0] == "k_factor" and row[1].value == 0)
            for row in getattr(self, given_forms[0])
        ):
            return [
                Fault(
                    "a capacity must not be negative, and a K factor must be above zero",
                    (given_forms[0],),
                    kind="out-of-range",
                )
            ]
        return [fault for name in (given_forms[0], *self.more_tables) for fault in self._uncovered(name)]

    def _uncovered(self, name: str) -> list[Fault]:
        if not isinstance(self.speed_ratio, Number):
            return []
        text = outside_message(getattr(self, name), self.speed_ratio.value)
        given = float(self.speed_ratio.value)
        return (
            [Fault(f"{text} in {name}; speed_ratio is {given:g}", ("speed_ratio",), kind="out-of-range")]
            if text
            else []
        )

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
        # Per change of the speeds: dT_p = omega_p (2 C - nu C') domega_p + omega_p C' domega_t.
        by_pump, by_turbine = speed * (2 * capacity - ratio * slope), speed * slope
        pump, turbine = (difference(node, self.housing) for node in (self.pump, self.turbine))
        # One part damps pump against turbine; what is left follows the pump alone and acts one way.
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
            # K in r/min per sqrt(N m): omega = n pi/30 makes C = (30/pi)^2/K^2.
            return Capacity(self.k_factor, 900 / value.algebra.pi**2, of_k_factor=True, algebra=value.algebra)
        if self.performance is not None:
            # C = lambda rho D^5.
            factor = value(self.density) * value(self.diameter) ** 5
        else:
            factor = 1 / value(self.test_speed) ** 2
        return Capacity(self._capacity_table, factor, algebra=value.algebra)


def _ratio(row: tuple[Number, ...]) -> Any:
    return row[0].value


# Fluid coupling: torque by a table over the speed ratio.


@register
class FluidCoupling(Hydrodynamic):
    """A fluid (Foettinger) coupling: pump and turbine pass on one torque T = C(nu) omega_p^2, nu = omega_t / omega_p.

    C is lambda rho D^5 with the performance coefficient lambda(nu), the torque at a test speed over its square, or
    1/K^2 with the K factor omega_p / sqrt(T). Small changes of the speeds change it by dT = omega_p (2 C - nu C')
    domega_p + omega_p C' domega_t: a damper -omega_p C' between pump and turbine, and a torque omega_p (2 C + (1 - nu)
    C') on both that follows the speed of the pump alone, so that the coupling acts one way more than the other. Tables
    are straight between their rows; at a row the piece above it counts. The oil follows without delay here, and what
    of it turns along belongs to the inertias (VDI 2153, Hydrodynamic power transmission).

    T is its law of motion in time, over absolute speeds. Without ``speed`` and ``speed_ratio`` linear results take its
    slopes at the operating point; without one the coupling stands and passes on nothing.

    Examples
    --------
    >>> from torsionnet.model.element_base.laws import Values
    >>> coupling = FluidCoupling("coupling", pump="a", turbine="b", speed="150 rad/s", speed_ratio=0.97,
    ...     pump_torque=[[0.9, "900 N*m"], [1, 0]], test_speed="150 rad/s")
    >>> damper, follows = coupling.parts(Values({}))
    >>> float(damper.damping), [float(value) for value in follows.numerator]
    (60.0, [0.0, 1.8])
    """

    kind: ClassVar[str] = "fluid_coupling"


# Torque converter: pump and turbine torque by tables over the speed ratio.


@register
@dataclass(frozen=True, eq=False, repr=False)
class TorqueConverter(Hydrodynamic):
    """A hydrodynamic torque converter: T_p = C(nu) omega_p^2 and T_t = mu(nu) T_p, nu = omega_t / omega_p.

    With E = mu C and slopes over nu, small changes of the speeds change the torques by
    dT_p = omega_p (2 C - nu C') domega_p + omega_p C' domega_t and
    dT_t = omega_p (2 E - nu E') domega_p + omega_p E' domega_t: a matrix that is not symmetric. The stator takes the
    difference to the housing. C is given as for ``fluid_coupling``: by the performance coefficient lambda(nu) of
    C = lambda rho D^5, by the pump torque at a test speed (as MP2000 curves at 2000 r/min), or by the K factor
    omega_p / sqrt(T_p). Both tables are straight between their rows; at a row the piece above it counts. A lock-up
    clutch is a ``clutch`` beside it (A. J. Kotwicki, Dynamic models for torque converter equipped vehicles, SAE 820393,
    1982).

    T_p and T_t are its laws of motion in time, over absolute speeds. Without ``speed`` and ``speed_ratio`` linear
    results take their slopes at the operating point; without one the converter stands and passes on nothing.

    Examples
    --------
    >>> converter = TorqueConverter("converter", pump="engine", turbine="input", speed="2000 rpm", speed_ratio=0.5,
    ...     pump_torque=[[0, "180 N*m"], [1, "100 N*m"]], test_speed="2000 rpm", torque_ratio=[[0, 2.2], [1, 1]])
    >>> pump_slope = float(converter.parts(Values({}))[0].damping)
    >>> round(pump_slope, 4)  # 80 N*m over 2000 r/min
    0.382
    """

    kind: ClassVar[str] = "torque_converter"
    more_tables: ClassVar[tuple[str, ...]] = ("torque_ratio",)

    torque_ratio: Rows = entry(
        Characteristic(
            "rows [speed ratio, turbine torque over pump torque]", (SPEED_RATIO_COLUMN, RowColumn("torque ratio"))
        ),
        kw_only=True,
    )

    def gain(self, value: Values) -> Gain:
        return Gain(self.torque_ratio, value.algebra)
