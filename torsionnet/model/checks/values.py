"""Checks of the dimensions and sizes of values.

Here as well: warnings about values of unlikely size, as millimetres without their unit or percent for a fraction; units
of parameters.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import Any

from torsionnet.base.entries.scalars import QuantityKind
from torsionnet.base.errors import IN_UNIT, WRITE, EntryPath, Fault, Remedy, TorsionnetError, message_of
from torsionnet.base.expressions import Compound, Expression, ExpressionError, Name, Number, is_beyond_range
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.base.units import DIMENSIONS, Dimension, expected_unit
from torsionnet.model.damping import MEASURES, DampingMeasure, DampingQuantity, LossFactor
from torsionnet.model.definition import ELEMENTS, SCENARIOS, Definition
from torsionnet.model.elements import Element, Law, Values
from torsionnet.model.parameters import dimensions

Numbers = Mapping[str, "Fraction | float"]


def wrong_dimensions(definition: Definition) -> list[Fault]:
    """Faults of expressions whose dimension is not that of their entry."""
    known, faults = dimensions(definition.parameters)
    for table in (ELEMENTS, SCENARIOS):
        for name, section in getattr(definition, table).items():
            for path, _, expression, wanted in section.expressions():
                if not wanted or not expression.names or not expression.names <= known.keys():
                    continue
                try:
                    dimension = expression.dimension(known)
                except ExpressionError as error:
                    faults.append(error.fault.under(table, name, *path))
                    continue
                if dimension is not None and dimension != DIMENSIONS[wanted]:
                    faults.append(_other_dimension(expression, dimension, wanted).under(table, name, *path))
    return faults


def parameter_dimensions(definition: Definition) -> list[Fault]:
    """Faults of alternatives that give a parameter a value of another dimension, and of its bounds."""
    known, _ = dimensions(definition.parameters)
    faults = []
    for axis, alternatives in definition.configurations.items():
        for label, overlay in alternatives.items():
            for name, value in overlay.parameters.items():
                fault = _overlay_fault(value, known.get(name), known)
                if fault:
                    faults.append(fault.under("configurations", axis, label, name))
    for name, parameter in definition.parameters.items():
        wanted = known.get(name)
        for index, dimension in enumerate(getattr(parameter.bounds, "dimensions", ())):
            if wanted is not None and dimension is not None and dimension != wanted:
                text = f"this bound has the dimension of {dimension}; the parameter is in {wanted}"
                faults.append(Fault(text, ("parameters", name, "bounds", index), kind="wrong-unit"))
    return faults


def _other_dimension(expression: Expression, dimension: Dimension, wanted: str) -> Fault:
    inverse = _inverse(expression) if dimension * DIMENSIONS[wanted] == DIMENSIONS["1"] else ""
    expected = "a plain number" if wanted == "1" else f"{wanted} in {expected_unit(wanted)}"
    text = phrase('"{}" has the dimension of {}; expected {}', expression, dimension, expected)
    if inverse:
        text = phrase("{}; write {}", text, inverse)
    return Fault(text, remedy=Remedy(WRITE, inverse, old=str(expression)) if inverse else None, kind="wrong-unit")


def _inverse(expression: Expression) -> str:
    if isinstance(expression, Compound) and expression.sign == "/" and str(expression.operands[0]) == "1":
        return phrase("{}", expression.operands[1])
    return phrase("1/{}" if str(expression) in expression.names else "1/({})", expression)


def _overlay_fault(value: Expression, base: Dimension | None, known: Mapping[str, Dimension | None]) -> Fault | None:
    if not value.names <= known.keys():
        return None
    try:
        dimension = value.dimension(known)
    except ExpressionError as error:
        return error.fault
    if dimension is None or base is None or dimension == base:
        return None
    text = phrase('"{}" has the dimension of {}; the parameter is in {}', value, dimension, base)
    return Fault(text, remedy=Remedy(IN_UNIT, str(base), old=str(value)), kind="wrong-unit")


def impossible_sizes(definition: Definition, numbers: Numbers) -> list[Fault]:
    """Faults of values out of their bounds, not finite or not calculable, for resolved parameters."""
    faults: list[Fault] = []
    for name, value in numbers.items():
        bounds = definition.parameters[name].bounds
        if bounds and not bounds[0] <= float(value) <= bounds[1]:  # as written: 0.05 is a bound, and 1/20 a value
            said = "{} = {:g} is outside its bounds {:g} to {:g}"
            text = phrase(said, ModelName(name), float(value), *bounds)
            faults.append(Fault(text, ("parameters", name), "warning", causes=(name,), kind="out-of-range"))
    for element in definition.elements.values():
        of_entries = [
            fault.under("elements", element.name, *path)
            for path, spec, expression, wanted in element.expressions()
            if (fault := _size_fault(spec, expression, numbers, measure=is_in_measure(spec, path), wanted=wanted))
        ]
        faults += of_entries or _law_sizes(element, numbers)
    for entry, table in (("speed", definition.operating_point.speed), ("torque", definition.operating_point.torque)):
        for node, expression in table.items():
            if fault := _size_fault(None, expression, numbers, measure=False, wanted=entry):
                faults.append(fault.under("operating_point", entry, node))
    for name, scenario in definition.scenarios.items():
        for path, spec, expression, wanted in scenario.expressions():
            if fault := _size_fault(spec, expression, numbers, measure=False, wanted=wanted):
                faults.append(fault.under("scenarios", name, *path))
    return faults


def is_in_measure(spec: object, path: EntryPath) -> bool:
    """Whether an entry is part of a damping measure."""
    return isinstance(spec, DampingQuantity | LossFactor) and path[-1] in (*MEASURES, "at")


def _size_fault(spec: object, expression: Expression, numbers: Numbers, *, measure: bool, wanted: str) -> Fault | None:
    if not expression.names <= numbers.keys():
        return None
    causes = tuple(sorted(expression.names))
    try:
        value = float(expression.evaluate(numbers))
    except (ExpressionError, OverflowError) as error:
        return Fault(
            phrase("{} cannot be calculated: {}", expression, message_of(error)),
            causes=causes,
            kind="incalculable-value",
        )
    if not math.isfinite(value):
        return Fault(phrase("{} is not a finite number", expression), causes=causes, kind="not-finite")
    if is_beyond_range(value):
        said = "{} = {:g} is far outside the sizes of drivetrains; check its unit"
        return Fault(phrase(said, expression, value), causes=causes, kind="not-finite")
    reason = wrong_size(spec, value, measure=measure, wanted=wanted)
    if reason is None:
        return None
    shown = phrase("{} = {:g}", expression, value) if expression.names else f"{value:g}"
    text = phrase("{}: {} {}", shown, spec.description if isinstance(spec, QuantityKind) else "", reason)
    if measure:
        text = phrase("{} {}: {}", "the frequency" if wanted == "frequency" else "the damping", shown, reason)
    return Fault(text, causes=causes, kind="out-of-range")


def wrong_size(spec: object, value: Any, *, measure: bool, wanted: str) -> str | None:
    """Message that a finite value in an entry is out of bounds, or None; ``value`` can be compared with numbers."""
    if measure:
        positive = wanted == "frequency" or not isinstance(spec, DampingQuantity)
        bad = value < 0 or (positive and value == 0)
        return f"must {'be greater than' if positive else 'not be less than'} 0" if bad else None
    return spec.bound_fault(value) if isinstance(spec, QuantityKind) else None


def _law_sizes(element: Element, numbers: Numbers) -> list[Fault]:
    """Faults of negative coefficients of an element's laws, a safety net behind the bounds of single fields."""
    if not all(expression.names <= numbers.keys() for _, _, expression, _ in element.expressions()):
        return []
    place = ("elements", element.name)
    try:
        faults = element.value_faults(Values(numbers))
        if faults:
            return [fault.under("elements", element.name) for fault in faults]
        laws = [part for part in element.parts(Values(numbers)) if isinstance(part, Law)]
    except ZeroDivisionError:
        text = phrase("{} cannot be calculated: something is divided by zero", ModelName(element.name))
        return [Fault(text, place, kind="incalculable-value")]
    except (TorsionnetError, ArithmeticError) as error:
        names = {name for _, _, expression, _ in element.expressions() for name in expression.names}
        text = phrase("{} cannot be calculated: {}", ModelName(element.name), message_of(error))
        return [Fault(text, place, causes=tuple(sorted(names)), kind="incalculable-value")]
    if negative_laws(element, laws):
        text = phrase("the values of {} give it a negative inertia, damping or stiffness", ModelName(element.name))
        return [Fault(text, place, kind="negative-law")]
    damping = min((law.damping for law in laws), default=0)
    if damping < 0:
        said = "{} drives vibrations here: its damping is {:.4g} N*m*s/rad"
        return [Fault(phrase(said, ModelName(element.name), float(damping)), place, "note", kind="negative-law")]
    return []


