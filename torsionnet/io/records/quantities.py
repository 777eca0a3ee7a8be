"""From the unit of a channel to its quantity, and to the factor that makes SI of its values."""

from __future__ import annotations

import re

from torsionnet.core.delimited.headings import plain_unit
from torsionnet.core.units import ANGLES, DIMENSIONS, Dimension, UnitError, parse_unit
from torsionnet.response.recording import QUANTITY_UNITS

_DIMENSIONS = {"torque": "torque", "angle": "angle", "velocity": "speed", "acceleration": "acceleration"}
"""A pressure may be that of a gas: only who measures stress can say so."""
_ANGULAR = re.compile("|".join([*sorted(ANGLES), "°"]))


def quantity_of(unit: str) -> str:
    """The quantity that has a unit; empty where none or more than one has it.

    >>> quantity_of("kNm"), quantity_of("deg"), quantity_of("rpm"), quantity_of("V")
    ('torque', 'angle', 'velocity', '')
    """
    try:
        dimension = parse_unit(plain_unit(unit)).dimension
    except UnitError:
        return ""
    quantity = quantity_of_dimension(dimension)
    # A bare number or per cent has the dimension of an angle, and so have many other things.
    return quantity if quantity != "angle" or _ANGULAR.search(unit) else ""


def quantity_of_dimension(dimension: Dimension) -> str:
    """The quantity of a dimension; empty where there is none."""
    return next((quantity for quantity, name in _DIMENSIONS.items() if dimension == DIMENSIONS[name]), "")


def factor_to_si(unit: str, quantity: str) -> float:
    """What to multiply values with; raises :class:`UnitError` where the unit is not one of the quantity.

    >>> factor_to_si("kNm", "torque")
    1000.0
    """
    read = parse_unit(plain_unit(unit))
    if read.dimension != DIMENSIONS[_DIMENSIONS.get(quantity, "pressure")]:
        raise UnitError(f'"{unit}" is no unit of {quantity}; expected one like {QUANTITY_UNITS[quantity]}')
    return float(read.factor)
