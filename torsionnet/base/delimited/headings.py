"""Names and units of the columns of a text file, read from the lines above its numbers."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from torsionnet.base.delimited.dialect import Dialect
from torsionnet.base.units import UnitError, parse_unit

_BRACKETED = re.compile(r"(?P<name>.*?)\s*\[(?P<unit>[^\[\]]*)\]")
_IN_PARENTHESES = re.compile(r"(?P<name>.*?\S)\s*\((?P<unit>[^()]*(?:\([^()]*\))?[^()]*)\)")
_WITH_SLASH = re.compile(r"(?P<name>.*?\S)\s+(?:/|in)\s+(?P<unit>\S.*)")

_OTHER_WORDS = {
    "°/s": "deg/s",
    "1/min": "rpm",
    "min-1": "rpm",
    "min^-1": "rpm",
    "U/min": "rpm",
    "grad": "",
}
_FOLDED = {
    "rpm": "rpm",
    **dict.fromkeys(("sec", "secs", "second", "seconds", "sek"), "s"),
    **dict.fromkeys(("msec", "millisecond", "milliseconds"), "ms"),
    **dict.fromkeys(("usec", "microsecond", "microseconds"), "us"),
    **dict.fromkeys(("degree", "degrees"), "deg"),
    "minutes": "min",
    "hours": "h",
    "days": "d",
    "hertz": "Hz",
}
ELECTRICAL = frozenset({"v", "mv", "kv", "volt", "volts", "a", "ma", "amp", "ampere", "amps", "w", "watt"})
"""Units, in lower case, that have no place in mechanics, and by which a row of units is recognised."""
_ENCLOSED = re.compile(r"\([^()]*\)|\[[^\[\]]*\]")
_PRODUCT = re.compile(r"(?<=[A-Za-z])\s*[.\-]\s*(?=[A-Za-z])")
_POWER = re.compile(r"(?<=[A-Za-z])-(?=\d)")
_SECONDS = re.compile(r"\bsec\b"), re.compile(r"\b(?:s|sec)2\b")
_FOOT_POUND = re.compile(r"(?:(ft|in)[*\s]?lbs?f?|lbs?f?[*\s]?(ft|in))", re.IGNORECASE)


@dataclass(frozen=True)
class Headings:
    """Names and units of the columns of a text file, the number of heading lines, and notes on what was assumed."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    lines: int
    notes: tuple[str, ...] = ()


def headings(dialect: Dialect, above: Sequence[str], width: int) -> Headings:
    """Names and units of ``width`` columns of numbers, read from the lines above the numbers."""
    rows = [dialect.cells(line) for line in [line for line in above if line.strip()][-2:]]
    if len(rows) == 2 and _is_units(rows[1], width) and len(rows[0]) == width:
        units = tuple(cell.strip("[]() ") if cell != "-" else "" for cell in rows[1])
        return Headings(_named(rows[0]), units, 2, ("names and units from two rows of headings",))
    if rows and len(rows[-1]) == width and any(rows[-1]):
        pairs = [split_heading(cell) for cell in rows[-1]]
        note = "names and units from the heading" if any(unit for _, unit in pairs) else "names from the heading"
        return Headings(_named([name for name, _ in pairs]), tuple(unit for _, unit in pairs), 1, (note,))
    names = tuple(f"column_{number + 1}" for number in range(width))
    return Headings(names, ("",) * width, 0, ("no heading: columns are named column_1, column_2 and so on",))


def split_heading(text: str) -> tuple[str, str]:
    """Name and unit, as two texts, in the heading of one column.

    >>> split_heading("T_T [Nm]"), split_heading("phi / rad"), split_heading("T (filtered)")
    (('T_T', 'Nm'), ('phi', 'rad'), ('T (filtered)', ''))
    """
    bracketed = _BRACKETED.fullmatch(text.strip())
    if bracketed:
        return bracketed["name"], bracketed["unit"].strip()
    for form in (_IN_PARENTHESES, _WITH_SLASH):
        found = form.fullmatch(text.strip())
        if found and is_unit(found["unit"]):
            return found["name"], found["unit"].strip()
    return text.strip(), ""


def is_unit(text: str) -> bool:
    """Whether a text can be read as a unit."""
    try:
        parse_unit(plain_unit(text))
    except UnitError:
        return False
    return True


def plain_unit(unit: str) -> str:
    """Unit of a recorder in a spelling that ``parse_unit`` can read: recorders write r/min and products in many ways.

    A pound in a product with a length and nothing else is one of force: that is a torque.

    >>> plain_unit(" 1/min "), plain_unit("N-m"), plain_unit("rad.s-1"), plain_unit("ft-lb")
    ('rpm', 'N*m', 'rad*s^-1', 'lbf*ft')
    """
    bare = unit.partition(" since ")[0].strip()  # times of netCDF are seconds since a date
    known = _OTHER_WORDS.get(bare, _FOLDED.get(bare.casefold()))
    if known is not None:
        return known
    plain, squared = _SECONDS
    spelled = squared.sub("s^2", plain.sub("s", _POWER.sub("^-", _PRODUCT.sub("*", bare))))
    pounds = _FOOT_POUND.fullmatch(spelled)
    return f"lbf*{(pounds[1] or pounds[2]).lower()}" if pounds else spelled


def _is_units(cells: Sequence[str], width: int) -> bool:
    filled = [cell for cell in cells if cell.strip("[]()- ")]
    # The rows of units of oscilloscopes: (ms),(V) of PicoScope, second,Volt of Keysight and Rigol.
    known = sum(
        cell.strip("[]() ").casefold() in ELECTRICAL or is_unit(cell.strip("[]() ")) or bool(_ENCLOSED.fullmatch(cell))
        for cell in filled
    )
    return len(cells) == width and bool(filled) and 2 * known >= len(filled)


def _named(names: Sequence[str]) -> tuple[str, ...]:
    return tuple(name or f"column_{number + 1}" for number, name in enumerate(names))
