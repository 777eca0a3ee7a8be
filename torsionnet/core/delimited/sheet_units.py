"""Units as sheets write them: with powers of ten before them, points for products, and in headings without brackets."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

from torsionnet.core.delimited.headings import plain_unit, split_heading
from torsionnet.core.units import DIMENSIONS, Dimension, Real, UnitError, parse_unit

_RAISED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_POWER = r"(?:10\s*(?:\^|\*\*)?\s*\(?(?P<ten{0}>[+-]?[1-9]\d?)\)?|1?\s?[eE](?P<e{0}>[+-]?\d\d?))"
_BEFORE = re.compile(rf"[x×*·]?\s*{_POWER.format(1)}\s*[*·x×]?\s*(?P<unit>[A-Za-z(1µμ°].*)")
_AFTER = re.compile(rf"(?P<unit>.*\S)\s*[*·x×]\s*{_POWER.format(2)}")
_DOUBTFUL = re.compile(r"10\s?[eE][+-]?\d+")
_KNOWN = {DIMENSIONS[name] for name in ("inertia", "stiffness", "compliance", "damping", "length")}


@dataclass(frozen=True)
class SheetUnit:
    """A unit as its factor to SI; ``text`` is what a model file would write, empty where a power of ten stands."""

    factor: Real
    dimension: Dimension
    text: str


def sheet_unit(text: str) -> SheetUnit:
    """Read a unit of a sheet; raises UnitError.

    >>> unit = sheet_unit("10⁻⁹ rad/N.m")
    >>> unit.factor, str(unit.dimension), sheet_unit("kg.m2").text
    (Fraction(1, 1000000000), 'rad/(N*m)', 'kg*m^2')
    """
    bare = text.strip().strip("[]").strip()
    if _DOUBTFUL.match(bare):
        raise UnitError(f'"{bare}" is written for 1e... and for 10 times that; write 1e-9 or 10^-9')
    plain = re.sub(r"10([⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+)", lambda found: "10^" + found[1].translate(_RAISED), bare)
    found = _BEFORE.fullmatch(plain) or _AFTER.fullmatch(plain)
    power = next(int(group) for name, group in found.groupdict().items() if name != "unit" and group) if found else 0
    spelled = _spelled(found["unit"] if found else plain)
    unit = parse_unit(spelled)
    factor = unit.factor * (Fraction(10) ** power if isinstance(unit.factor, Fraction) else 10.0**power)
    return SheetUnit(factor, unit.dimension, "" if found else spelled)


def _spelled(text: str) -> str:
    """As the parser of units reads it: points are products, and what follows a slash belongs below it."""
    spelled = re.sub(r"(?<=[A-Za-z0-9²³])\s*\.\s*(?=[A-Za-z])", "*", plain_unit(text))
    spelled = re.sub(r"\b(mm|cm|m|s|in|ft)([23])\b", r"\1^\2", spelled)
    above, slash, below = spelled.partition("/")
    if slash and "/" not in below and "(" not in below:
        gathered = f"{above}/({below.strip()})"
        try:
            if parse_unit(spelled).dimension not in _KNOWN and parse_unit(gathered).dimension in _KNOWN:
                return gathered
        except UnitError:
            return spelled
    return spelled


def named_unit(heading: str) -> tuple[str, str]:
    """Name and unit of a heading, also where no bracket tells them apart.

    >>> named_unit("compliance 1e-9 rad/Nm"), named_unit("Inertia, kgm2"), named_unit("D outer")
    (('compliance', '1e-9 rad/Nm'), ('Inertia', 'kgm2'), ('D outer', ''))
    """
    name, unit = split_heading(heading)
    if unit or heading.rstrip().endswith("]"):
        return name, unit
    bracketed = re.fullmatch(r"(?P<name>.*?\S)\s*\((?P<unit>.*)\)", heading.strip())
    if bracketed and _is_unit(bracketed["unit"]):
        return bracketed["name"], bracketed["unit"]
    words = re.split(r"(?<=\S)(?:\s*,\s*|\s+/\s+|\s+)", heading.strip())
    for count in range(len(words) - 1, 0, -1):
        tail = " ".join(words[-count:])
        if _is_unit(tail):
            return " ".join(words[:-count]), tail
    return heading.strip(), ""


def _is_unit(text: str) -> bool:
    try:
        unit = sheet_unit(text)
    except UnitError:
        return False
    return unit.dimension != DIMENSIONS["1"] or text.strip() == "%"
