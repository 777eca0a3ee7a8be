"""Limits given as curves over speed by makers of engines, gears or camshafts, for any output."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, cast

import numpy as np

from torsionnet.base.entries.composite import Listed, one_exactly
from torsionnet.base.entries.scalars import SCALAR_SCHEMA, Value, ValueInUnitOfUse, check_unit
from torsionnet.base.entries.spec import EntryError, Json, OneOf, Plural, Schema, Text, entry, name_fault
from torsionnet.base.errors import EntryPath, Fault, got, unknown_name
from torsionnet.base.expressions import Number
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.excitations.order_excitation import ORDER
from torsionnet.machinery.limits.evidence import Evidence, LimitSubject
from torsionnet.machinery.limits.limit import PASSING_TIME, TOLERANCE, LimitLine, register_rule
from torsionnet.machinery.limits.speed_band import InSpeedBand
from torsionnet.machinery.orders.order_line import lines_of_one_frequency
from torsionnet.machinery.verdicts.limit_verdict import LimitVerdict, RuleText
from torsionnet.model.channels import UNITS, ChannelName, Sensor, named_sensor
from torsionnet.model.element_base.round_section import section_fault


def crankshaft_throws(subject: LimitSubject, element: str) -> list[str]:
    """Names of the elements between two cylinders of the crankshaft that an element is a part of, with the element.

    Empty for an element of no crankshaft. It may itself lie between the last cylinder and the flywheel.
    """
    ports = {name: set(element.ports.values()) for name, element in subject.active.items()}
    throws = {name: nodes for name, nodes in ports.items() if len(nodes) == 2 and nodes <= subject.cranks}
    reached = ports.get(element, set()) & subject.cranks
    crankshaft = {element} if reached else set[str]()
    # From throw to throw along the shaft: another engine's crankshaft is not reached.
    while more := [name for name, nodes in throws.items() if name not in crankshaft and nodes & reached]:
        crankshaft.update(more)
        reached |= set().union(*(throws[name] for name in more))
    return [name for name in ports if name in crankshaft]


# Allowed values of a limit, one for all speeds or tables over speed or speed ratio.

ALLOWED = ValueInUnitOfUse("value allowed", exclusive=True)
"""Specification of one allowed value in a table of a limit."""
_KEYS = {"speed": Value("a speed", "speed", below=1e6), "1": Value("a speed ratio", "1", below=10)}
Pairs = tuple[tuple[float, Number], ...]


@dataclass(frozen=True, eq=False, repr=False)
class AllowedTable(Plural[Pairs]):
    """Entry of a table of values that a limit allows, over speed or speed ratio.

    ``{300 rpm: 40 MPa, 750 rpm: 25 MPa}``, stored as pairs by rising key.
    """

    over: str
    """Dimension of the table's keys, "speed" or "1": "speed" or "1"."""

    absent: ClassVar[Any] = ()

    @property
    def example(self) -> str:
        return "{300 rpm: 40 MPa, 750 rpm: 25 MPa}" if self.over == "speed" else "{0.4: 40 MPa, 1: 25 MPa}"

    def read(self, raw: object) -> tuple[Pairs, list[Fault]]:
        if isinstance(raw, tuple):
            return raw, []
        if not isinstance(raw, Mapping) or len(raw) < 2:
            return (), [Fault(f"expected two points or more, {self.example}; {got(raw)}", kind="wrong-form")]
        points: dict[float, Number] = {}
        faults: list[Fault] = []
        for key, value in raw.items():
            try:
                at = _KEYS[self.over].coerce(key)
            except EntryError as error:
                faults.append(replace(error.fault, path=(key,), on_key=True))
                continue
            if at in points:
                faults.append(Fault(f"{key} stands twice", (key,), on_key=True, kind="repeated-name"))
            allowed, wrong = ALLOWED.read(value)
            faults += [fault.under(key) for fault in wrong]
            points[at] = cast("Number", allowed)
        return (() if faults else tuple(sorted(points.items(), key=lambda pair: pair[0]))), faults

    def coerce(self, raw: object) -> Pairs:
        pairs, faults = self.read(raw)
        if faults:
            raise EntryError(faults[0].message)
        return pairs

    def plain(self, value: Any) -> Json:
        unit = " rad/s" if self.over == "speed" else ""
        return {f"{key!r}{unit}" if unit else key: ALLOWED.plain(allowed) for key, allowed in value}

    def schema(self) -> Schema:
        return {
            "type": "object",
            "description": f"{self.description}: {self.example}",
            "minProperties": 2,
            "additionalProperties": SCALAR_SCHEMA,
        }


