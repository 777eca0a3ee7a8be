"""Reading of units in the spellings of mass-elastic sheets.

With powers of ten, points for products, and in headings without brackets.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

from torsionnet.base.delimited.headings import plain_unit, split_heading
from torsionnet.base.units import DIMENSIONS, Dimension, Real, UnitError, parse_unit

_RAISED_UNIT = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_UNIT_POWER = r"(?:10\s*(?:\^|\*\*)?\s*\(?(?P<ten{0}>[+-]?[1-9]\d?)\)?|1?\s?[eE](?P<e{0}>[+-]?\d\d?))"
"""Regular expression of a power of ten before or after a unit; the braces number its groups."""
_BEFORE = re.compile(rf"[x×*·]?\s*{_UNIT_POWER.format(1)}\s*[*·x×]?\s*(?P<unit>[A-Za-z(1µμ°].*)")
_AFTER = re.compile(rf"(?P<unit>.*\S)\s*[*·x×]\s*{_UNIT_POWER.format(2)}")
_DOUBTFUL = re.compile(r"10\s?[eE][+-]?\d+")
_KNOWN = {DIMENSIONS[name] for name in ("inertia", "stiffness", "compliance", "damping", "length")}


@dataclass(frozen=True)
class SheetUnit:
    """Unit of a sheet column, with its factor to SI and its dimension.

    ``text`` and ``power`` (of ten) are for a model file.
    """

    factor: Real
    dimension: Dimension
    text: str
    power: int = 0

    def times(self, factor: Fraction) -> SheetUnit:
        """Unit multiplied by a factor; without a text where that is no power of ten."""
        digits = len(str(max(factor.numerator, factor.denominator))) - 1
        power = digits if factor > 1 else -digits
        scaled = self.factor * factor if isinstance(self.factor, Fraction) else self.factor * float(factor)
        text, added = (self.text, power) if factor == Fraction(10) ** power else ("", 0)
        return SheetUnit(scaled, self.dimension, text, self.power + added)


def sheet_unit(text: str) -> SheetUnit:
    """Unit that a text of a sheet names, with its factor to SI and its dimension; raises UnitError.

    >>> unit = sheet_unit("10⁻⁹ rad/N.m")
    >>> unit.factor, str(unit.dimension), sheet_unit("kg.m2").text, sheet_unit("lb-in/rad").text
    (Fraction(1, 1000000000), 'rad/(N*m)', 'kg*m^2', 'lbf*in/rad')
    """
    bare = text.strip().strip("[]").strip()
    if _DOUBTFUL.match(bare):
        raise UnitError(f'"{bare}" is ambiguous: it may be 1e... or 10 times as much; write 1e-9 or 10^-9')
    plain = re.sub(r"10([⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+)", lambda found: "10^" + found[1].translate(_RAISED_UNIT), bare)
    found = _BEFORE.fullmatch(plain) or _AFTER.fullmatch(plain)
    power = next(int(group) for name, group in found.groupdict().items() if name != "unit" and group) if found else 0
    spelled = _spelled(found["unit"] if found else plain)
    unit = parse_unit(spelled)
    factor = unit.factor * (Fraction(10) ** power if isinstance(unit.factor, Fraction) else 10.0**power)
    return SheetUnit(factor, unit.dimension, spelled, power)


def _spelled(text: str) -> str:
    """Unit of a sheet in a spelling that ``parse_unit`` can read.

    Points and hyphens are products, all after a slash is below it.
    """
    spelled = re.sub(r"(?<=[A-Za-z0-9²³])\s*[.\-]\s*(?=[A-Za-z])", "*", plain_unit(text))
    spelled = re.sub(r"\blbs\b", "lb", re.sub(r"\bsec(?=\b|\d)", "s", spelled))
    spelled = re.sub(r"\b(mm|cm|m|s|in|ft)([23])\b", r"\1^\2", spelled)
    if _dimension(spelled) in _KNOWN:
        return spelled
    above, slash, below = spelled.partition("/")
    gathered = f"{above}/({below.strip()})" if slash and "/" not in below and "(" not in below else spelled
    # A pound is a force where the unit makes no sense with it as a mass: lb-in/rad, but lb-ft2.
    forms = (gathered, *(re.sub(r"\blb\b", "lbf", form) for form in (spelled, gathered)))
    return next((form for form in forms if _dimension(form) in _KNOWN), spelled)


def _dimension(text: str) -> Dimension | None:
    try:
        return parse_unit(text).dimension
    except UnitError:
        return None


def named_unit(heading: str) -> tuple[str, str]:
    """Name and unit, as two texts, in a heading, also where no bracket separates them or more text follows.

    >>> named_unit("compliance 1e-9 rad/Nm"), named_unit("Inertia, kgm2"), named_unit("D outer")
    (('compliance', '1e-9 rad/Nm'), ('Inertia', 'kgm2'), ('D outer', ''))
    >>> named_unit("k [MNm/rad] (referred to crank)")
    ('k (referred to crank)', 'MNm/rad')
    """
    name, unit = split_heading(heading)
    if unit or heading.rstrip().endswith("]"):
        return name, unit
    bracketed = re.fullmatch(r"(?P<name>.*?\S)\s*\((?P<unit>.*)\)", heading.strip())
    if bracketed and _is_unit(bracketed["unit"]):
        return bracketed["name"], bracketed["unit"]
    for found in re.finditer(r"\s*[\[(]([^\[\]()]*)[\])]", heading.strip()):
        if _is_unit(found[1]):
            return (heading.strip()[: found.start()] + heading.strip()[found.end() :]).strip(), found[1]
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
