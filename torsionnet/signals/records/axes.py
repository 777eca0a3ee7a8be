"""Axes of channels in files: time in any unit, frequencies in any unit, or an angle and others, which are no time."""

from __future__ import annotations

import math
import re

from torsionnet.base.delimited.headings import plain_unit
from torsionnet.base.units import DIMENSIONS, UnitError, parse_unit

_NO_TIMES = re.compile(
    r"angle|winkel|frequen|\border|ordnung|distan|position|\bweg\b|rotation|revolution|umdrehung|drehzahl|\brpm\b",
    re.IGNORECASE,
)
"""Words in the names of axes that are no time, in English and German."""


def other_axis(unit: str, name: str = "") -> str:
    """Unit, or else name, of an axis that is no time; empty where it is time, or where nothing tells what it is.

    >>> other_axis("deg"), other_axis("ms", "Time"), other_axis("", "Crank angle"), other_axis("")
    ('deg', '', 'Crank angle', '')
    """
    if not unit:
        return name if _NO_TIMES.search(name) else ""
    try:
        return "" if parse_unit(plain_unit(unit)).dimension == DIMENSIONS["time"] else unit
    except UnitError:
        return unit


def seconds_in(unit: str) -> float:
    """Seconds in a unit of time, one where there is no unit.

    >>> seconds_in("ms"), seconds_in("")
    (0.001, 1.0)
    """
    return float(parse_unit(plain_unit(unit)).factor) if unit else 1.0


def hertz_in(unit: str) -> float:
    """Hz in a unit of frequency or of angular frequency, one where there is no unit.

    Raises
    ------
    UnitError
        The unit is one of something else.

    >>> hertz_in("kHz"), round(hertz_in("rad/s"), 9), round(hertz_in("rpm"), 9)
    (1000.0, 0.159154943, 0.016666667)
    """
    if not unit:
        return 1.0
    found = parse_unit(plain_unit(unit))
    if found.dimension not in (DIMENSIONS["frequency"], DIMENSIONS["speed"]):
        raise UnitError(f'"{unit}" is no unit of frequency; expected one like Hz or rad/s')
    return float(found.factor) / (1.0 if found.dimension == DIMENSIONS["frequency"] else 2 * math.pi)
