"""Excitation by a recorded torque or motion of a node."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.delimited.dialect import data_start, detect_dialect, detect_encoding, headings, line_position
from torsionnet.base.delimited.number_rows import NumberRows
from torsionnet.base.entries.composite import Listed, Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import EntryError, Json, Schema, Text, entry
from torsionnet.base.errors import EntryPath, Fault, ModelError, UsageError, did_you_mean
from torsionnet.base.nearby_files import nearby_file
from torsionnet.machinery.excitations.harmonic_torque import not_covered
from torsionnet.machinery.excitations.order_excitation import (
    ComplexArray,
    FloatArray,
    OrderTorques,
    ReactingExcitation,
    register_excitation,
)
from torsionnet.model.element_base.element_entries import NodeName

# Columns of a recording by order or frequency, recognised by their headings.

FORM = "order, amplitude [N*m], phase [deg]"
POWERS = {"torque": 0, "angle": 0, "speed": 1, "acceleration": 2}
"""Power of s over the angle that each recorded quantity has, by quantity; 0 for a torque."""
PEAKS = {"amplitude": 1.0, "rms": np.sqrt(2), "peak_to_peak": 0.5}
"""Factor from the recorded size of a line to its peak value, by name of the column."""
KEYS = ("order", "frequency", "speed")
KNOWN = (*KEYS, *PEAKS, "phase", "real", "imag", "half_width")
_HEADING = re.compile(r"\s*(\w+)\s*(?:\[([^\]]*)\])?\s*")


@dataclass(frozen=True, eq=False)
class MeasuredLines:
    """Recorded lines of a torque or motion by order (or Hz), with complex peak values in SI units over speed.

    Attributes
    ----------
    quantity : str
        torque, angle, speed or acceleration.
    by_frequency : bool
        Whether ``keys`` are frequencies in Hz; else they are orders.
    keys : (n_lines,) array
    speeds : tuple of (n,) arrays
        rad/s, rising, of each line; empty where the recording has no speeds.
    values : tuple of (n,) complex arrays
        Peak values in SI; one where there are no speeds.
    has_phase : bool
        Whether the recording states phases.
    half_widths : tuple of (n,) arrays
        Half width of the 95 % interval of real and imaginary part, SI, of each line; empty where none is stated.
    """

    quantity: str
    by_frequency: bool
    keys: FloatArray
    speeds: tuple[FloatArray, ...]
    values: tuple[ComplexArray, ...]
    has_phase: bool = True
    half_widths: tuple[FloatArray, ...] = ()

    def at(self, line: int, speeds: FloatArray) -> ComplexArray:
        """Complex peak values in SI units of a recorded line at speeds in rad/s, shape (n_speeds,).

        Magnitude and phase are interpolated linearly.
        """
        values = self.values[line]
        if not self.speeds:
            return np.full(len(speeds), values[0])
        # Phases are unwrapped first, so that interpolation does not turn the long way round at +-180 degrees.
        size = np.interp(speeds, self.speeds[line], np.abs(values))
        return np.asarray(size * np.exp(1j * np.interp(speeds, self.speeds[line], np.unwrap(np.angle(values)))))


def measured_lines(headings: Sequence[str], rows: FloatArray) -> MeasuredLines:
    """Lines by order or frequency from rows of a recording, shape (n, n_columns), under given headings.

    Raises
    ------
    UsageError
        A column is unknown, missing or without unit, or two rows give the same line.

    Examples
    --------
    >>> table = measured_lines(["order", "rms [N*m]", "phase [deg]"], np.array([[2.0, 10, 90], [4, 1, 0]]))
    >>> table.keys.tolist(), table.quantity, [complex(value[0].round(3)) for value in table.values]
    ([2.0, 4.0], 'torque', [14.142j, (1.414+0j)])
    """
    columns = _columns(headings)
    key = _key(columns)
    numbers = {name: rows[:, place] for name, (place, _) in columns.items()}
    quantity, values = _measured_peaks(columns, numbers)
    has_phase = "phase" in columns or "real" in columns
    widths = _half_widths(columns, numbers, quantity)
    keys = numbers[key] * (_factor(columns[key][1], "frequency", key) if key == "frequency" else 1)
    if (keys <= 0).any():
        raise UsageError(f"{key} is above 0; the mean value is no vibration, leave its row out", kind="needless-entry")
    speeds = numbers["speed"] * _factor(columns["speed"][1], "speed", "speed") if "speed" in columns else None
    distinct = np.unique(keys)
    groups = [np.flatnonzero(keys == line) for line in distinct]
    if speeds is None:
        _require(
            all(len(group) == 1 for group in groups),
            f"every {key} has one row, unless there is a column of speeds",
            "repeated-name",
        )
        return MeasuredLines(
            quantity, key == "frequency", distinct, (), _parts(values, groups), has_phase, _parts(widths, groups)
        )
    # Each line over its own rising speeds, in whatever order the rows of the recording are.
    sorted_groups = [group[np.argsort(speeds[group])] for group in groups]
    _require(
        all((np.diff(speeds[group]) > 0).all() for group in sorted_groups),
        f"every {key} has one row at each speed",
        "repeated-name",
    )
    at, of = _parts(speeds, sorted_groups), _parts(values, sorted_groups)
    return MeasuredLines(quantity, key == "frequency", distinct, at, of, has_phase, _parts(widths, sorted_groups))


def _parts(values: NDArray[Any] | None, groups: Sequence[NDArray[np.int64]]) -> tuple[NDArray[Any], ...]:
    return () if values is None else tuple(values[group] for group in groups)


def _half_widths(
    columns: dict[str, tuple[int, str]], numbers: dict[str, FloatArray], quantity: str
) -> FloatArray | None:
    """Half widths of the intervals in SI as of peak values, shape (n_rows,); None where no column states them."""
    if "half_width" not in columns:
        return None
    own, factor = _quantity("half_width", columns["half_width"][1])
    _require(own == quantity, f"half_width is one of {quantity}, as the amplitudes are", "wrong-unit")
    # An interval is stated of the quantity of its column: it becomes a peak value by the same factor.
    size = next((name for name in PEAKS if name in columns), "amplitude")
    return np.asarray(factor * PEAKS[size] * numbers["half_width"])


def _require(holds: bool, text: str, kind: str) -> None:
    if not holds:
        raise UsageError(text, kind=kind)


def _columns(headings: Sequence[str]) -> dict[str, tuple[int, str]]:
    """Index and unit of each column of a recording, by the column's name."""
    columns: dict[str, tuple[int, str]] = {}
    for place, heading in enumerate(headings):
        match = _HEADING.fullmatch(heading)
        name = match[1] if match else heading
        if match is None or name not in KNOWN:
            hint = did_you_mean(name, KNOWN)
            text = f'"{heading}" is not a heading of a recording{hint}; known: {", ".join(KNOWN)}, as {FORM}'
            raise UsageError(Fault(text, about=name, kind="unknown-entry"))
        _require(name not in columns, f"{name} is given by two headings; keep one of them", "repeated-name")
        columns[name] = place, (match[2] or "").strip()
    return columns


