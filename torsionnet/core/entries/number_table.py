"""Entries that hold rows of numbers, whose first column rises from row to row."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

from torsionnet.core.entries.scalars import SCALAR_SCHEMA, plain_scalar, read_scalar
from torsionnet.core.entries.spec import EntryError, Json, Schema, Spec, Stored_co
from torsionnet.core.expressions import Number
from torsionnet.core.number_range import is_beyond_range
from torsionnet.core.piecewise_linear import Rows


class RowColumn(NamedTuple):
    """Name, dimension and allowed signs of the values in one column of a table of numbers."""

    name: str
    dimension: str = "1"
    negative: bool = True
    zero: bool = True


@dataclass(frozen=True, eq=False, repr=False)
class NumberTable(Spec[Stored_co]):
    """Entry of rows ``[[0 rad/s, 40 N*m], [10 rad/s, 36 N*m]]`` whose first column rises."""

    columns: tuple[RowColumn, ...] = ()
    fewest: int = 1

    @property
    def example(self) -> str:
        return f"rows {self._row_text}" + (f", at least {self.fewest}" if self.fewest > 1 else "")

    @property
    def _row_text(self) -> str:
        return f"[{', '.join(column.name for column in self.columns)}]"

    def rows(self, raw: object) -> Rows:
        """Rows of numbers that an entry gives, one number for each column, exact and in SI units."""
        rows = tuple(self._row(row, index) for index, row in enumerate(self.listed(raw)))
        for index, (row, following) in enumerate(pairwise(rows), 1):
            if following[0].value <= row[0].value:
                raise EntryError(f"the {self.columns[0].name} must increase from row to row", (index, 0))
        return rows

    def listed(self, raw: object) -> Sequence[object]:
        """Rows of an entry as they are written, of which there are as many as the table needs."""
        raw = raw.tolist() if hasattr(raw, "tolist") else raw
        if isinstance(raw, str | Mapping) or not isinstance(raw, Sequence) or len(raw) < self.fewest:
            written = _as_rows(raw) if isinstance(raw, Mapping) else ""
            raise EntryError(f"expected {self.example}{written}; got {'nothing' if raw is None else repr(raw)}")
        return raw

    def _row(self, row: object, index: int) -> tuple[Number, ...]:
        if isinstance(row, str) or not isinstance(row, Sequence) or len(row) != len(self.columns):
            raise EntryError(f"a row is {self._row_text}, got {'nothing' if row is None else repr(row)}", (index,))
        return tuple(self._cell(cell, index, place) for place, cell in enumerate(row))

    def _cell(self, cell: object, index: int, place: int) -> Number:
        column = self.columns[place]
        try:
            value = cell if isinstance(cell, Number) else read_scalar(cell, column.dimension)
        except EntryError as error:
            raise EntryError(error.fault.under(index, place)) from None
        if not isinstance(value, Number):
            raise EntryError("a table holds numbers, not expressions", (index, place))
        if not column.negative and value.value < 0:
            raise EntryError(f"{column.name} must not be negative", (index, place))
        if not column.zero and value.value == 0:
            raise EntryError(f"{column.name} must be greater than 0", (index, place))
        if is_beyond_range(float(value.value)):
            text = f"{float(value.value):g} is far outside the sizes of drivetrains; check its unit"
            raise EntryError(text, (index, place))
        return value

    def plain(self, value: Any) -> Json:
        return [[plain_scalar(cell) for cell in row] for row in value]

    def schema(self) -> Schema:
        count = len(self.columns)
        row: Schema = {"type": "array", "items": SCALAR_SCHEMA, "minItems": count, "maxItems": count}
        return {"type": "array", "items": row, "minItems": self.fewest, "description": self.description}

    @property
    def accepted(self) -> str:
        return "NumberRows"


def _as_rows(raw: Mapping[object, object]) -> str:
    """Words that tell the first pairs of a mapping as rows, which other entries with a value over another one take."""
    first = [f"[{key}, {value}]" for key, value in [*raw.items()][:2]]
    return f", as [{', '.join(first)}{', ...' if len(raw) > len(first) else ''}]" if first else ""
