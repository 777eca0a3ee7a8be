"""Spreadsheets as text: rows of cells with their line and column, and the comment lines around them."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from torsionnet.base.delimited.aligned_columns import aligned_rows
from torsionnet.base.delimited.dialect import detect_encoding
from torsionnet.base.errors import Fault, ModelError, Position

CELL_SEPARATORS = (";", "\t", "|", ",")
"""Characters that may separate the cells of a sheet, tried in this order."""
COMMENT_MARKS = ("#", "%", "//")
"""Characters with which a comment line of a sheet begins."""
MOST_ROWS = 5000
"""Largest number of rows of a sheet, as a drivetrain has some hundred masses, and more rows are some other file."""
_OTHER_COMMA = re.compile(r"(?<!\d),|,(?!\d)")
"""Expression of a comma that is no decimal sign."""
_BINARY = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0")
"""First bytes of files of spreadsheet programs (xlsx and xls), which are no text."""


@dataclass(frozen=True)
class Cell:
    """Text of one cell of a sheet, and the line and column, from 1, where it begins."""

    text: str
    line: int
    column: int


@dataclass(frozen=True)
class CellGrid:
    """Filled cells of a sheet by row, with the separator (a blank: aligned columns) and the lines of the file.

    ``remarks`` are its comment lines, without their marks.
    """

    file: str
    separator: str
    rows: tuple[tuple[Cell, ...], ...]
    remarks: tuple[Cell, ...]
    lines: tuple[str, ...]

    def fault(self, text: str, cell: Cell, severity: str = "error") -> Fault:
        """Fault in a cell of the sheet, with its position in the file."""
        source = self.lines[cell.line - 1][:200].replace("\t", " ") if cell.line <= len(self.lines) else ""
        end = cell.column + max(len(cell.text), 1)
        return Fault(text, severity=severity, position=Position(self.file, cell.line, cell.column, end, source))


def read_grid(path: Path) -> CellGrid:
    """Cells by row in a text file, with the cell separator detected.

    Raises
    ------
    ModelError
        It is no text, has no columns, or too many rows.
    """
    with path.open("rb") as file:
        if file.read(4).startswith(_BINARY):
            text = f'"{path.name}" is a file of a spreadsheet program; save the sheet as CSV'
            raise ModelError([Fault(text, position=Position(path.name, 1, 1, 2))], path.name)
    with path.open(encoding=detect_encoding(path), newline=None, errors="replace") as file:
        return parse_grid(file.read().splitlines(), path.name)


def parse_grid(lines: Sequence[str], file: str) -> CellGrid:
    """Cells by row in lines of text, with the cell separator detected.

    >>> grid = parse_grid(["# of 2020", "mass;J", "disc; 0,5"], "x.csv")
    >>> grid.separator, [cell.text for cell in grid.rows[1]], grid.rows[1][1].column, grid.remarks[0].text
    (';', ['disc', '0,5'], 7, 'of 2020')
    """
    remarks = tuple(Cell(text.strip(), number, line.index(text) + 1) for number, line in enumerate(lines, 1)
                    if line.lstrip().startswith(COMMENT_MARKS) and (text := line.lstrip("#%/ \t")))  # fmt: skip
    body = [(number, line) for number, line in enumerate(lines, 1) if not line.lstrip().startswith(COMMENT_MARKS)]
    filled = [line for _, line in body if line.strip()]
    if len(filled) > MOST_ROWS:
        raise _refused(f"the sheet has more than {MOST_ROWS} rows; keep only rows of masses and shafts", file, lines)
    separator = next((sign for sign in CELL_SEPARATORS if 2 * sum(sign in line for line in filled) > len(filled)), None)
    if separator is None or (separator == "," and not any(map(_OTHER_COMMA.search, filled))):
        aligned = aligned_rows(body)
        separator = " " if aligned else separator
    if separator is None:
        what = "found no columns; they are separated by semicolons, commas or tabs, or aligned by blanks"
        raise _refused(what if filled else "the sheet is empty", file, lines)
    try:
        rows = [*map(_aligned_cells, aligned)] if separator == " " else _rows(body, separator)
    except csv.Error as error:
        raise _refused(f"this cannot be read as a table: {error}", file, lines) from None
    return CellGrid(
        file, separator, tuple(row for row in rows if any(cell.text for cell in row)), remarks, tuple(lines)
    )


def _aligned_cells(row: Sequence[tuple[str, int, int]]) -> tuple[Cell, ...]:
    return tuple(Cell(*cell) for cell in row)


def _refused(text: str, file: str, lines: Sequence[str]) -> ModelError:
    return ModelError([Fault(text, position=Position(file, 1, 1, 2, lines[0][:200] if lines else ""))], file)


def _rows(body: Sequence[tuple[int, str]], separator: str) -> list[tuple[Cell, ...]]:
    reader = csv.reader((f"{line}\n" for _, line in body), delimiter=separator, skipinitialspace=separator != "\t")
    rows, before = [], 0
    for cells in reader:
        number, line = body[before]
        rows.append(_placed(cells, number, line))
        before = reader.line_num
    return rows


def _placed(cells: Sequence[str], number: int, line: str) -> tuple[Cell, ...]:
    """Cells of one row, each with its line and column in the file; text over several lines is joined to one line."""
    placed, at = [], 0
    for cell in cells:
        text = " ".join(cell.split())
        found = line.find(text.split(" ")[0], at) if text else -1
        column = found if found >= 0 else min(at, len(line))
        placed.append(Cell(text, number, column + 1))
        at = column + len(text) if text else column + 1
    return tuple(placed)
