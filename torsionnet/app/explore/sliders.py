"""Sliders of the explore page, with unit, value and range of every parameter of a model."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from fractions import Fraction
from typing import Any

from torsionnet.base.entries.spec import Json
from torsionnet.base.expressions import Expression, Number
from torsionnet.base.units import NUMERAL, UnitError, parse_unit
from torsionnet.drivetrain import Drivetrain
from torsionnet.model.checks.parameter_units import parameter_units
from torsionnet.model.parameters import Parameter

RANGE_FACTOR = 10.0
"""Factor from the value of a parameter without bounds to both ends of its slider, a decade up and down."""


@dataclass(frozen=True)
class Slider:
    """Slider of a model's parameter with value and range in ``unit``, the one written in the model.

    Attributes
    ----------
    name, description : str
    unit : str
        What is written behind a value; empty for a bare number.
    shown_unit : str
        The same, or the SI unit of a bare number by the places where it is used.
    si : float
        Value in SI.
    value, default : float
        Now, and in the configuration as the file has it.
    low, high : float
        Ends of the slider.
    logarithmic : bool
        Whether equal distances on the slider are equal factors; both ends have the same sign.
    changed : bool
    expression : str
        Of a derived parameter, which follows others and has no slider, or what one follows with the operating point;
        else empty.
    remark : str
        Words beside the slider, as on a torque that follows another one.
    """

    name: str
    description: str
    unit: str
    shown_unit: str
    si: float
    value: float
    default: float
    low: float
    high: float
    logarithmic: bool
    changed: bool
    expression: str
    remark: str = ""

    def to_data(self) -> dict[str, Json]:
        return asdict(self)


def sliders(plain: Drivetrain, changed: Drivetrain, values: Mapping[str, Any]) -> list[Slider]:
    """Sliders of all parameters of the model, in the order of its file.

    Parameters
    ----------
    plain : Drivetrain
        In the configuration chosen.
    changed : Drivetrain
        In that configuration with ``values``.
    values : mapping
        Parameter -> value given by hand.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("dmf_rig")
    >>> one = sliders(rig, rig.configured(k_1="15 kN*m/rad"), {"k_1": "15 kN*m/rad"})[2]
    >>> one.name, one.value, one.default, one.unit, one.low, one.high
    ('k_1', 15.0, 13.3, 'kN*m/rad', 1.33, 133.0)
    """
    units = parameter_units(plain.definition)
    return [_slider(name, plain, changed, units, is_changed=name in values) for name in plain.parameter_definitions]


def _slider(name: str, plain: Drivetrain, changed: Drivetrain, units: Mapping[str, str], *, is_changed: bool) -> Slider:
    own = plain.parameter_definitions[name]
    follows = own.by is not None
    derived = follows or changed.parameter_definitions[name].is_derived
    unit = "" if derived or own.is_derived else written_unit(own.value)
    shown = unit or units[name]
    factor = parse_unit(unit).factor if unit else Fraction(1)
    default, value = _over(plain.exact_values[name], factor), _over(changed.exact_values[name], factor)
    low, high = _range(name, plain, units, float(factor))
    low, high = min(low, value), max(high, value)
    return Slider(
        name=name,
        description=own.description,
        unit=unit,
        shown_unit=shown,
        si=changed.parameters[name],
        value=value,
        default=default,
        low=low,
        high=high,
        logarithmic=low > 0 or high < 0,
        changed=is_changed,
        expression=_followed(own) if follows else str(changed.parameter_definitions[name].value) if derived else "",
    )


def _followed(own: Parameter) -> str:
    """Words for the operating point that a parameter follows, as ``by load of propeller``."""
    return f"by {str(own.by).replace('_', ' ')}" + (f" of {own.of}" if own.of else "")


def written_unit(value: Expression) -> str:
    """Text of the unit behind a parameter's number in the model file; empty where none is written.

    >>> from torsionnet.base.expression_reading import scalar
    >>> written_unit(scalar("0.46 kN*m/rad")), written_unit(scalar(3))
    ('kN*m/rad', '')
    """
    if not isinstance(value, Number) or value.text is None or value.unit_dimension is None:
        return ""
    numeral = NUMERAL.match(value.text.strip())
    unit = value.text.strip()[numeral.end() :].strip() if numeral else ""
    try:
        return unit if unit and parse_unit(unit) else ""
    except UnitError:
        return ""


def _over(value: Any, factor: Any) -> float:
    """Value in SI over the factor of its unit, exact where both are fractions, so that 0.46 kN*m/rad stays 0.46."""
    exact = isinstance(value, int | Fraction) and isinstance(factor, Fraction)
    return float(Fraction(value) / factor) if exact else float(value) / float(factor)


def _range(name: str, plain: Drivetrain, units: Mapping[str, str], factor: float) -> tuple[float, float]:
    bounds = plain.parameter_definitions[name].bounds
    if bounds:
        return bounds[0] / factor, bounds[1] / factor
    value = plain.parameters[name] / factor
    if value:
        ends = (value / RANGE_FACTOR, value * RANGE_FACTOR)
        return min(ends), max(ends)
    return 0.0, _size(name, plain, units) / factor


def _size(name: str, plain: Drivetrain, units: Mapping[str, str]) -> float:
    """Upper end in SI of the slider of a parameter that is 0: by its alternatives, parameters of its unit, or 1."""
    overlays = [overlay for axis in plain.definition.configurations.values() for overlay in axis.values()]
    numbers = [overlay.parameters[name] for overlay in overlays if name in overlay.parameters]
    found = [abs(float(number.value)) for number in numbers if isinstance(number, Number)]
    if max(found, default=0.0) > 0:
        return RANGE_FACTOR * max(found)
    alike = [abs(plain.parameters[other]) for other in units if units[other] and units[other] == units[name]]
    largest = max(alike, default=0.0)
    return largest if 0 < largest < math.inf else 1.0