def _key(columns: dict[str, tuple[int, str]]) -> str:
    given = [name for name in ("order", "frequency") if name in columns]
    _require(
        len(given) == 1,
        f"a recording has a column order or frequency [Hz], one of the two, as {FORM}",
        "missing-column",
    )
    return given[0]


def _measured_peaks(columns: dict[str, tuple[int, str]], numbers: dict[str, FloatArray]) -> tuple[str, ComplexArray]:
    """Name of the recorded quantity, and its complex peak values in SI units, shape (n_rows,)."""
    if "real" in columns and "imag" in columns:
        quantity, factor = _quantity("real", columns["real"][1])
        _require(
            _quantity("imag", columns["imag"][1]) == (quantity, factor),
            "real and imag must have the same unit",
            "wrong-unit",
        )
        return quantity, np.asarray(factor * (numbers["real"] + 1j * numbers["imag"]))
    sizes = [name for name in PEAKS if name in columns]
    _require(
        len(sizes) == 1,
        f"a recording has one column of {', '.join(PEAKS)}, or real and imag, as {FORM}",
        "missing-column",
    )
    quantity, factor = _quantity(sizes[0], columns[sizes[0]][1])
    # Peak value from rms (sqrt 2) or peak to peak (1/2).
    values = np.asarray(factor * PEAKS[sizes[0]] * numbers[sizes[0]], dtype=np.complex128)
    if "phase" in columns:
        values *= np.exp(1j * numbers["phase"] * _factor(columns["phase"][1], "angle", "phase"))
    return quantity, values


