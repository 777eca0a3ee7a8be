"""Formats of dates and times of day in cells of text, and the values of their parts."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import date

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
    found: list[tuple[int, ...]] = []
    for at, cell in enumerate(cells):
        if is_stamp(cell):
            dated = at > 0 and is_date(cells[at - 1]) and not STAMP_PATTERN.fullmatch(cell)["joint"]  # type: ignore[index]
            found.append((at - 1, at) if dated else (at,))
    return found


def stamp_format(found: re.Match[str]) -> tuple[str, ...]:
    """Format of a matched time stamp as texts, equal for all stamps of a column.

    Order and signs of the date, joint, zone, a.m. or p.m.
    """
    kind = next((name for name in ("iso", "dots", "either") if found[name]), "")
    joint = (found["joint"] or "").strip().upper()
    return kind, found["between"] or found["sign"] or "", joint, str(bool(found["zone"])), str(bool(found["half"]))


def written_date(found: re.Match[str]) -> str:
    """Date in a matched time stamp as it is written, empty where there is none."""
    return found["iso"] or found["dots"] or found["either"] or ""


def nanoseconds(found: re.Match[str]) -> int:
    """Time of day of a matched stamp in nanoseconds of UTC, without its date."""
    hours = int(found["hours"])
    half = (found["half"] or "").strip().casefold()
    if half:
        hours = hours % 12 + 12 * half.startswith("p")
    whole = (hours * 60 + int(found["minutes"])) * 60 + int(found["seconds"]) - zone_offset(found["zone"])
    return whole * NANOSECONDS_PER_SECOND + int((found["part"] or "")[:9].ljust(9, "0"))


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
    one, two, three = (int(part) for part in re.split(r"\D", text))
    year, month, day = (one, two, three) if order == "iso" else (three, two, one)
    if order == "month first":
        month, day = day, month
    try:
        return date(year + 2000 * (year < 100), month, day).toordinal()
    except ValueError:
        return None


def invalid_date(text: str) -> str:
    """Message that a text is not a valid date."""
    return f'"{text}" is not a date of the calendar; check day and month, or write it as 2024-05-03'
