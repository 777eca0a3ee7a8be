"""How dates and times of day are written in a cell of text, and what one of them is worth."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import date

_DATE = (
    r"(?P<iso>\d{4}(?P<between>[-/.])\d{1,2}(?P=between)\d{1,2})"
    r"|(?P<dots>\d{1,2}\.\d{1,2}\.(?:\d{4}|\d{2}))"
    r"|(?P<either>\d{1,2}(?P<sign>[/-])\d{1,2}(?P=sign)(?:\d{4}|\d{2}))"
)
_CLOCK = (
    r"(?P<hours>[01]?\d|2[0-3]):(?P<minutes>[0-5]\d):(?P<seconds>[0-5]\d|60)"
    r"(?:(?P<mark>[.,])(?P<part>\d+))?(?P<half> ?[AaPp]\.?[Mm]\.?)?"
)
_ZONE = r"(?P<zone>Z| ?UTC| ?[+-]\d{2}:?\d{2})?"
_DATES = re.compile(_DATE)
STAMP = re.compile(rf"(?:(?:{_DATE})(?P<joint>[Tt]| +))?{_CLOCK}{_ZONE}")
NANO, DAY = 10**9, 86_400 * 10**9


def is_date(text: str) -> bool:
    """Whether a text is a date without a time."""
    return _DATES.fullmatch(text) is not None


def is_stamp(text: str) -> bool:
    """Whether a text is a time of day, with or without a date.

    >>> is_stamp("2024-05-03T10:12:13.001"), is_stamp("03.05.2024 10:12:13,001"), is_stamp("10:12:13"), is_stamp("1:2")
    (True, True, True, False)
    """
    return ":" in text and STAMP.fullmatch(text) is not None


def stamp_columns(cells: Sequence[str]) -> list[tuple[int, ...]]:
    """Columns of a row that hold time stamps, two of them where the date is in one of its own."""
    found: list[tuple[int, ...]] = []
    for at, cell in enumerate(cells):
        if is_stamp(cell):
            dated = at > 0 and is_date(cells[at - 1]) and not STAMP.fullmatch(cell)["joint"]  # type: ignore[index]
            found.append((at - 1, at) if dated else (at,))
    return found


def form_of(found: re.Match[str]) -> tuple[str, ...]:
    """What all stamps of a column have in common: order and signs of the date, what joins it, zone and half."""
    kind = next((name for name in ("iso", "dots", "either") if found[name]), "")
    joint = (found["joint"] or "").strip().upper()
    return kind, found["between"] or found["sign"] or "", joint, str(bool(found["zone"])), str(bool(found["half"]))


def date_of(found: re.Match[str]) -> str:
    return found["iso"] or found["dots"] or found["either"] or ""


def nanoseconds(found: re.Match[str]) -> int:
    hours = int(found["hours"])
    half = (found["half"] or "").strip().casefold()
    if half:
        hours = hours % 12 + 12 * half.startswith("p")
    whole = (hours * 60 + int(found["minutes"])) * 60 + int(found["seconds"]) - zone_of(found["zone"])
    return whole * NANO + int((found["part"] or "")[:9].ljust(9, "0"))


def zone_of(text: str | None) -> int:
    """Seconds that a clock is ahead of UTC."""
    digits = re.sub(r"\D", "", text or "")
    return (-1 if "-" in (text or "") else 1) * (int(digits[:2]) * 60 + int(digits[2:])) * 60 if digits else 0


def order_of(text: str) -> str:
    """Whether day or month comes first, where a number above 12 tells."""
    first, second = (int(part) for part in re.split(r"\D", text)[:2])
    return "dots" if first > 12 else "month first" if second > 12 else ""


def ordinal(text: str, order: str) -> int | None:
    """Number of a day, None where there is no such day."""
    one, two, three = (int(part) for part in re.split(r"\D", text))
    year, month, day = (one, two, three) if order == "iso" else (three, two, one)
    if order == "month first":
        month, day = day, month
    try:
        return date(year + 2000 * (year < 100), month, day).toordinal()
    except ValueError:
        return None


def no_date(text: str) -> str:
    return f'"{text}" is no date'