def _quantity(name: str, unit: str) -> tuple[str, float]:
    for quantity in POWERS:
        try:
            return quantity, _factor(unit, quantity, name)
        except UsageError:
            continue
    text = f'"{unit}" is not a unit of torque, angle, speed or acceleration; write the heading as {name} [N*m]'
    raise UsageError(Fault(text, about=name, kind="wrong-unit"))


def _factor(unit: str, dimension: str, name: str) -> float:
    """Factor from the unit of a recording's column to the SI unit."""
    example = {"speed": "rpm", "angle": "deg", "frequency": "Hz"}.get(dimension, "N*m")
    if not unit or unit == "1":
        text = f"the column {name} has no unit; write its heading as {name} [{example}]"
        raise UsageError(Fault(text, about=name, kind="missing-unit"))
    try:
        return Value(name, dimension).coerce(f"1 {unit}")
    except EntryError:
        text = f'"{unit}" is no unit of the column {name}; write its heading as {name} [{example}]'
        raise UsageError(Fault(text, about=name, kind="wrong-unit")) from None


# Reader of text files with recorded orders or spectra from an order analysis.

DIALECT_LINES = 400
"""Number of lines from which separators and the first row of numbers are recognised, longer than any head."""


def read_order_table(path: Path) -> tuple[tuple[str, ...], tuple[tuple[float, ...], ...]]:
    """Headings with units, and rows of numbers, of a text file from an order analysis.

    Raises
    ------
    ModelError
        The file cannot be read; the message names the line.
    """
    with path.open(encoding=detect_encoding(path), newline=None, errors="replace") as file:
        lines = file.readlines()
    above = next((at for at, line in enumerate(lines) if line.strip() and not line.startswith(("#", "%"))), 0)
    body = lines[above:]
    dialect = detect_dialect(body[:DIALECT_LINES])
    first = data_start(dialect, body[:DIALECT_LINES])
    if first == min(len(body), DIALECT_LINES):
        raise _fault(
            "wrong-file", f"found no rows of numbers; expected {FORM} and rows below", path.name, above + 1, lines
        )
    heading = headings(dialect, body[:first], len(dialect.cells(body[first])))
    if not heading.lines:
        raise _fault(
            "missing-column",
            f"no heading; the first line says what the columns are: {FORM}",
            path.name,
            above + 1,
            lines,
        )
    reader = NumberRows(iter(body[first:]), path.name, dialect, len(heading.names), above + first + 1, heading.names)
    blocks = [np.column_stack(block) for block in reader.blocks(range(len(heading.names)), 0)]
    columns = tuple(
        f"{name} [{unit}]" if unit else name for name, unit in zip(heading.names, heading.units, strict=True)
    )
    rows = np.concatenate(blocks)
    try:
        if not np.isfinite(rows).all():
            raise UsageError("a number is missing; every row has one in each column", kind="not-a-number")
        measured_lines(columns, rows)
    except UsageError as error:
        raise _fault(error.kind, str(error), path.name, above + first, lines, error.fault.about) from None
    return columns, tuple(tuple(row) for row in rows.tolist())


def _fault(kind: str, text: str, file: str, number: int, lines: Sequence[str], heading: str = "") -> ModelError:
    """Error with a fault at a line of an order analysis file, counted from 1, or at a heading in it."""
    return ModelError([Fault(text, position=line_position(file, number, lines, heading), kind=kind)], file)


_NUMBER = Value("a number in the unit of its column", "1", lower=None)


@dataclass(frozen=True, kw_only=True)
class OrderTable(Declared):
    """Rows of recorded values by order or frequency, with or without speeds, under headings with units."""

    kind: ClassVar[str] = "table"
    article: ClassVar[str] = "a table"
    form: ClassVar[str] = f"{{columns: [{FORM}], rows: [[2, 35, 0], [4, 8, 90]]}}"

    columns: tuple[str, ...] = entry(
        Listed(
            "headings: order or frequency, speed; amplitude, rms or peak_to_peak, phase; or real and imag",
            Text("a heading", "a heading"),
            "a list of headings",
        )
    )
    rows: tuple[tuple[float, ...], ...] = entry(
        Listed("rows of numbers", Listed("numbers", _NUMBER, "a row of numbers"), "a list of rows")
    )

    def contradictions(self) -> list[Fault]:
        if not self.rows:
            return [Fault(f"a table has rows: {self.form}", ("rows",), on_key=True, kind="missing-entry")]
        for index, row in enumerate(self.rows):
            if len(row) != len(self.columns):
                text = f"the row has {len(row)} numbers, there are {len(self.columns)} columns"
                return [Fault(text, ("rows", index), kind="wrong-count")]
        try:
            self.lines  # noqa: B018
        except UsageError as error:
            return [replace(error.fault, path=("columns",), on_key=True)]
        return []

    @cached_property
    def lines(self) -> MeasuredLines:
        """Lines of the table by order or frequency, with their peak values over speed."""
        return measured_lines(self.columns, np.array(self.rows, dtype=float))


