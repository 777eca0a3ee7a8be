"""Excitation by torques or motions of given orders or frequencies, and by propellers at multiples of their blades."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, cast

import numpy as np

from torsionnet.base.entries.composite import D, Named, Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import SCALAR_SCHEMA, Value, is_quantity
from torsionnet.base.entries.spec import (
    Count,
    EntryError,
    Json,
    OneOf,
    Plural,
    Schema,
    Spec,
    Text,
    coerce_part,
    entry,
    name_fault,
)
from torsionnet.base.errors import EntryPath, Fault, UsageError, got, unfit_word
from torsionnet.base.units import RPM
from torsionnet.machinery.excitations.order_excitation import (
    ORDER,
    FloatArray,
    OrderExcitation,
    OrderTorques,
    Rating,
    ReactingExcitation,
    register_excitation,
)
from torsionnet.model.element_base.element_entries import NodeName

# Excitation by a torque or imposed motion with given orders or frequencies.

# Entry for tables over speed, interpolated linearly between their rows.

SpeedRows = tuple[tuple[float, float], ...]
_SPEED = Value("a speed", "speed", below=1e6)
SPEED_RTOL = 1e-9
"""Share of the largest speed by which a speed may lie outside of a table, for rounding of units."""


@dataclass(frozen=True, eq=False, repr=False)
class SpeedTable(Spec[SpeedRows]):
    """Entry for rows [speed, value] with rising speeds; at a speed given twice, a step, the second value counts."""

    of: Value

    @property
    def example(self) -> str:
        return "rows [speed, value] as [[300 rpm, 0.2], [750 rpm, 1]]"

    def coerce(self, raw: object) -> SpeedRows:
        if not isinstance(raw, list | tuple) or len(raw) < 2:
            raise EntryError(f"expected {self.example}, {got(raw)}", kind="wrong-form")
        rows = tuple(self._row(index, row) for index, row in enumerate(raw))
        for index in range(1, len(rows)):
            if rows[index][0] < rows[index - 1][0]:
                raise EntryError("the speeds of a table rise from row to row", (index,), kind="unordered-rows")
        return rows

    def _row(self, index: int, row: Any) -> tuple[float, float]:
        if not isinstance(row, list | tuple) or len(row) != 2:
            raise EntryError(f"expected a row [speed, value], {got(row)}", (index,), kind="wrong-form")
        try:
            return coerce_part(0, _SPEED, row[0]), coerce_part(1, self.of, row[1])
        except EntryError as error:
            raise EntryError([fault.under(index) for fault in error.faults]) from None

    def plain(self, value: Any) -> Json:
        return [list(row) for row in value]

    def schema(self) -> Schema:
        row: Schema = {"type": "array", "items": SCALAR_SCHEMA, "minItems": 2, "maxItems": 2}
        return {"type": "array", "items": row, "minItems": 2, "description": self.description}


def not_covered(tables: Mapping[EntryPath, SpeedRows | None], speeds: FloatArray | None) -> list[Fault]:
    """Faults of tables over speed, given by path, that do not cover the speeds in rad/s; none for unknown speeds."""
    if speeds is None:
        return []
    texts = {path: _outside(table, speeds, str(path[-1])) for path, table in tables.items() if table}
    return [Fault(text, path, kind="beyond-table") for path, text in texts.items() if text]


def over_speed(table: SpeedRows, speeds: FloatArray, what: str) -> FloatArray:
    """Values of a table, in its own unit, interpolated at speeds in rad/s, shape (n_speeds,).

    Raises
    ------
    UsageError
        Speeds outside the table.

    Examples
    --------
    >>> over_speed(((1.0, 0.0), (3.0, 4.0), (3.0, 8.0), (4.0, 8.0)), np.array([2.0, 3.0]), "gas").tolist()
    [2.0, 8.0]
    """
    text = _outside(table, speeds, what)
    if text:
        raise UsageError(text, kind="beyond-table")
    at, values = np.array(table).T
    # Two rows of one speed are a step, at which the later one counts.
    place = np.clip(np.searchsorted(at, speeds, side="right"), 1, len(at) - 1)
    width = at[place] - at[place - 1]
    share = np.divide(speeds - at[place - 1], width, out=np.ones(len(speeds)), where=width > 0)
    return np.asarray(values[place - 1] + np.clip(share, 0, 1) * (values[place] - values[place - 1]))


def _outside(table: SpeedRows, speeds: FloatArray, what: str) -> str:
    """Message if speeds lie outside of a table, else an empty text."""
    (low, high), (first, last) = (speeds.min(), speeds.max()), (table[0][0], table[-1][0])
    if low >= first - SPEED_RTOL * last and high <= last + SPEED_RTOL * last:
        return ""
    return (
        f"the table of {what} covers {first * RPM:.6g} to {last * RPM:.6g} rpm, but the shaft turns with "
        f"{low * RPM:.6g} to {high * RPM:.6g} rpm; give rows for these speeds too"
    )


PHASE = Value("phase: what acts is amplitude * cos(order * phi + phase)", "angle", lower=None)
FREQUENCY = Value("a frequency", "frequency", exclusive=True, below=1e6)
MOTIONS = ("angle", "velocity", "acceleration")
"""Names of the motions that can be imposed on a node; the index is the power of s over the angle."""


@dataclass(frozen=True, kw_only=True)
class HarmonicAmplitude(Declared):
    """Peak value and phase of one order: of a torque, or of a motion that is imposed."""

    kind: ClassVar[str] = "amplitude"
    article: ClassVar[str] = "an order"
    form: ClassVar[str] = "{amplitude: 12 N*m, phase: 30 deg}"

    amplitude: float | None = entry(Value("peak value of a torque", "torque"), None)
    angle: float | None = entry(Value("peak value of an imposed angle", "angle"), None)
    velocity: float | None = entry(Value("peak value of an imposed angular velocity", "speed"), None)
    acceleration: float | None = entry(Value("peak value of an imposed angular acceleration", "acceleration"), None)
    phase: float = entry(PHASE, 0)

    def contradictions(self) -> list[Fault]:
        given = [name for name in ("amplitude", *MOTIONS) if getattr(self, name) is not None]
        if len(given) == 1:
            return []
        text = "an order has an amplitude (of a torque), or an imposed angle, velocity or acceleration"
        return [
            Fault(
                f"{text}; here {'are ' + ' and '.join(given) if given else 'is none'}",
                on_key=True,
                kind="contradicting-entries",
            )
        ]

    @property
    def is_motion(self) -> bool:
        """Whether the amplitude is an angle, velocity or acceleration instead of a torque."""
        return self.amplitude is None

    def complex_amplitude(self, omega: FloatArray) -> Any:
        """Complex torque in N m, or angle in rad, at omega in rad/s, in the shape of ``omega``."""
        phase_factor = np.exp(1j * self.phase)
        if not self.is_motion:
            return self.amplitude * phase_factor * np.ones(len(omega))
        power, size = next(
            (power, size) for power, name in enumerate(MOTIONS) if (size := getattr(self, name)) is not None
        )
        # An imposed motion is an angle: x = v/(j omega) or a/(j omega)^2.
        return size * phase_factor / (1j * omega) ** power


@dataclass(frozen=True, eq=False, repr=False)
class TableByOrder(Plural[Mapping[float, D]]):
    """Entry for a table by order, a number above 0, or by frequency in Hz."""

    of: Nested[D]
    key: Value = ORDER
    key_name: str = "order"
    fewest: int = 1

    absent: ClassVar[Any] = {}

    @property
    def example(self) -> str:
        return f"{{{'2' if self.key is ORDER else '50 Hz'}: {self.of.example}}}"

    def read(self, raw: object) -> tuple[dict[float, D], list[Fault]]:
        if not isinstance(raw, Mapping) or len(raw) < self.fewest:
            what = "orders" if self.key_name == "order" else "frequencies"
            return {}, [
                Fault(f"expected {what} with what belongs to each, {self.example}, {got(raw)}", kind="wrong-form")
            ]
        table: dict[float, D] = {}
        faults: list[Fault] = []
        for key, value in raw.items():
            try:
                place = self.key.coerce(key)
            except EntryError as error:
                article = "an order is a number" if self.key_name == "order" else "a frequency has a unit, as 50 Hz"
                faults.append(Fault(f"{article}: {error}", (key,), on_key=True, kind=error.fault.kind))
                continue
            if place in table:
                faults.append(
                    Fault(
                        f"{self.key_name} {place:g} stands twice; keep one", (key,), on_key=True, kind="repeated-name"
                    )
                )
                continue
            row, wrong = self.of.read(value)
            table[place] = cast("D", row)
            faults += [fault.under(key) for fault in wrong]
        return table, faults

    def plain(self, value: Any) -> Any:
        """Plain data of the table, with numbers as keys, which YAML has and JSON has not."""
        return {int(place) if place == int(place) else place: self.of.plain(part) for place, part in value.items()}

    def schema(self) -> Schema:
        return {
            "type": "object",
            "description": self.description,
            "additionalProperties": self.of.schema(),
            "minProperties": self.fewest,
        }

    def definitions(self) -> Schema:
        return self.of.definitions()


AMPLITUDE = Nested(
    "peak value and phase", lambda: HarmonicAmplitude, "harmonic_amplitude", shown=HarmonicAmplitude.form
)


@register_excitation
@dataclass(frozen=True, kw_only=True)
class HarmonicTorque(ReactingExcitation):
    """A torque on a node, or a motion imposed on it, by orders of a shaft and by frequencies.

    A node with an imposed motion is held by it: it does not move at the orders of other excitations. With ``reaction``,
    a second node, the torque acts oppositely there, and a motion is imposed relative to it.

    Examples
    --------
    >>> fan = HarmonicTorque(node="fan", speed_of="motor", orders={2: {"amplitude": "10 N*m", "phase": "90 deg"}})
    >>> fan.torques(np.array([100.0])).amplitudes.round(9).tolist()
    [[[10j]]]
    >>> shaker = HarmonicTorque(node="fan", frequencies={"50 Hz": {"acceleration": "100 rad/s^2"}})
    >>> shaker.quantity, shaker.torques(np.array([100.0])).amplitudes.round(9).tolist()
    ('angle', [[[(-0.001013212-0j)]]])
    """

    kind: ClassVar[str] = "harmonic"

    node: str = entry(NodeName("the node it acts on", allow_ground=False))
    speed_of: str | None = entry(NodeName("the shaft whose orders are given; default: node", allow_ground=False), None)
    orders: Mapping[float, HarmonicAmplitude] = entry(
        TableByOrder("order -> peak value and phase", AMPLITUDE, fewest=0), None
    )
    frequencies: Mapping[float, HarmonicAmplitude] = entry(
        TableByOrder("frequency -> peak value and phase", AMPLITUDE, FREQUENCY, "frequency", 0), None
    )
    factor: SpeedRows | None = entry(SpeedTable("rows [speed, factor] of all amplitudes", Value("a factor", "1")), None)

    def contradictions(self) -> list[Fault]:
        parts = [*self.orders.values(), *self.frequencies.values()]
        if not parts:
            examples = (f"{name}: {dict(self.specs())[name].example}" for name in ("orders", "frequencies"))
            return [Fault(f"a harmonic excitation needs {' or '.join(examples)}", on_key=True, kind="missing-entry")]
        if len({part.is_motion for part in parts}) > 1:
            text = "torques and imposed motions are two excitations: where a motion is imposed, a torque does nothing"
            return [
                Fault(text, ("orders" if self.orders else "frequencies",), on_key=True, kind="contradicting-entries")
            ]
        return super().contradictions()

    @property
    def shaft(self) -> str:
        return str(self.speed_of or self.node)

    @property
    def quantity(self) -> str:
        return "angle" if next(iter([*self.orders.values(), *self.frequencies.values()])).is_motion else "torque"

    @property
    def node_entries(self) -> tuple[tuple[EntryPath, str], ...]:
        return ((("node",), self.node),)

    def remarks(self, speeds: FloatArray | None) -> list[Fault]:
        return not_covered({("factor",): self.factor}, speeds)

    def torques(self, speeds: FloatArray) -> OrderTorques:
        orders = np.array([*self.orders, *(0.0 for _ in self.frequencies)])
        fixed = np.array([*(0.0 for _ in self.orders), *self.frequencies])
        parts = [*self.orders.values(), *self.frequencies.values()]
        omega = speeds[:, None] * orders + 2 * np.pi * fixed
        amplitudes = np.stack([part.complex_amplitude(omega[:, place]) for place, part in enumerate(parts)], axis=1)
        if self.factor:
            amplitudes = amplitudes * over_speed(self.factor, speeds, "factor")[:, None]
        return OrderTorques(orders, self.nodes, amplitudes[:, :, None], fixed=fixed)


# Excitation by the torque of a propeller at multiples of its blades.

ZERO_PITCH = "zero_pitch"
"""Name of a propeller's condition that only a controllable pitch makes possible."""


