"""Values of a parameter over the speed or torque that it depends on."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from torsionnet.core.entries.scalars import plain_scalar, read_value
from torsionnet.core.entries.spec import EntryError, Schema, Spec, reference
from torsionnet.core.errors import Fault, UsageError
from torsionnet.core.expressions import Number
from torsionnet.core.units import Dimension

Rows = tuple[tuple[Number, Number], ...]


@dataclass(frozen=True, eq=False, repr=False)
class LookupTable(Spec):
    """``{100 rpm: 25 kN*m*s/rad, 150 rpm: 37 kN*m*s/rad}``, stored as pairs by rising first value."""

    @property
    def absent(self) -> Rows:
        return ()

    @property
    def example(self) -> str:
        return "{100 rpm: 25 kN*m*s/rad, 150 rpm: 37 kN*m*s/rad}"

    def read(self, raw: Any) -> tuple[Rows, list[Fault]]:
        if isinstance(raw, tuple):
            return raw, []
        if not isinstance(raw, Mapping) or len(raw) < 2:
            return (), [Fault(f"expected two rows or more, as in {self.example}; got {raw!r}")]
        found: list[tuple[Number, Number]] = []
        faults: list[Fault] = []
        for key, value in raw.items():
            try:
                found.append((_number(key), _number(value)))
            except EntryError as error:
                faults.append(Fault(error.fault.message, (key,)))
        found.sort(key=lambda row: row[0].value)
        twice = [second for first, second in pairwise(found) if first[0].value == second[0].value]
        faults += [Fault(f"{key} stands twice in the table") for key, _ in twice]
        if len({value.unit_dimension for _, value in found}) > 1:
            faults.append(Fault("the values of a table have one unit, or units of one kind"))
        return ((), faults) if faults else (tuple(found), [])

    def plain(self, value: Any) -> Any:
        return {str(key): plain_scalar(one) for key, one in value}

    def schema(self) -> Schema:
        return {
            "type": "object",
            "description": self.description,
            "minProperties": 2,
            "additionalProperties": reference("scalar"),
        }


def _number(raw: Any) -> Number:
    value = read_value(raw)
    if not isinstance(value, Number):
        raise EntryError(f'expected a number with unit; "{raw}" is an expression of parameters')
    return value


def wrong_key(rows: Rows, wanted: Dimension) -> Number | None:
    """The first key that has another dimension, or is below zero."""
    return next((key for key, _ in rows if key.unit_dimension not in (None, wanted) or key.value < 0), None)


def interpolated(rows: Rows, at: float) -> float:
    """The value at ``at``, by straight lines between the rows.

    Raises
    ------
    UsageError
        It lies outside.

    >>> rows = ((Number(1), Number(10)), (Number(3), Number(30)))
    >>> interpolated(rows, 2.5)
    25.0
    """
    keys = [float(key.value) for key, _ in rows]
    slack = 1e-9 * keys[-1]
    if not keys[0] - slack <= at <= keys[-1] + slack:
        raise UsageError(f"the table goes from {rows[0][0]} to {rows[-1][0]}")
    place = min(max(bisect_right(keys, at), 1), len(keys) - 1)
    before, after = keys[place - 1 : place + 1]
    lower, upper = (float(value.value) for _, value in rows[place - 1 : place + 1])
    return lower + (upper - lower) * (at - before) / (after - before)
