"""A value that a quantity is compared with, which has to be in a unit of that quantity."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from torsionnet.core.entries.scalars import AnyNumber, read_value
from torsionnet.core.errors import Fault, Path
from torsionnet.core.expressions import Number
from torsionnet.core.units import DIMENSIONS, Dimension, UnitError, parse_unit


class ValueInUnit(float):
    """A number in SI, with the dimension in which it was written; None of a bare number."""

    dimension: Dimension | None = None


class QuantityValue(AnyNumber):
    """A number with the unit of the quantity; stored in SI."""

    def coerce(self, raw: Any) -> float:
        if isinstance(raw, ValueInUnit):
            return raw
        found = ValueInUnit(super().coerce(raw))
        value = read_value(raw)
        found.dimension = value.unit_dimension if isinstance(value, Number) else None
        return found


def wrong_unit(value: float | None, quantity: str, unit: str, path: Path) -> Iterator[Fault]:
    """A fault where a value is written in what no value of the quantity is in; a bare number is SI."""
    dimension = value.dimension if isinstance(value, ValueInUnit) else None
    try:
        own = parse_unit(unit).dimension if unit else DIMENSIONS["1"]
    except UnitError:  # dB, and what functions of a user say
        return
    if dimension is not None and dimension != own:
        shown = f"in {unit}" if unit else "a number without unit"
        yield Fault(f"{quantity} is {shown}, not in {dimension}", path)
