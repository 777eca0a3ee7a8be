"""Characteristics: rows of plain numbers over one of them, straight between the rows."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeAlias

from torsionnet.core.entries.scalars import SCALAR_SCHEMA, plain_scalar, read_scalar
from torsionnet.core.entries.spec import EntryError, Schema, Spec
from torsionnet.core.expressions import Number
from torsionnet.core.units import is_beyond_range

Rows: TypeAlias = tuple[tuple[Number, ...], ...]


@dataclass(frozen=True, eq=False, repr=False)
class Characteristic(Spec):
    """Rows ``[[0 rad/s, 40 N*m], [10 rad/s, 36 N*m]]`` whose first column rises."""

    columns: tuple[tuple[str, str], ...]
    """Name and dimension of each column."""

    @property
    def example(self) -> str:
        return f"rows {self._row_text}, at least two"

    @property
    def _row_text(self) -> str:
        return f"[{', '.join(name for name, _ in self.columns)}]"

    def coerce(self, raw: Any) -> Rows:
        raw = raw.tolist() if hasattr(raw, "tolist") else raw
        if isinstance(raw, str) or not isinstance(raw, Sequence) or len(raw) < 2:
            raise EntryError(f"expected {self.example}; got {'nothing' if raw is None else repr(raw)}")
        rows = tuple(self._row(row, index) for index, row in enumerate(raw))
        for index in range(1, len(rows)):
            if rows[index][0].value <= rows[index - 1][0].value:
                raise EntryError(f"the {self.columns[0][0]} rises from row to row", (index, 0))
        return rows

    def _row(self, row: Any, index: int) -> tuple[Number, ...]:
        if isinstance(row, str) or not isinstance(row, Sequence) or len(row) != len(self.columns):
            shown = "nothing" if row is None else repr(row)
            raise EntryError(f"a row is {self._row_text}, got {shown}", (index,))
        return tuple(self._cell(cell, index, column) for column, cell in enumerate(row))

    def _cell(self, cell: Any, index: int, column: int) -> Number:
        try:
            value = cell if isinstance(cell, Number) else read_scalar(cell, self.columns[column][1])
        except EntryError as error:
            raise EntryError(error.fault.under(index, column)) from None
        if not isinstance(value, Number):
            raise EntryError("a table holds numbers, not expressions", (index, column))
        if is_beyond_range(float(value.value)):
            raise EntryError(f"{float(value.value):g} is no size that anything in a drivetrain has", (index, column))
        return value

    def plain(self, value: Any) -> Any:
        return [[plain_scalar(cell) for cell in row] for row in value]

    def schema(self) -> Schema:
        count = len(self.columns)
        row = {"type": "array", "items": SCALAR_SCHEMA, "minItems": count, "maxItems": count}
        return {"type": "array", "items": row, "minItems": 2, "description": self.description}


def outside(rows: Rows, at: float) -> str:
    """Why a table has no value there, or an empty text."""
    if rows[0][0].value <= exact_number(at) <= rows[-1][0].value:
        return ""
    return f"the table goes from {rows[0][0]} to {rows[-1][0]}"


def value_at(rows: Rows, at: float, column: int = 1) -> Number:
    """The value at ``at``, which lies in the table.

    >>> rows = ((Number(Fraction(1)), Number(Fraction(10))), (Number(Fraction(3)), Number(Fraction(30))))
    >>> value_at(rows, 2.5).value, slope_at(rows, 2.5).value
    (Fraction(25, 1), Fraction(10, 1))
    """
    lower = _piece(rows, at)[0]
    return Number(lower[column].value + slope_at(rows, at, column).value * (exact_number(at) - lower[0].value))


def slope_at(rows: Rows, at: float, column: int = 1) -> Number:
    """The slope at ``at``; at a row that of the piece above it, at the last row that of the last piece."""
    lower, upper = _piece(rows, at)
    return Number((upper[column].value - lower[column].value) / (upper[0].value - lower[0].value))


def exact_number(value: float) -> Fraction:
    """The decimal fraction that a number was written as."""
    return Fraction(repr(float(value)))


def _piece(rows: Rows, at: float) -> tuple[tuple[Number, ...], tuple[Number, ...]]:
    place = bisect_right([row[0].value for row in rows], exact_number(at))
    place = min(max(place, 1), len(rows) - 1)
    return rows[place - 1], rows[place]
