"""Tables of a document in Markdown as a reader has them: headings, units, groups of rows, numbers with their last digit."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

RAISED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
NUMBER = re.compile(r"(-?)(\d+)(?:\.(\d+))?(?:·10([⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+))?")
CAPTION = re.compile(r"\*\*Table \d+\*\* (.*)")
HEADING = re.compile(r"(.*?)(?: ?\[([^\]]+)\])?")
FEWEST_DIGITS = 3
"""Significant digits that a printed number has at least: zeros at its end beyond them may be rounded."""
SI = {
    **dict.fromkeys(("N·m", "N·m/rad", "N·m·s/rad", "W", "N/mm²", "rad", "deg", "W/m²"), 1.0),
    **dict.fromkeys(("kN·m", "kN·m/rad", "kN·m·s/rad", "kW", "kW/m²"), 1e3),
    **dict.fromkeys(("MN·m", "MN·m/rad", "MN·m·s/rad"), 1e6),
    "mrad": 1e-3,
}
"""Factor to the unit without prefix, by the unit as it is printed."""


@dataclass(frozen=True)
class Printed:
    """A printed number, and half of its last digit: what was rounded away, carried through sums and products."""

    value: float
    half: float = 0.0

    @classmethod
    def read(cls, text: str, digits: int = FEWEST_DIGITS, *, trimmed: bool = False) -> Printed | None:
        """Number of a cell, None where it has none; zeros at the end of an integer beyond ``digits`` may be rounded.

        With ``trimmed`` a number of fewer digits has lost zeros behind its point.
        """
        match = NUMBER.fullmatch(text.strip().replace("−", "-"))
        if match is None:
            return None
        sign, whole, decimals, power = match.groups()
        factor = 10.0 ** int((power or "⁰").translate(RAISED))
        zeros = len(whole) - len(whole.rstrip("0")) if decimals is None else 0
        last = -len(decimals) if decimals else max(0, min(zeros, len(whole) - digits))
        significant = len(f"{whole}{decimals or ''}".lstrip("0"))
        if trimmed and 0 < significant < digits:
            last -= digits - significant
        value = float(f"{sign}{whole}.{decimals or 0}") * factor
        return cls(value, 0.5 * 10.0**last * factor)

    def __add__(self, other: Printed) -> Printed:
        return Printed(self.value + other.value, self.half + other.half)

    def __sub__(self, other: Printed) -> Printed:
        return Printed(self.value - other.value, self.half + other.half)

    def __mul__(self, other: Printed) -> Printed:
        half = abs(self.value) * other.half + abs(other.value) * self.half + self.half * other.half
        return Printed(self.value * other.value, half)

    def __truediv__(self, other: Printed) -> Printed:
        least = max(abs(other.value) - other.half, 1e-300)
        half = (self.half + abs(self.value / other.value) * other.half) / least if other.value else float("inf")
        return Printed(self.value / other.value if other.value else float("inf"), half)

    def times(self, factor: float) -> Printed:
        """Number and its last digit in another unit."""
        return Printed(self.value * factor, abs(factor) * self.half)

    def agrees(self, other: Printed) -> bool:
        """Whether both can be roundings of one number."""
        return abs(self.value - other.value) <= (self.half + other.half) * (1 + 1e-6) + 1e-9 * abs(self.value)

    def __str__(self) -> str:
        return f"{self.value:.6g} ± {self.half:.1g}"


@dataclass(frozen=True)
class PrintedRow:
    """Row of a printed table, with the title of its group and its cells as text."""

    group: str
    heads: tuple[str, ...]
    units: tuple[str, ...]
    cells: tuple[str, ...]

    def text(self, *heads: str) -> str:
        """Cell under the first of these headings that the table has, empty without any."""
        return next((self.cells[self.heads.index(head)] for head in heads if head in self.heads), "")

    def number(self, *heads: str, digits: int = FEWEST_DIGITS, trimmed: bool = False) -> Printed | None:
        """Number under the first of these headings that the table has, in the unit without prefix."""
        head = next((one for one in heads if one in self.heads), None)
        if head is None:
            return None
        at = self.heads.index(head)
        number = Printed.read(self.cells[at], digits, trimmed=trimmed)
        return None if number is None else number.times(SI.get(self.units[at] or self.text("Unit"), 1.0))

    def unit(self, head: str) -> str:
        """Unit of a column, from its heading or from the column of units."""
        return (self.units[self.heads.index(head)] or self.text("Unit")) if head in self.heads else ""


@dataclass(frozen=True)
class PrintedTable:
    """Table of a document with its caption, and the lines of text between it and the next heading or table."""

    caption: str
    heads: tuple[str, ...]
    units: tuple[str, ...]
    rows: tuple[PrintedRow, ...]
    notes: tuple[str, ...]

    def keeps_zeros(self, *heads: str) -> bool:
        """Whether numbers under the first of these headings that the table has keep zeros at their end, as 0.6000."""
        at = next((self.heads.index(head) for head in heads if head in self.heads), None)
        cells = [] if at is None else [row.cells[at].strip() for row in self.rows]
        return any("." in cell and cell.endswith("0") for cell in cells)

    def groups(self) -> list[list[PrintedRow]]:
        """Rows by the title of their group, in their order."""
        by_title: dict[str, list[PrintedRow]] = {}
        for row in self.rows:
            by_title.setdefault(row.group, []).append(row)
        return list(by_title.values())


def printed_tables(text: str) -> list[PrintedTable]:
    """Tables of a document in Markdown that have a caption."""
    lines = text.splitlines()
    starts = [at for at, line in enumerate(lines) if CAPTION.fullmatch(line)]
    return [one for at in starts if (one := _table(lines, at)) is not None]


def _table(lines: list[str], at: int) -> PrintedTable | None:
    match = CAPTION.fullmatch(lines[at])
    assert match is not None
    first = next((place for place in range(at + 1, min(at + 4, len(lines))) if lines[place].startswith("|")), None)
    if first is None:
        return None
    end = next((place for place in range(first, len(lines)) if not lines[place].startswith("|")), len(lines))
    headings = [HEADING.fullmatch(cell) for cell in _cells(lines[first])]
    heads = tuple(one[1].strip() if one else "" for one in headings)
    units = tuple((one[2] or "") if one else "" for one in headings)
    body = [_cells(line) for line in lines[first + 2 : end]]
    return PrintedTable(match[1], heads, units, tuple(_rows(heads, units, body)), tuple(_notes(lines[end:])))


def _rows(heads: tuple[str, ...], units: tuple[str, ...], body: list[tuple[str, ...]]) -> Iterator[PrintedRow]:
    group = ""
    for cells in body:
        if cells[0].startswith("**") and not any(cells[1:]):
            group = cells[0].strip("*")
        else:
            yield PrintedRow(group, heads, units, cells)


def _notes(lines: list[str]) -> Iterator[str]:
    for line in lines:
        if line.startswith(("#", "**Table", "**Figure", "![", "|")):
            return
        if line:
            yield line.replace("\\", "")


def _cells(line: str) -> tuple[str, ...]:
    """Cells of a line of a table, without what protects signs from being read as marks."""
    cells = re.split(r"(?<!\\)\|", line.strip())[1:-1]
    return tuple(re.sub(r"\\(?=[\[\]_*|<>#~`])", "", cell).strip() for cell in cells)
