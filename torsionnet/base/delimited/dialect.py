"""Detection of a text file's cell separator, decimal sign and encoding."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date
from itertools import product
from pathlib import Path

from torsionnet.base.errors import Position
from torsionnet.base.units import UnitError, parse_unit

# Formats of dates and times of day in cells of text, and the values of their parts.

_DATE = (
    r"(?P<iso>\d{4}(?P<between>[-/.])\d{1,2}(?P=between)\d{1,2})"
    r"|(?P<dots>\d{1,2}\.\d{1,2}\.(?:\d{4}|\d{2}))"
    r"|(?P<either>\d{1,2}(?P<sign>[/-])\d{1,2}(?P=sign)(?:\d{4}|\d{2}))"
)
"""Regular expression of a date: year first, with points (day first), or ambiguous in day and month."""
_CLOCK = (
    r"(?P<hours>[01]?\d|2[0-3]):(?P<minutes>[0-5]\d):(?P<seconds>[0-5]\d|60)"
    r"(?:(?P<mark>[.,])(?P<part>\d+))?(?P<half> ?[AaPp]\.?[Mm]\.?)?"
)
"""Regular expression of a time of day with hours, minutes, seconds and, on a clock of 12 hours, am or pm."""
_ZONE = r"(?P<zone>Z| ?UTC| ?[+-]\d{2}:?\d{2})?"
"""Regular expression of a time zone, such as Z, UTC or +02:00."""
_DATES = re.compile(_DATE)
STAMP_PATTERN = re.compile(rf"(?:(?:{_DATE})(?P<joint>[Tt]| +))?{_CLOCK}{_ZONE}")
NANOSECONDS_PER_SECOND, NANOSECONDS_PER_DAY = 10**9, 86_400 * 10**9


def is_date(text: str) -> bool:
    """Whether a text is a date without a time of day."""
    return _DATES.fullmatch(text) is not None


def is_stamp(text: str) -> bool:
    """Whether a text is a time of day, with or without a date.

    >>> is_stamp("2024-05-03T10:12:13.001"), is_stamp("03.05.2024 10:12:13,001"), is_stamp("10:12:13"), is_stamp("1:2")
    (True, True, True, False)
    """
    return ":" in text and STAMP_PATTERN.fullmatch(text) is not None


def stamp_columns(cells: Sequence[str]) -> list[tuple[int, ...]]:
    """Indices, from 0, of the columns of a row that hold time stamps; a pair where date and time have a column each."""
    columns: list[tuple[int, ...]] = []
    for at, cell in enumerate(cells):
        if is_stamp(cell):
            dated = at > 0 and is_date(cells[at - 1]) and not STAMP_PATTERN.fullmatch(cell)["joint"]  # type: ignore[index]
            columns.append((at - 1, at) if dated else (at,))
    return columns


def stamp_format(stamp: re.Match[str]) -> tuple[str, ...]:
    """Format of a matched time stamp as texts, equal for all stamps of a column.

    Order and signs of the date, joint, zone, a.m. or p.m.
    """
    kind = next((name for name in ("iso", "dots", "either") if stamp[name]), "")
    joint = (stamp["joint"] or "").strip().upper()
    return kind, stamp["between"] or stamp["sign"] or "", joint, str(bool(stamp["zone"])), str(bool(stamp["half"]))


def written_date(stamp: re.Match[str]) -> str:
    """Date in a matched time stamp as it is written, empty where there is none."""
    return stamp["iso"] or stamp["dots"] or stamp["either"] or ""


def nanoseconds(stamp: re.Match[str]) -> int:
    """Time of day of a matched stamp in nanoseconds of UTC, without its date."""
    hours = int(stamp["hours"])
    half = (stamp["half"] or "").strip().casefold()
    if half:
        # 12 am is 0 h, and 12 pm stays 12 h.
        hours = hours % 12 + 12 * half.startswith("p")
    whole = (hours * 60 + int(stamp["minutes"])) * 60 + int(stamp["seconds"]) - zone_offset(stamp["zone"])
    return whole * NANOSECONDS_PER_SECOND + int((stamp["part"] or "")[:9].ljust(9, "0"))


def zone_offset(text: str | None) -> int:
    """Seconds by which the clock of a time zone is ahead of UTC."""
    digits = re.sub(r"\D", "", text or "")
    return (-1 if "-" in (text or "") else 1) * (int(digits[:2]) * 60 + int(digits[2:])) * 60 if digits else 0


def day_month_order(text: str) -> str:
    """Order of day and month in a date, empty where neither number is above 12."""
    first, second = (int(part) for part in re.split(r"\D", text)[:2])
    return "dots" if first > 12 else "month first" if second > 12 else ""


def ordinal(text: str, order: str) -> int | None:
    """Proleptic Gregorian ordinal of a date, None where there is no such day."""
    first, second, third = (int(part) for part in re.split(r"\D", text))
    year, month, day = (first, second, third) if order == "iso" else (third, second, first)
    if order == "month first":
        month, day = day, month
    try:
        return date(year + 2000 * (year < 100), month, day).toordinal()
    except ValueError:
        return None


def invalid_date(text: str) -> str:
    """Message that a text is not a valid date."""
    return f'"{text}" is not a date of the calendar; check day and month, or write it as 2024-05-03'


SEPARATORS = (";", "\t", ",", " ")
"""Characters that may separate cells of a text file, tried in this order; a blank stands for any white space."""
_NAMES = {";": "semicolon", "\t": "tab", ",": "comma", " ": "white space"}
_NUMBER = r"[+-]?(?:(?:\d+(?:{0}\d*)?|{0}\d+)(?:[eEdD][+-]?\d+)?|inf(?:inity)?|nan|[+-]?∞)"
"""Regular expression of a decimal number; the braces stand for the decimal sign."""
_NUMBERS = {
    ".": re.compile(_NUMBER.format(r"\."), re.IGNORECASE),
    ",": re.compile(_NUMBER.format(",").replace(",\\d*", ",\\d+"), re.IGNORECASE),
}


@dataclass(frozen=True)
class Dialect:
    """Cell separator, decimal sign and use of time stamps in a table of text; a blank is any white space."""

    separator: str
    decimal: str = "."
    stamps: bool = False

    def cells(self, line: str) -> list[str]:
        """Texts of the cells of a line, without blanks and quotes around them."""
        bare = line.rstrip("\r\n")
        if self.separator == " ":
            parts = line.split()
        elif '"' in bare:
            parts = next(csv.reader([bare], delimiter=self.separator, skipinitialspace=True), [])
        else:
            parts = bare.split(self.separator)
        return [part.strip().strip('"').strip() for part in parts]

    def is_number(self, cell: str) -> bool:
        """Whether a cell is a number with the decimal sign of this dialect."""
        return _NUMBERS[self.decimal].fullmatch(cell) is not None

    def is_data(self, line: str) -> bool:
        """Whether a line holds only numbers, empty cells and, where allowed, time stamps, and at least one number."""
        filled = [cell for cell in self.cells(line) if cell]
        others = [cell for cell in filled if not self.is_number(cell)]
        return len(others) < len(filled) and (
            not others or (self.stamps and all(is_stamp(cell) or is_date(cell) for cell in others))
        )

    def number(self, cell: str) -> float:
        """Value of a cell that is a number, as a float; D is Fortran's sign of an exponent.

        >>> Dialect(";", ",").number("-1,5D+03")
        -1500.0
        """
        return float(cell.replace(",", ".").upper().replace("D", "E").replace("∞", "INF"))

    def __str__(self) -> str:
        return (
            f"cells between {_NAMES.get(self.separator, self.separator)}s, decimal {_NAMES.get(self.decimal, 'point')}"
        )


def detect_dialect(
    lines: Sequence[str], separator: str | None = None, decimal: str | None = None, *, stamps: bool = False
) -> Dialect:
    """Dialect (separator, decimal sign) in which most lines are rows of numbers like their heading.

    Given separators are kept.

    >>> str(detect_dialect(["t;M", "0,1;2,5", "0,2;2,6"]))
    'cells between semicolons, decimal comma'
    >>> str(detect_dialect(["t,M", '"0,1","2,5"', '"0,2","2,6"']))
    'cells between commas, decimal comma'

    Raises
    ------
    ValueError
        Separator and decimal sign are given as the same, and no cell is quoted.
    """
    quoted = any('"' in line for line in lines)  # "0,5","1,2" holds two numbers
    candidates = [
        Dialect(between, sign, stamps)
        for between, sign in product([separator] if separator else SEPARATORS, [decimal] if decimal else ".,")
        if between != sign or quoted
    ]
    if not candidates:
        raise ValueError(
            "commas separate the cells, so they cannot be decimal signs too; "
            "write decimal points, or separate cells by semicolons"
        )
    return max(candidates, key=lambda dialect: _score(dialect, lines))


def _score(dialect: Dialect, lines: Sequence[str]) -> tuple[int, int, int, bool]:
    first = data_start(dialect, lines)
    if first == len(lines):
        return 0, 0, 0, False
    width = len(dialect.cells(lines[first]))
    rows = sum(dialect.is_data(line) and len(dialect.cells(line)) == width for line in lines[first:])
    above = next((line for line in reversed(lines[:first]) if line.strip()), None)
    # A heading of as many cells settles 1,5 (one number, or two), best one of several.
    like_heading = above is not None and width == len(dialect.cells(above)) and 3 * rows > len(lines) - first
    return like_heading * (1 + (width > 1)), rows, width, dialect.separator != " "


def data_start(dialect: Dialect, lines: Sequence[str]) -> int:
    """Index from 0 of the first line of numbers that has the usual number of cells.

    ``len(lines)`` where there is none.
    """
    widths = [len(dialect.cells(line)) if dialect.is_data(line) else 0 for line in lines]
    usual = Counter(filter(None, widths)).most_common(1)
    return widths.index(usual[0][0]) if usual else len(lines)


def detect_encoding(path: Path) -> str:
    """Encoding of a text file for ``open``, guessed from its first 64 KiB."""
    with path.open("rb") as file:
        start = file.read(1 << 16)
    if start.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    try:
        # Whole lines only, as the end of the block may cut a character.
        start[: start.rfind(b"\n") + 1].decode("utf-8")
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8-sig"


# Names and units of the columns of a text file, read from the lines above its numbers.

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


def line_position(file: str, number: int, lines: Sequence[str], heading: str = "") -> Position:
    """Position of a line of a file, counted from 1, or of a heading in it.

    >>> line_position("run.csv", 1, ["order,speed,amplitude"], "speed").column
    7
    """
    source = lines[number - 1].rstrip()[:200].replace("\t", " ") if 0 < number <= len(lines) else ""
    cell = re.search(rf"(?<!\w){re.escape(heading)}(?!\w)", source) if heading else None
    start, end = cell.span() if cell else (0, len(source))
    return Position(file, max(number, 1), start + 1, end + 1, source)


def split_heading(text: str) -> tuple[str, str]:
    """Name and unit, as two texts, in the heading of one column.

    >>> split_heading("T_T [Nm]"), split_heading("phi / rad"), split_heading("T (filtered)")
    (('T_T', 'Nm'), ('phi', 'rad'), ('T (filtered)', ''))
    """
    bracketed = _BRACKETED.fullmatch(text.strip())
    if bracketed:
        return bracketed["name"], bracketed["unit"].strip()
    for form in (_IN_PARENTHESES, _WITH_SLASH):
        match = form.fullmatch(text.strip())
        if match and is_unit(match["unit"]):
            return match["name"], match["unit"].strip()
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
