"""Entry for tables over speed, interpolated linearly between their rows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from torsionnet.base.entries.scalars import SCALAR_SCHEMA, Value
from torsionnet.base.entries.spec import EntryError, Json, Schema, Spec, coerce_part
from torsionnet.base.errors import EntryPath, Fault, UsageError, got
from torsionnet.base.units import RPM
from torsionnet.machinery.excitations.order_excitation import FloatArray

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
            raise EntryError(f"expected {self.example}, {got(raw)}")
        rows = tuple(self._row(index, row) for index, row in enumerate(raw))
        for index in range(1, len(rows)):
            if rows[index][0] < rows[index - 1][0]:
                raise EntryError("the speeds of a table rise from row to row", (index,))
        return rows

    def _row(self, index: int, row: Any) -> tuple[float, float]:
        if not isinstance(row, list | tuple) or len(row) != 2:
            raise EntryError(f"expected a row [speed, value], {got(row)}", (index,))
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
    return [Fault(text, path) for path, text in texts.items() if text]


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
        raise UsageError(text)
    at, values = np.array(table).T
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
