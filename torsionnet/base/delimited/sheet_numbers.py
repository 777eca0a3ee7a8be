"""Reading of numbers in the spellings that spreadsheets of several countries use.

All numbers of a sheet together decide its decimal sign.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from torsionnet.base.delimited.cell_grid import Cell

_BLANKS = "\N{NO-BREAK SPACE}\N{NARROW NO-BREAK SPACE}"
_LIKE_NUMBER = re.compile(rf"[+\-−]?[\d.,'’ {_BLANKS}]*\d[.,]?(?:[eE][+\-−]?\d+)?")
_EXPONENT = re.compile(r"[eE].*")
_GROUP = 3
"""Number of digits between two separators of thousands, as in 1,234,567."""


def is_like_number(text: str) -> bool:
    """Whether a cell holds nothing but digits, signs and separators."""
    return _LIKE_NUMBER.fullmatch(text) is not None


def decimal_sign(cells: Iterable[Cell]) -> tuple[str, tuple[Cell, str] | None]:
    """Decimal sign of the numbers of a sheet, and the first cell that does not fit it or is ambiguous, with a message.

    >>> decimal_sign([Cell("1.250,5", 1, 1), Cell("36.000", 2, 1)])
    (',', None)
    """
    hints: dict[str, Cell] = {}
    for cell in cells:
        for hint in _hints(_EXPONENT.sub("", cell.text)):
            hints.setdefault(hint, cell)
    if "," in hints and "." in hints:
        odd = max(hints[","], hints["."], key=lambda cell: (cell.line, cell.column))
        return ".", (odd, f'"{odd.text}" has another decimal sign than cells before it; write all alike')
    if "," in hints or "." in hints:
        return ("," if "," in hints else "."), None
    if "1,234" in hints:
        cell = hints["1,234"]
        whole = cell.text.replace(",", "")
        text = f'"{cell.text}" may be {cell.text.replace(",", ".")} or {whole}, and no other number tells'
        return ".", (cell, f"{text}; write it without the comma, or with a decimal point")
    return ".", None


def _hints(text: str) -> Iterable[str]:
    """Decimal sign, ``,`` or ``.``, where only that sign fits the text of a number.

    ``1,234`` where a comma may be one or not.
    """
    commas, points = text.count(","), text.count(".")
    if commas and points:
        yield "," if text.rindex(",") > text.rindex(".") else "."
    elif commas > 1 or points > 1:
        yield "." if commas else ","
    elif commas or points:
        sign = "," if commas else "."
        head, _, tail = text.lstrip("+-−").partition(sign)
        if len(tail) != _GROUP or not 1 <= len(head) <= _GROUP or head.startswith("0"):
            yield sign
        elif commas:
            yield "1,234"


def plain_number_text(text: str, decimal: str) -> str | None:
    """Text of a number with a decimal point and without separators of thousands; None for a text that is no number.

    >>> plain_number_text("1.250,5", ","), plain_number_text("12'000", "."), plain_number_text("1.2.3", ".")
    ('1250.5', '12000', None)
    """
    other = "." if decimal == "," else ","
    sign, groups = re.escape(decimal), rf"[{other}'’ {_BLANKS}]"
    whole = rf"(?:\d{{1,3}}(?:{groups}\d{{3}})+|\d+)"
    found = re.fullmatch(
        rf"(?P<sign>[+\-−]?)(?:(?P<whole>{whole})(?:{sign}(?P<part>\d*))?|{sign}(?P<only>\d+))(?P<power>[eE][+\-−]?\d+)?",
        text,
    )
    if found is None:
        return None
    digits = re.sub(r"\D", "", found["whole"] or "0").lstrip("0") or "0"
    decimals = found["part"] or found["only"] or ""
    power = (found["power"] or "").replace("−", "-")
    return f"{'-' if found['sign'] in ('-', '−') else ''}{digits}{'.' if decimals else ''}{decimals}{power}"
