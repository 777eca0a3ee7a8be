"""Allowed values of a limit, one for all speeds or tables over speed or speed ratio."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, cast

import numpy as np

from torsionnet.base.entries.scalars import SCALAR_SCHEMA, Value, ValueInUnitOfUse
from torsionnet.base.entries.spec import EntryError, Json, Plural, Schema
from torsionnet.base.errors import Fault, got
from torsionnet.base.expressions import Number
from torsionnet.linear.frequency_response import FloatArray

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
            return (), [Fault(f"expected two points or more, {self.example}; {got(raw)}")]
        found: dict[float, Number] = {}
        faults: list[Fault] = []
        for key, value in raw.items():
            try:
                at = _KEYS[self.over].coerce(key)
            except EntryError as error:
                faults.append(replace(error.fault, path=(key,), on_key=True))
                continue
            if at in found:
                faults.append(Fault(f"{key} stands twice", (key,), on_key=True))
            allowed, wrong = ALLOWED.read(value)
            faults += [fault.under(key) for fault in wrong]
            found[at] = cast("Number", allowed)
        return (() if faults else tuple(sorted(found.items(), key=lambda pair: pair[0]))), faults

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
    keys, values = (np.array([float(part) for part in column]) for column in zip(*_plain(pairs), strict=True))
    slack = 1e-9 * keys[-1]
    inside = (at >= keys[0] - slack) & (at <= keys[-1] + slack)
    return np.asarray(np.where(inside, np.interp(at, keys, values), np.nan))


def _plain(pairs: Pairs) -> list[tuple[float, float]]:
    return [(key, float(value.value)) for key, value in pairs]
