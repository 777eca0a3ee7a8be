"""Units of values as engineers of machinery write them: kN m, kW, N/mm2, mrad or degrees."""

from __future__ import annotations

from torsionnet.base.conventions import Conventions

KILO = {"W": "kW", "W/m^2": "kW/m^2"}
"""Unit of a thousand, by SI unit, for what machinery has in thousands."""
KILO_FROM = 1e3
"""Torque in N m from which on it is given in kN m, as on the drawings of engines."""


FACTOR_UNITS = {"m": (1e3, "mm"), "m^3": (1e6, "cm^3"), "Pa": (1e-6, "N/mm^2"), "1": (1.0, "")}
"""Factor and unit in which rules state the factors of a shaft, by SI unit."""


def engineering_unit(unit: str, conventions: Conventions, size: float = 1e3) -> tuple[float, str]:
    """Factor from an SI unit to the unit of engineers, without unit, and the name of that unit.

    ``size`` is that of the values in SI units, by which torques of small plants stay in N m.

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
    if unit == "N*m" and size >= KILO_FROM:
        return 1e-3, "kN*m"
    return conventions.scale(unit), conventions.unit(unit)