def negative_laws(element: Element, laws: Iterable[Law]) -> bool:
    """Whether one of the element's laws has a coefficient below zero that the element may not have."""
    return any(
        law.inertia < 0 or law.stiffness < 0 or law.loss_factor < 0 or (law.damping < 0 and not element.may_feed)
        for law in laws
    )


def passive_tables(definition: Definition) -> list[Fault]:
    """Warnings about tabulated damping below zero, which would feed energy into a vibration."""
    return [
        Fault(
            phrase(
                "the damping of {} is negative at some frequency; it would drive the vibration there", ModelName(name)
            ),
            ("elements", name, "table"),
            "warning",
            kind="negative-law",
        )
        for name, element in definition.elements.items()
        for entry, (_, value) in element.scalars().items()
        if entry == "table" and not getattr(value, "is_passive", True)
    ]


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
    faults = []
    for name, element in definition.elements.items():
        for entry, (spec, value) in element.scalars().items():
            path: EntryPath = ("elements", name, entry)
            text, meant = "", ""
            if isinstance(value, DampingMeasure):
                text, meant = _percent(value, numbers)
                path = (*path, value.measure)
            elif isinstance(spec, LossFactor):
                text, meant = _percent(DampingMeasure("eta", value, None), numbers)
            elif isinstance(spec, QuantityKind) and (usual := spec.usual or USUAL_SIZES.get(spec.dimension)):
                size, (low, high) = _size(value, numbers), usual
                if not size or low <= abs(size) <= high:
                    continue
                unit = expected_unit(spec.dimension)
                text = f"{entry.replace('_', ' ')} of {size:g} {unit}: usual are {low:g} to {high:g} {unit}"
                # A number without unit may be meant in that of drawings.
                likely, factor = LIKELY_UNITS.get(spec.dimension, ("", 1.0))
                bare = isinstance(value, Number) and value.unit_dimension is None
                if likely and bare and low <= size * factor <= high:
                    meant = f"{size:g} {likely}"
                    text = f'{text}; a number without unit is in {unit}: did you mean "{meant}"?'
            if text:
                faults.append(Fault(text, path, "warning", meant=meant, kind="implausible-size"))
    return faults


