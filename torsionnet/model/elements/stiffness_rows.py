"""The rows of a measured dynamic stiffness as an entry."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from torsionnet.core.entries.scalars import SCALAR_SCHEMA, read_scalar
from torsionnet.core.entries.spec import EntryError, Schema, Spec
from torsionnet.core.expressions import Number
from torsionnet.core.units import is_beyond_range
from torsionnet.model.elements.stiffness_table import StiffnessTable

_COLUMNS = (("frequency", "frequency"), ("stiffness", "stiffness"), ("damping", "damping"))


@dataclass(frozen=True, eq=False, repr=False)
class TableEntry(Spec):
    """Rows [frequency, stiffness, damping] of a measured dynamic stiffness."""

    def coerce(self, raw: Any) -> StiffnessTable:
        if isinstance(raw, StiffnessTable):
            return raw
        raw = raw.tolist() if hasattr(raw, "tolist") else raw
        if isinstance(raw, str) or not isinstance(raw, Sequence) or not raw:
            raise EntryError(
                f"expected rows [frequency, stiffness, damping], got {'nothing' if raw is None else repr(raw)}"
            )
        rows = [self._row(row, index) for index, row in enumerate(raw)]
        for index in range(1, len(rows)):
            if rows[index][0] <= rows[index - 1][0]:
                raise EntryError("the frequencies of the table must increase from row to row", (index, 0))
        return StiffnessTable(*(tuple(column) for column in zip(*rows, strict=True)))

    def _row(self, row: Any, index: int) -> tuple[float, ...]:
        if isinstance(row, str) or not isinstance(row, Sequence) or len(row) != len(_COLUMNS):
            raise EntryError(
                f"a row of the table is [frequency, stiffness, damping], got {'nothing' if row is None else repr(row)}",
                (index,),
            )
        return tuple(self._cell(cell, index, column) for column, cell in enumerate(row))

    @staticmethod
    def _cell(cell: Any, index: int, column: int) -> float:
        try:
            value = read_scalar(cell, _COLUMNS[column][1])
        except EntryError as error:
            raise EntryError(error.fault.under(index, column)) from None
        if not isinstance(value, Number):
            raise EntryError("a table holds numbers, not expressions", (index, column))
        if column < 2 and value.value < 0:
            raise EntryError(f"{_COLUMNS[column][0]} must not be negative", (index, column))
        size = float(value.value)
        if is_beyond_range(size):
            raise EntryError(f"{size:g} is no size that anything in a drivetrain has", (index, column))
        return size

    def plain(self, value: Any) -> Any:
        return [list(row) for row in zip(value.frequencies, value.stiffness, value.damping, strict=True)]

    def schema(self) -> Schema:
        row = {"type": "array", "items": SCALAR_SCHEMA, "minItems": 3, "maxItems": 3}
        return {"type": "array", "items": row, "minItems": 1, "description": self.description}
