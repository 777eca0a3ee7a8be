"""Excitation by a torque or imposed motion with given orders or frequencies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, cast

import numpy as np

from torsionnet.base.entries.composite import D, Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import SCALAR_SCHEMA, Value
from torsionnet.base.entries.spec import EntryError, Json, Plural, Schema, Spec, coerce_part, entry
from torsionnet.base.errors import EntryPath, Fault, UsageError, got
from torsionnet.base.units import RPM
from torsionnet.machinery.excitations.order_excitation import (
    ORDER,
    FloatArray,
    OrderTorques,
    ReactingExcitation,
    register_excitation,
)
from torsionnet.model.element_base.element_entries import NodeName

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
