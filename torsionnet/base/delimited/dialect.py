"""Detection of a text file's cell separator, decimal sign and encoding."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

from torsionnet.base.delimited.stamp_formats import is_date, is_stamp

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
        start[: start.rfind(b"\n") + 1].decode("utf-8")
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8-sig"
