"""Quantity of a recorded channel from its unit, and the factor that converts its values to SI."""

from __future__ import annotations

import re

from torsionnet.base.delimited.headings import plain_unit
from torsionnet.base.units import ANGLES, DIMENSIONS, Dimension, UnitError, parse_unit
from torsionnet.signals.recording import QUANTITY_UNITS

_DIMENSIONS = {"torque": "torque", "angle": "angle", "velocity": "speed", "acceleration": "acceleration"}
"""Dimensions of the quantities of a channel that its unit tells.

A pressure may be that of a gas, so stress is not among them.
"""
_USUAL_NAMES = {
    "angle": re.compile(
        r"(?:a|(?i:phi|theta|alpha|beta|gamma|psi|varphi|φ|θ|ang(?:le)?|winkel|twist|enc(?:oder)?|pos(?:ition)?))(?![^\W\d_])"
    ),
    "velocity": re.compile(r"(?:w|n|(?i:omega|ω|rpm|speed|drehzahl|vel(?:ocity)?|tacho))(?![^\W\d_])"),
    "acceleration": re.compile(r"(?i:acc(?:eleration)?|eps(?:ilon)?|domega)(?![^\W\d_])"),
}
"""Beginnings of the names that channels of a quantity usually have."""
_ANGULAR = re.compile("|".join([*sorted(ANGLES), "°"]))


def quantity_of(unit: str) -> str:
    """Quantity of a channel (torque, angle, ...) that has a unit; empty where none or more than one has it.

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


def likely_quantity(name: str) -> str:
    """Quantity that a channel of this name probably holds, for an example; a torque where the name tells nothing.

    >>> likely_quantity("phi_2"), likely_quantity("n1"), likely_quantity("M1")
    ('angle', 'velocity', 'torque')
    """
    return next((quantity for quantity, usual in _USUAL_NAMES.items() if usual.match(name)), "torque")


def quantity_of_dimension(dimension: Dimension) -> str:
    """Quantity of a channel that has a dimension, empty where there is none."""
    return next((quantity for quantity, name in _DIMENSIONS.items() if dimension == DIMENSIONS[name]), "")


def factor_to_si(unit: str, quantity: str) -> float:
    """Factor that converts values to SI, or :class:`UnitError` where the unit is not one of the quantity.

    >>> factor_to_si("kNm", "torque")
    1000.0
    """
    read = parse_unit(plain_unit(unit))
    if read.dimension != DIMENSIONS[_DIMENSIONS.get(quantity, "pressure")]:
        raise UnitError(f'"{unit}" is no unit of {quantity}; expected one like {QUANTITY_UNITS[quantity]}')
    return float(read.factor)
