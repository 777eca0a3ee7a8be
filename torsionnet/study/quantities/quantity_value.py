"""A value that a quantity is compared with, which has to be in a unit of that quantity."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from torsionnet.core.entries.scalars import AnyNumber, read_value
from torsionnet.core.errors import Fault, Path
from torsionnet.core.expressions import Number
from torsionnet.core.units import CELSIUS, DIMENSIONS, Dimension, UnitError, parse_unit


class ValueInUnit(float):
    """A number in SI, with the dimension and the unit in which it was written; none of a bare number."""

    dimension: Dimension | None = None
    unit: str = ""


class QuantityValue(AnyNumber):
    """A number with the unit of the quantity; stored in SI."""

    def coerce(self, raw: Any) -> float:
        if isinstance(raw, ValueInUnit):
            return raw
        found = ValueInUnit(super().coerce(raw))
        value = read_value(raw)
        if isinstance(value, Number):
            found.dimension = value.unit_dimension
            found.unit = "" if value.unit_written == CELSIUS else value.unit_written
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


def as_written(value: float, unit: str) -> str:
    """A value with the unit in which it was written, else with that of its quantity, in SI.

    >>> as_written(QuantityValue("limit").coerce("0.5 deg/(N*m)"), "rad/(N*m)"), as_written(0.1, "")
    ('0.5 deg/(N*m)', '0.1')
    """
    written = value.unit if isinstance(value, ValueInUnit) else ""
    shown = value / float(parse_unit(written).factor) if written else value
    return f"{shown:g} {written or unit}".rstrip()
