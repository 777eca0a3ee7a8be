"""Units and digits in which a report shows values, as engineers of machinery write them: kN m, kW, N/mm2, mrad, rpm."""

from __future__ import annotations

import math
from dataclasses import replace

from torsionnet.base.conventions import Conventions
from torsionnet.base.number_text import NumberText, prefix_of
from torsionnet.base.phrases import phrase
from torsionnet.base.units import RPM, expected_unit
from torsionnet.report.report_text import unit

DIGITS = 3
"""Significant digits of stresses, torques and shares: a torsional calculation is not known better."""
KILO = {"W": "kW", "W/m^2": "kW/m^2"}
"""Unit of a thousand, by SI unit, for what machinery has in thousands."""
UNITS = {
    "length": ("mm", 1e3),
    "power": ("kW", 1e-3),
    "heat flux": ("kW/m^2", 1e-3),
    "speed": ("rpm", RPM),
    "angle": ("deg", 180 / math.pi),
}
"""Unit of engineers and its factor over SI, by dimension."""
FACTOR_UNITS = {"m": (1e3, "mm"), "m^3": (1e6, "cm^3"), "Pa": (1e-6, "N/mm^2"), "1": (1.0, "")}
"""Factor and unit in which rules state the factors of a shaft, by SI unit."""


def engineering_unit(unit: str, conventions: Conventions, size: float = 1e3) -> tuple[float, str]:
    """Factor from an SI unit to the unit of engineers, without unit, and the name of that unit.

    Torques are in kN m, so that those of one component have one unit in all tables, unless a ``size`` in N m is given.

    Examples
    --------
    >>> engineering_unit("N*m", Conventions(), 25e3), engineering_unit("rad", Conventions())
    ((0.001, 'kN*m'), (1000.0, 'mrad'))
    >>> engineering_unit("Pa", Conventions())
    (1e-06, 'N/mm^2')
    """
    if unit in KILO:
        return 1e-3, KILO[unit]
    if unit == "rad" and conventions.angle == "rad":
        return 1e3, "mrad"
    if unit == "N*m":
        prefix, factor = prefix_of(unit, size)
        return 1 / factor, prefix + unit
    return conventions.scale(unit), conventions.unit(unit)


def limit_scale(si_unit: str, conventions: Conventions, size: float = 1e3) -> tuple[float, str]:
    """Factor from an SI unit to that in which a report shows values of a limit, and its name: angles are in degrees.

    >>> limit_scale("rad", Conventions())[1], limit_scale("N*m", Conventions())
    ('deg', (0.001, 'kN*m'))
    """
    in_degrees = replace(conventions, angle="deg") if conventions.angle == "rad" and si_unit == "rad" else conventions
    return engineering_unit(si_unit, in_degrees, size)


def limit_unit(si_unit: str, conventions: Conventions) -> str:
    """Name of the unit in which a report shows values of a limit.

    >>> limit_unit("N*m", Conventions()), limit_unit("Pa", Conventions())
    ('kN·m', 'N/mm²')
    """
    return unit(limit_scale(si_unit, conventions)[1])


def limit_number(value: float, si_unit: str, conventions: Conventions) -> NumberText:
    """Number of a value of a limit, in SI, in the unit in which a report shows it."""
    return NumberText(value * limit_scale(si_unit, conventions)[0], DIGITS)


def quantity_text(number: float, dimension: str) -> str:
    """Text of a quantity in SI in the unit that engineers use for it.

    Examples
    --------
    >>> quantity_text(0.6, "length"), quantity_text(188.7e3, "torque"), quantity_text(1.234e5, "inertia")
    ('600 mm', '188.7 kN·m', '123400 kg·m²')
    """
    if dimension == "1":
        return f"{number:.5g}".replace("-", "−")
    name, factor = UNITS.get(dimension, (expected_unit(dimension), 1.0))
    if name.startswith("N*m"):
        prefix, size = prefix_of(name, number)
        name, factor = prefix + name, 1 / size
    said = NumberText(number * factor, 5)
    return phrase("{value} rpm", value=said) if dimension == "speed" else f"{said} {unit(name)}"