class OrderTableEntry(Nested[OrderTable]):
    """Entry for a table of orders or for the name of its file; written models hold the numbers."""

    def read(self, raw: object) -> tuple[Any, list[Fault]]:
        if not isinstance(raw, str | Path):
            return super().read(raw)
        try:
            columns, rows = read_order_table(raw if isinstance(raw, Path) else nearby_file(raw))
        except EntryError as error:
            return None, error.faults
        except ModelError as error:
            return None, list(error.faults)
        return OrderTable(columns=columns, rows=rows), []

    def definitions(self) -> Schema:
        schema = super().definitions()
        either: list[Json] = [{"type": "string"}, schema[self.name]]
        return {**schema, self.name: {"description": self.description, "anyOf": either}}


@register_excitation
@dataclass(frozen=True, kw_only=True)
class MeasuredExcitation(ReactingExcitation):
    """A torque or a motion on a node as it was recorded, by order or by frequency.

    Amplitudes are peak values unless the column says ``rms`` or ``peak_to_peak``; phases are those of a cosine,
    amplitude * cos(order * phi + phase). A recorded motion is imposed on the node. Without a column of speeds the table
    holds at all of them; with it, amplitude and phase run straight between the speeds of each order.

    Examples
    --------
    >>> pump = MeasuredExcitation(node="pump", table={"columns": ["order", "speed [rpm]", "amplitude [N*m]"],
    ...     "rows": [[7, 600, 10], [7, 900, 40]]})
    >>> pump.torques(np.array([750 * np.pi / 30])).amplitudes.real.round(9).tolist()
    [[[25.0]]]
    """

    kind: ClassVar[str] = "measured"

    node: str = entry(NodeName("the node it acts on", allow_ground=False))
    speed_of: str | None = entry(
        NodeName("the shaft of the orders and speeds; default: node", allow_ground=False), None
    )
    table: OrderTable = entry(
        OrderTableEntry(
            "the recording: a file such as orders.csv, or its numbers",
            lambda: OrderTable,
            "order_table",
            shown="orders.csv",
        )
    )

    @property
    def shaft(self) -> str:
        return str(self.speed_of or self.node)

    @property
    def quantity(self) -> str:
        return "torque" if self.table.lines.quantity == "torque" else "angle"

    @property
    def node_entries(self) -> tuple[tuple[EntryPath, str], ...]:
        return ((("node",), self.node),)

    def remarks(self, speeds: FloatArray | None) -> list[Fault]:
        lines = self.table.lines
        for key, at in zip(lines.keys.tolist(), lines.speeds, strict=bool(lines.speeds)):
            named = ("table", "rows", f"{'frequency' if lines.by_frequency else 'order'} {key:g}")
            faults = not_covered({named: tuple((float(speed), 0.0) for speed in at)}, speeds)
            if faults:
                return [replace(faults[0], path=("table", "rows"), on_key=True)]
        return []

    def torques(self, speeds: FloatArray) -> OrderTorques:
        faults = self.remarks(speeds)
        if faults:
            raise UsageError(faults[0].message)
        lines = self.table.lines
        none = np.zeros(len(lines.keys))
        orders, fixed = (none, lines.keys) if lines.by_frequency else (lines.keys, none)
        # omega = h Omega + 2 pi f of each line, which takes speeds and accelerations to angles.
        omega = speeds[:, None] * orders + 2 * np.pi * fixed
        values = np.stack([lines.at(place, speeds) for place in range(len(lines.keys))], axis=1)
        # x = v/(j omega) or a/(j omega)^2; angles and torques have power 0.
        amplitudes = values / (1j * omega) ** POWERS[lines.quantity]
        return OrderTorques(orders, self.nodes, amplitudes[:, :, None], fixed=fixed)
