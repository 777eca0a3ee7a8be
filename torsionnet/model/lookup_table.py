"""Entry for tables of numbers over a key, as of parameters over speed or torque: ``{key: value}``."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any, ClassVar

from torsionnet.core.entries.scalars import plain_scalar, read_value
from torsionnet.core.entries.spec import EntryError, Json, Plural, Schema, reference
from torsionnet.core.errors import Fault
from torsionnet.core.expressions import Number
from torsionnet.core.piecewise_linear import Rows
from torsionnet.core.units import Dimension


class LookupTable(Plural[Rows]):
    """Entry for a table of numbers over a key in rising order.

    ``{100 rpm: 25 kN*m*s/rad, 150 rpm: 37 kN*m*s/rad}`` is stored as pairs.
    """

    is_read_off: ClassVar[bool] = True

    @property
    def absent(self) -> Rows:
        return ()

    @property
    def example(self) -> str:
        return "{100 rpm: 25 kN*m*s/rad, 150 rpm: 37 kN*m*s/rad}"

    def read(self, raw: object) -> tuple[Rows, list[Fault]]:
        if isinstance(raw, tuple) and all(isinstance(row, tuple) and isinstance(row[0], Number) for row in raw):
            return raw, []
        if not isinstance(raw, Mapping) or len(raw) < 2:
            return (), [Fault(f"expected two rows or more, as in {self.example}; got {raw!r}")]
        found: list[tuple[Number, Number]] = []
        faults: list[Fault] = []
        for key, value in raw.items():
            try:
                found.append((self.key(key), self.value(value)))
            except EntryError as error:
                faults.append(Fault(error.fault.message, (key,)))
        found.sort(key=lambda row: row[0].value)
        twice = [second for first, second in pairwise(found) if first[0].value == second[0].value]
        faults += [Fault(f"{key} stands twice in the table; keep one row") for key, _ in twice]
        faults += self.unit_faults(found)
        return ((), faults) if faults else (tuple(found), [])

    def key(self, raw: object) -> Number:
        """Number with its unit that is the key of a table row."""
        return _number(raw)

    def value(self, raw: object) -> Number:
        """Number with its unit that is the value of a table row."""
        return _number(raw)

    def unit_faults(self, rows: list[tuple[Number, Number]]) -> list[Fault]:
        """Faults of table rows that have units of different kinds."""
        if len({value.unit_dimension for _, value in rows}) > 1:
            return [Fault("the values of a table must have units of one kind")]
        return []

    def plain(self, value: Any) -> Json:
        return {str(key): plain_scalar(one) for key, one in value}

    def schema(self) -> Schema:
        return {
            "type": "object",
            "description": self.description,
            "minProperties": 2,
            "additionalProperties": reference("scalar"),
        }

    @property
    def accepted(self) -> str:
        return "NumberByNumber"


def _number(raw: object) -> Number:
    value = read_value(raw)
    if not isinstance(value, Number):
        raise EntryError(f'expected a number with unit; "{raw}" is an expression of parameters')
    return value


def wrong_key(rows: Rows, wanted: Dimension) -> Number | None:
    """First key of a table that has another dimension or is below zero, or None."""
    return next((key for key, _ in rows if key.unit_dimension not in (None, wanted) or key.value < 0), None)
