"""Tables as text for a screen: aligned columns with broken headings, long texts folded, wide tables split."""

from __future__ import annotations

import shutil
import textwrap
from collections.abc import Iterator
from dataclasses import replace
from itertools import zip_longest
from typing import TYPE_CHECKING

from torsionnet.base.number_text import unit_in_brackets

if TYPE_CHECKING:
    from torsionnet.base.table import Table

NARROWEST_HEADING, BETWEEN_COLUMNS = 9, 2
"""Least width in characters of a broken heading, and the gap between columns."""
NARROWEST_FOLDED = 30
"""Least width in characters of a column into which long texts are folded, as narrower ones are hard to read."""
SCREEN_WIDTH = 120
"""Characters of a line to which tables are folded or split where no terminal says how wide it is."""


def terminal_width() -> int:
    """Characters in a line of the terminal, or of a usual one where there is none."""
    return shutil.get_terminal_size((SCREEN_WIDTH, 24)).columns


def aligned_lines(table: Table, width: int | None = None) -> list[str]:
    """Lines of a table as text with aligned columns.

    Title, broken headings, rows; numbers to the right, long texts folded to a width in characters if there is one.
    """
    cells = table.cells()
    right = [table.is_numeric(index) for index in range(len(table.columns))]
    widths, headings = [], []
    for index, column in enumerate(table.columns):
        content = max((len(row[index]) for row in cells), default=0)
        lines = broken_heading(column.name, column.unit, max(content, NARROWEST_HEADING))
        headings.append(lines)
        widths.append(max([content, *map(len, lines)]))
    narrower = widths if width is None else _narrower(widths, right, width)
    if narrower != widths:
        widths, cells = narrower, _folded(cells, narrower)
    height = max((len(lines) for lines in headings), default=0)
    padded = [[*lines, *[""] * (height - len(lines))] for lines in headings]
    rows = [*([lines[level] for lines in padded] for level in range(height)), ["-" * width for width in widths], *cells]
    return [*([table.title] if table.title else []), *(_line(row, widths, right) for row in rows)]


def _narrower(widths: list[int], right: list[bool], screen: int) -> list[int]:
    """Widths in characters of columns, the last one or two of text made narrower to fit the screen."""
    for count in (1, 2):
        if len(widths) < count or any(right[-count:]):
            break
        room = (screen - sum(widths[:-count]) - BETWEEN_COLUMNS * (len(widths) - 1)) // count
        if room >= NARROWEST_FOLDED:
            return [*widths[:-count], *(min(room, width) for width in widths[-count:])]
    return widths


def _folded(cells: list[list[str]], widths: list[int]) -> list[list[str]]:
    """Rows of cells whose long texts are folded over several rows."""
    folded = []
    for row in cells:
        lines = [wrapped(cell, width) if len(cell) > width else [cell] for cell, width in zip(row, widths, strict=True)]
        folded += [list(line) for line in zip_longest(*lines, fillvalue="")]
    return folded


def wrapped(text: str, width: int = SCREEN_WIDTH, indent: str = "") -> list[str]:
    """Lines of a text wrapped to a width in characters; a number stays with its percent sign, and words stay whole."""
    kept = text.replace(" %", "\N{NO-BREAK SPACE}%")
    lines = textwrap.wrap(kept, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)
    return [line.replace("\N{NO-BREAK SPACE}%", " %") for line in lines]


def _line(row: list[str], widths: list[int], right: list[bool]) -> str:
    cells = [
        cell.rjust(width) if is_right else cell.ljust(width)
        for cell, width, is_right in zip(row, widths, right, strict=True)
    ]
    return "  ".join(cells).rstrip()


def broken_heading(name: str, unit: str, width: int) -> list[str]:
    """Lines of a heading with its unit, broken between words to a width in characters."""
    lines = [""]
    for word in [*name.split(" "), *filter(None, [unit_in_brackets(unit)])]:
        if not lines[-1] or len(lines[-1]) + 1 + len(word) <= width:
            lines[-1] = f"{lines[-1]} {word}".strip()
        else:
            lines.append(word)
    return lines


def split_table(table: Table, group: int, screen: int = SCREEN_WIDTH) -> Iterator[Table]:
    """Parts of a table that each fit the screen: the first column, and whole groups of ``group`` columns.

    The title stands over the first block, the notes below the last one.
    """
    start, count = 1, len(table.columns)
    if count == 1:
        yield table
    while start < count:
        end = start + group
        while end < count and _width(_columns(table, start, end + group), screen) <= screen:
            end += group
        block = _columns(table, start, end)
        yield replace(block, title=table.title if start == 1 else "", notes=table.notes if end >= count else ())
        start = end


def _width(table: Table, screen: int) -> int:
    return max(map(len, aligned_lines(table, screen)), default=0)


def _columns(table: Table, start: int, end: int) -> Table:
    return replace(table.chosen([0, *range(start, end)]), title="")