def _percent(value: DampingMeasure, numbers: Numbers) -> tuple[str, str]:
    """Message on a damping measure that was likely given in percent, and its share; else both empty."""
    size, limit = _size(value.value, numbers), PERCENT_FROM.get(value.measure)
    if size is None or limit is None or size < limit:
        return "", ""
    meant = f"{size / 100:g}"
    return f"{value.measure} = {size:g} is {100 * size:g} %; did you mean {meant}?", meant


def _size(value: Expression, numbers: Numbers) -> float | None:
    if not value.names <= numbers.keys():
        return None
    try:
        return float(value.evaluate(numbers))
    except (ExpressionError, OverflowError):
        return None


def parameter_units(definition: Definition) -> dict[str, str]:
    """SI unit of every parameter by name, by its use (N*m or N*m/rad) or else by its dimension.

    Empty for a plain number.

    Examples
    --------
    >>> import torsionnet as tn
    >>> parameter_units(tn.load("amt_rig").definition)["k_1"]
    'N*m/rad'
    """
    known = dimensions(definition.parameters)[0]
    units = {name: "" if dimension is None else str(dimension) for name, dimension in known.items()}
    for element in definition.elements.values():
        for _, _, expression, dimension in element.expressions():
            if isinstance(expression, Name) and dimension:
                units[expression.name] = expected_unit(dimension)
    return {name: "" if unit == "1" else unit for name, unit in units.items()}