@dataclass(frozen=True, kw_only=True)
class BladeOrder(Declared):
    """Share of the mean torque and phase of one multiple of the blades."""

    kind: ClassVar[str] = "blade order"
    article: ClassVar[str] = "a blade order"
    form: ClassVar[str] = "{share: 6 %, phase: 30 deg}"

    share: float = entry(Value("amplitude over mean torque, as 6 %", "1", below=1))
    phase: float = entry(Value("the torque taken is share * Q * cos(order * phi + phase)", "angle", lower=None), 0)


BLADE_ORDER = Nested("share and phase", lambda: BladeOrder, "blade_order")
_BLADE_ORDERS = TableByOrder("multiple of the blades -> share of the mean torque and phase", BLADE_ORDER)


class ShareOfFullAhead(Value):
    """Entry of a torque over that of full ahead; a torque in N m is told what is wanted."""

    def coerce(self, raw: object) -> float:
        try:
            return super().coerce(raw)
        except EntryError:
            if is_quantity(raw, "torque"):
                raise EntryError(
                    f"a share of the mean torque at full ahead, as 11.2 %, is expected, {got(raw)}", kind="wrong-form"
                ) from None
            raise


@dataclass(frozen=True, kw_only=True)
class PropellerCondition(Declared):
    """Torque of a propeller in another condition than full ahead: at zero pitch, astern, in ice, out of the water."""

    kind: ClassVar[str] = "condition"
    article: ClassVar[str] = "a condition"
    form: ClassVar[str] = "{torque: 20 %, blade_orders: {1: {share: 10 %}}}"

    torque: float = entry(
        ShareOfFullAhead("its mean torque over that of full ahead at rated speed", "1", exclusive=True), 1
    )
    exponent: float | None = entry(
        Value("its mean torque follows speed/rated to this power; default: as full ahead", "1"), None
    )
    blade_orders: Mapping[float, BladeOrder] = entry(_BLADE_ORDERS)