def allowed_at(pairs: Pairs, at: FloatArray) -> FloatArray:
    """Allowed values in SI units at speeds or speed ratios, interpolated linearly, in the shape of ``at``.

    NaN outside of the table.

    Examples
    --------
    >>> from fractions import Fraction
    >>> pairs = ((1.0, Number(Fraction(10))), (2.0, Number(Fraction(20))))
    >>> allowed_at(pairs, np.array([0.5, 1.5, 2.0])).tolist()
    [nan, 15.0, 20.0]
    """
    keys = np.array([float(key) for key, _ in pairs])
    values = np.array([float(value.value) for _, value in pairs])
    slack = 1e-9 * keys[-1]
    inside = (at >= keys[0] - slack) & (at <= keys[-1] + slack)
    return np.asarray(np.where(inside, np.interp(at, keys, values), np.nan))


DIMENSION_OF = {"angle": "angle", "velocity": "speed", "acceleration": "acceleration", "twist": "angle",
                "torque": "torque", "stress": "pressure"}  # fmt: skip
"""Dimension of the value that a limit allows, by the quantity of the limited sensor."""


@register_rule
@dataclass(frozen=True, kw_only=True)
class CurveLimit(InSpeedBand):
    """A value allowed over speed or speed ratio for any output: of the sum of all orders, or of each order.

    Between the points of a table are straight lines; speeds outside are not judged, and that is said. Where the value
    is exceeded speeds are to be barred; ``transient_factor`` times it may not be exceeded while they are passed.

    Examples
    --------
    >>> crank = CurveLimit(output="torque(k56)", over_speed={"300 rpm": "60 kN*m", "750 rpm": "40 kN*m"},
    ...     source="letter of the maker")
    >>> crank.of
    'torque(k56)'
    """

    kind: ClassVar[str] = "curve"

    output: str = entry(ChannelName("sensor, or torque(element), stress(shaft), ...", "the name of a sensor"))
    value: Number | None = entry(ALLOWED, None)
    over_speed: Pairs = entry(AllowedTable("instead: values over the speed of the reference shaft", "speed"), ())
    over_lambda: Pairs = entry(AllowedTable("instead: values over the speed ratio n/n_rated", "1"), ())
    measure: str = entry(
        OneOf("what is compared: half range of the sum, or the largest of the orders", ("half_range", "each_order")),
        "half_range",
    )
    orders: tuple[float, ...] = entry(Listed("with each_order: these alone", ORDER, form="a list of orders"), ())
    throws: str = entry(
        OneOf(
            "of a torque in a crankshaft: every throw of it is judged, or the one of the output alone", ("all", "one")
        ),
        "all",
    )
    tachometer_tolerance: float = entry(TOLERANCE, 0)
    passing_time: float | None = entry(PASSING_TIME, None)
    transient_factor: float | None = entry(Value("times the value for passing through", "1", lower=1), None)
    source: str = entry(Text("who says so, and where"))

    @property
    def of(self) -> str:
        return str(self.output)

    @property
    def tolerance(self) -> float:
        return float(self.tachometer_tolerance)

    @property
    def seconds_to_pass(self) -> float | None:
        return None if self.passing_time is None else float(self.passing_time)

    @property
    def named(self) -> tuple[tuple[EntryPath, str, str], ...]:
        return ()

    def switched_off(self, subject: LimitSubject) -> str:
        sensor = self.sensor(subject)
        if sensor is None:
            return ""
        named, there = ((sensor.of,), subject.active) if sensor.is_on_element else (sensor.nodes, subject.active_nodes)
        return next((name for name in named if name not in there), "")

    def contradictions(self) -> list[Fault]:
        faults = one_exactly(self, "value", "over_speed", "over_lambda", of="what is allowed")
        if self.orders and self.measure != "each_order":
            faults.append(Fault("orders go with measure: each_order", ("orders",), on_key=True, kind="needless-entry"))
        return faults

    def sensor(self, subject: LimitSubject) -> Sensor | None:
        """Sensor whose values the curve limits: an output, or the angle of a node; None where there is none."""
        sensor = named_sensor(self.output, subject.sensors)
        return sensor or (Sensor("angle", self.output) if name_fault(self.output) is None else None)

    def unfit(self, subject: LimitSubject) -> Iterator[Fault]:
        yield from super().unfit(subject)
        sensor = self.sensor(subject)
        known = subject.elements if sensor and sensor.is_on_element else subject.nodes
        missing = [name for name in (sensor.nodes or (sensor.of,)) if name not in known] if sensor else [self.output]
        if sensor is None or missing:
            names = [*subject.sensors, *known]
            what = "output" if missing[0] == self.output else "element or node"
            yield unknown_name(what, missing[0], names, ("output",))
            return
        if sensor.quantity == "stress" and section_fault(subject.elements[sensor.of]):
            yield Fault(str(section_fault(subject.elements[sensor.of])), ("output",), kind="missing-entry")
            return
        yield from self._wrong_units(sensor)
        if self.over_lambda and subject.rated is None:
            text = "over_lambda needs the rated speed: speeds: {rated: 750 rpm}"
            yield Fault(text, ("over_lambda",), on_key=True, about="speeds", kind="missing-entry")
        elif subject.speeds:
            yield from self._uncovered(subject.speeds, subject.rated)

    def _wrong_units(self, sensor: Sensor) -> Iterator[Fault]:
        dimension = DIMENSION_OF[sensor.quantity]
        places: list[tuple[EntryPath, Number]] = [(("value",), self.value)] if self.value else []
        places += [(("over_speed",), value) for _, value in self.over_speed]
        places += [(("over_lambda",), value) for _, value in self.over_lambda]
        for path, value in places:
            try:
                check_unit(value, dimension)
            except EntryError as error:
                yield replace(error.fault, path=path)
                return

    def _uncovered(self, speeds: tuple[float, ...], rated: float | None) -> Iterator[Fault]:
        if self.value:
            return
        key, factor = ("over_speed", 1.0) if self.over_speed else ("over_lambda", rated or math.nan)
        pairs = getattr(self, key)
        low, high = pairs[0][0] * factor, pairs[-1][0] * factor
        if speeds[0] < low * (1 - 1e-9) or speeds[-1] > high * (1 + 1e-9):
            covered = phrase("{low:.6g} to {high:.6g} rpm", low=low * RPM, high=high * RPM)
            text = f"the table covers {covered}, the speeds go from {speeds[0] * RPM:.6g} to {speeds[-1] * RPM:.6g} rpm"
            yield Fault(
                f"{text}; other speeds are not judged, extend the table to them",
                (key,),
                "warning",
                on_key=True,
                kind="beyond-table",
            )

    def order_sensors(self, subject: LimitSubject) -> list[Sensor]:
        """Sensor of the output; of a torque in a crankshaft also those of its other throws, which are as strong."""
        sensor = self.sensor(subject)
        if sensor is None or sensor.quantity != "torque" or self.throws == "one":
            return [] if sensor is None else [sensor]
        others = (name for name in crankshaft_throws(subject, sensor.of) if name != sensor.of)
        return [sensor, *(Sensor("torque", name) for name in others)]

    def place(self, line: LimitLine, evidence: Evidence) -> str:
        """Output, or the throw with the largest value where the crankshaft is used most."""
        sensors = self.order_sensors(evidence.subject)
        worst = evidence.largest_of(sensors, line.worst)
        return self.of if worst is sensors[0] else str(worst)

    def vibratory_sensors(self, criterion: str, subject: LimitSubject) -> tuple[list[Sensor], float] | None:
        del criterion
        return (self.order_sensors(subject), 1.0) if self.measure == "half_range" else None

    def rule_text(self, evidence: Evidence) -> RuleText:
        del evidence
        what = phrase(
            "half range of the sum of all orders" if self.measure == "half_range" else "amplitude of each order"
        )
        if self.orders:
            what = phrase("{what} of {orders}", what=what, orders=", ".join(f"{order:g}" for order in self.orders))
        beyond = "" if self.value else "speeds outside of the table"
        formula = [phrase("{what} <= value allowed", what=what)]
        if self.transient_factor:
            formula.append(phrase("in passing {factor:g} times as much", factor=self.transient_factor))
        return RuleText(self.source, joined("; ", formula), beyond)

    def breaks(self, subject: LimitSubject) -> list[float]:
        edges = super().breaks(subject)
        if self.over_lambda:
            return [*edges, *(key * (subject.rated or math.nan) for key, _ in self.over_lambda)]
        return [*edges, *(key for key, _ in self.over_speed)]

    def lines(self, evidence: Evidence) -> Iterator[LimitLine]:
        sensor = self.sensor(evidence.subject)
        if sensor is None:
            return
        sensors = self.order_sensors(evidence.subject)
        orders = evidence.orders(sensors)
        values = evidence.size(sensors)
        if self.measure != "half_range":
            values = np.max([self._largest(sensor, evidence) for sensor in sensors], axis=0)
        allowed = self._allowed(evidence)
        quantity = "half range" if self.measure == "half_range" else "largest amplitude of an order"
        unit = UNITS[sensor.quantity]
        yield LimitLine("continuous", quantity, unit, values, allowed, (), orders)
        if self.transient_factor:
            passing = self.transient_factor * allowed
            yield LimitLine("in passing", quantity, unit, values, passing, (), orders, in_passing=True)

    def judged(self, line: LimitLine, name: str, evidence: Evidence) -> Iterator[LimitVerdict]:
        if np.isfinite(line.allowed).any() or line.why_not or self.speed_band:
            yield from super().judged(line, name, evidence)
        elif not line.in_passing:
            yield self.open(name, evidence, line.criterion, "all speeds are outside of the table")

    def remarks(self, line: LimitLine, evidence: Evidence) -> tuple[str, ...]:
        said = super().remarks(line, evidence)
        rpm = evidence.run.rpm[np.isfinite(line.allowed)]
        if len(rpm) == len(line.allowed) or line.in_passing or self.speed_band:
            return said
        return (f"judged from {rpm[0]:g} to {rpm[-1]:g} rpm; the rest is outside of the table",)

    def _largest(self, sensor: Sensor, evidence: Evidence) -> FloatArray:
        lines, sizes = evidence.run.lines, evidence.summed_orders(sensor)
        # What counts is the sum of lines of one frequency, if one of them is of an order named.
        chosen = [
            number
            for number, places in enumerate(lines_of_one_frequency(lines))
            if not self.orders or any(math.isclose(lines[at].order, order) for at in places for order in self.orders)
        ]
        return np.asarray(sizes[:, chosen].max(axis=1)) if chosen else np.zeros(len(sizes))

    def _allowed(self, evidence: Evidence) -> FloatArray:
        if self.value:
            return np.full(len(evidence.speeds), float(self.value.value))
        if self.over_speed:
            return allowed_at(self.over_speed, evidence.speeds)
        return allowed_at(self.over_lambda, evidence.speeds / float(evidence.subject.rated or math.nan))
