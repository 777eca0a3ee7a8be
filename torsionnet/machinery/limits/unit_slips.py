"""Check of values of one dimension in one limit that are far from each other in size, as a unit was left out."""

from __future__ import annotations

from collections.abc import Iterator

from torsionnet.base.entries.scalars import Value
from torsionnet.base.errors import Fault
from torsionnet.base.units import expected_unit
from torsionnet.machinery.limits.limit import Limit

UNIT_SLIP_RATIO = 100.0
"""Ratio of two values of one limit from which a unit was probably left out, as torques of a coupling differ less: by 10
at most, a forgotten prefix makes 1000."""
PREFIXES = {"torque": (1e3, "kN*m"), "power": (1e3, "kW"), "pressure": (1e6, "MPa")}
"""Factor and name of the unit that is likely meant in a limit, by dimension."""


def unit_slips(limit: Limit) -> Iterator[Fault]:
    """Warnings about values that are less than a hundredth of another of the same limit."""
    kin: dict[str, dict[str, float]] = {}
    for name, spec in limit.specs():
        value = getattr(limit, name)
        if isinstance(spec, Value) and spec.dimension in PREFIXES and isinstance(value, float) and value > 0:
            kin.setdefault(spec.dimension, {})[name] = value
    for dimension, values in kin.items():
        largest = max(values, key=lambda name: values[name])
        for name, value in values.items():
            if value * UNIT_SLIP_RATIO < values[largest]:
                yield _unlike(dimension, name, value, largest, values[largest])


def _unlike(dimension: str, name: str, value: float, largest: str, most: float) -> Fault:
    unit, (factor, likely) = expected_unit(dimension), PREFIXES[dimension]
    text = f"{name} of {value:g} {unit} beside {largest} of {most:g} {unit}"
    meant = f"{value:g} {likely}" if value * factor <= most * UNIT_SLIP_RATIO / 10 else ""
    text += f'; a number without unit is in {unit}: did you mean "{meant}"?' if meant else ""
    return Fault(text, (name,), "warning", meant=meant)