@register_excitation
@dataclass(frozen=True, kw_only=True)
class PropellerTorque(OrderExcitation):
    """Torque of a propeller's blades beside the mean torque Q(n) = Q_rated (n/n_rated)^exponent.

    At blade order i of z blades it acts with -share_i Q(n) cos(i z phi + phase_i), phi the angle of the propeller. It
    is 0 where the first cylinder of the engine fires (``phase_zero: engine_tdc1``); phases that count from an upright
    blade (``blade``) need the angle by which a blade is past upright there.

    Examples
    --------
    >>> screw = PropellerTorque(node="prop", blades=4, torque="1280 kN*m", rated="105 rpm",
    ...     blade_orders={1: {"share": "6 %"}})
    >>> at_rated = screw.torques(np.array([105 * np.pi / 30]))
    >>> at_rated.orders.tolist(), at_rated.amplitudes.real.round(6).tolist()
    ([4.0], [[[-76800.0]]])
    """

    kind: ClassVar[str] = "propeller"

    node: str = entry(NodeName("the node of the propeller; orders count its revolutions", allow_ground=False))
    blades: int = entry(Count("number of blades", 2, 9))
    blade_orders: Mapping[float, BladeOrder] = entry(_BLADE_ORDERS)
    torque: float = entry(Value("mean torque at rated speed", "torque", exclusive=True))
    rated: float = entry(Value("rated speed of the propeller", "speed", exclusive=True))
    exponent: float = entry(Value("mean torque follows (speed/rated) to this power", "1"), 2)
    pitch: str = entry(OneOf("whether its pitch can be set", ("fixed", "controllable")), "fixed")
    conditions: Mapping[str, PropellerCondition] = entry(
        Named(
            "others than full ahead, such as zero_pitch, astern, iced",
            Nested("its torque and blade orders", lambda: PropellerCondition, "propeller_condition"),
            refused=name_fault,
        ),
        None,
    )
    condition: str = entry(Text("which of them it is in; default: full ahead", "the name of a condition"), "")
    phase_zero: str = entry(OneOf("where phases count from", ("engine_tdc1", "blade")), "engine_tdc1")
    blade_angle: float | None = entry(
        Value("by how much a blade is past upright where the first cylinder fires", "angle", None), None
    )

    def contradictions(self) -> list[Fault]:
        return [*self._wrong_orders(), *self._wrong_conditions(), *self._wrong_zero()]

    def _wrong_orders(self) -> Iterator[Fault]:
        tables: dict[EntryPath, Any] = {("blade_orders",): self.blade_orders}
        tables |= {("conditions", name, "blade_orders"): case.blade_orders for name, case in self.conditions.items()}
        for path, table in tables.items():
            for order in table:
                if order != round(order):
                    text = f"a blade order is a whole multiple of the blades: 1, 2, ...; got {order:g}"
                    yield Fault(text, path, kind="contradicting-values")
                    break

    def remarks(self, speeds: FloatArray | None) -> list[Fault]:
        del speeds
        return list(self._orders_of_the_shaft())

    def _orders_of_the_shaft(self) -> Iterator[Fault]:
        """Warnings of blade orders that were probably counted in revolutions of the shaft.

        4 and 8 of 4 blades, without 1.
        """
        tables: dict[EntryPath, Any] = {("blade_orders",): self.blade_orders}
        tables |= {("conditions", name, "blade_orders"): case.blade_orders for name, case in self.conditions.items()}
        for path, table in tables.items():
            # Blade order 1 is the largest in most wakes: a table of multiples of the blade number without it probably
            # counts revolutions of the shaft.
            if table and all(order % self.blades == 0 for order in table):
                first = min(table)
                text = f"blade order {first:g} of {self.blades} blades is {first * self.blades:g} times a revolution"
                meant = f"{first / self.blades:g}"
                text += f"; blade orders are multiples of the blades: did you mean {meant}?"
                yield Fault(text, path, "warning", meant=meant, kind="implausible-size")

    def _wrong_conditions(self) -> Iterator[Fault]:
        if self.pitch == "fixed" and ZERO_PITCH in self.conditions:
            text = "a propeller of fixed pitch has no zero pitch; write pitch: controllable"
            yield Fault(text, ("conditions", ZERO_PITCH), on_key=True, kind="needless-entry")
        if self.condition and self.condition not in self.conditions:
            known = ", ".join(self.conditions)
            rest = f"there are {known}" if known else "there are none"
            text = f'the propeller has no condition "{self.condition}"'
            yield unfit_word(text, self.condition, self.conditions, ("condition",), rest)

    def _wrong_zero(self) -> Iterator[Fault]:
        if self.phase_zero == "blade" and self.blade_angle is None:
            text = "phases from an upright blade need its angle where the first cylinder fires: blade_angle: 15 deg"
            yield Fault(text, ("phase_zero",), kind="missing-entry")
        if self.phase_zero != "blade" and self.blade_angle is not None:
            yield Fault(
                "phases count from engine_tdc1; a blade angle goes with phase_zero: blade",
                ("blade_angle",),
                kind="needless-entry",
            )

    @property
    def shaft(self) -> str:
        return str(self.node)

    @property
    def node_entries(self) -> tuple[tuple[EntryPath, str], ...]:
        return ((("node",), self.node),)

    @property
    def law(self) -> tuple[float, float]:
        """Mean torque of the propeller in N m at rated speed in the present condition, and its exponent over speed."""
        if not self.condition:
            return float(self.torque), float(self.exponent)
        present = self.conditions[self.condition]
        own = self.exponent if present.exponent is None else present.exponent
        return float(self.torque * present.torque), float(own)

    @property
    def rating(self) -> Rating:
        torque, exponent = self.law
        return Rating(-torque, ("torque",), self.rated, ("rated",), exponent=exponent)

    def torques(self, speeds: FloatArray) -> OrderTorques:
        table = (self.conditions[self.condition] if self.condition else self).blade_orders
        torque, exponent = self.law
        # Q(n) = Q_rated (n/n_rated)^exponent, of which each blade order is a share.
        mean = torque * (speeds / self.rated) ** exponent
        orders = self.blades * np.array([float(order) for order in table])
        shares = np.array([part.share * np.exp(1j * part.phase) for part in table.values()])
        # A blade past upright by beta where phi = 0: cos(i z (phi + beta) + phase).
        shares = shares * np.exp(1j * orders * (self.blade_angle or 0.0))
        # The torque of a propeller brakes its shaft, hence the sign.
        return OrderTorques(orders, self.nodes, -(mean[:, None] * shares)[:, :, None])
