"""Warnings about values of unlikely size, as millimetres without their unit or percent for a fraction."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import TypeAlias

from torsionnet.core.damping import DampingMeasure
from torsionnet.core.entries.scalars import QuantityKind
from torsionnet.core.errors import Fault, Path
from torsionnet.core.expressions import Expression, ExpressionError, Number
from torsionnet.core.units import expected_unit
from torsionnet.model.definition import Definition
from torsionnet.model.element_base.damping_entries import LossFactor
from torsionnet.model.elements import Element

Numbers: TypeAlias = Mapping[str, Fraction | float]

LIKELY_UNITS = {
    "length": ("mm", 1e-3),
    "shear modulus": ("GPa", 1e9),
    "pressure": ("GPa", 1e9),
    "density": ("g/cm^3", 1e3),
    "force": ("kN", 1e3),
}
"""Unit that is likely meant where a number has none, and its size in SI units, by dimension."""
USUAL_SIZES = {"length": (1e-4, 20.0), "shear modulus": (1e5, 1e12), "pressure": (1e5, 1e12)}
"""Smallest and largest usual size in machinery in SI units, by dimension, where an entry has no range of its own."""
PERCENT_FROM = {"zeta": 1.0, "eta": 2.0}
"""Value from which a damping measure was likely written in percent, by name of the measure."""


def unusual_sizes(definition: Definition, numbers: Numbers) -> list[Fault]:
    """Warnings about values outside the usual range of their entry, or likely in another unit."""
    return [fault for element in definition.elements.values() for fault in _of(element, numbers)]


def _of(element: Element, numbers: Numbers) -> Iterator[Fault]:
    for entry, (spec, value) in element.scalars().items():
        path: Path = ("elements", element.name, entry)
        if isinstance(value, DampingMeasure):
            text = _percent(value, numbers)
            path = (*path, value.measure)
        elif isinstance(spec, LossFactor):
            text = _percent(DampingMeasure("eta", value, None), numbers)
        else:
            text = _unusual(spec, value, numbers) if isinstance(spec, QuantityKind) else None
        if text:
            yield Fault(text, path, "warning")


def _unusual(spec: QuantityKind[object], value: Expression, numbers: Numbers) -> str | None:
    usual = spec.usual or USUAL_SIZES.get(spec.dimension)
    size = _size(value, numbers) if usual else None
    if usual is None or size is None or size == 0 or usual[0] <= abs(size) <= usual[1]:
        return None
    low, high = usual
    unit = expected_unit(spec.dimension)
    text = f"{spec.description.partition(',')[0]} of {size:g} {unit}: usual are {low:g} to {high:g} {unit}"
    meant, factor = LIKELY_UNITS.get(spec.dimension, ("", 1.0))
    bare = isinstance(value, Number) and value.unit_dimension is None
    if meant and bare and low <= size * factor <= high:
        text += f'; a number without unit is in {unit}: did you mean "{size:g} {meant}"?'
    return text


def _percent(value: DampingMeasure, numbers: Numbers) -> str | None:
    size, limit = _size(value.value, numbers), PERCENT_FROM.get(value.measure)
    if size is None or limit is None or size < limit:
        return None
    return f"{value.measure} = {size:g} is {100 * size:g} %; did you mean {size / 100:g}?"


def _size(value: Expression, numbers: Numbers) -> float | None:
    if not value.names <= numbers.keys():
        return None
    try:
        return float(value.evaluate(numbers))
    except (ExpressionError, OverflowError):
        return None
