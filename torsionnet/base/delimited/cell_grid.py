"""Spreadsheets as text: rows of cells with their line and column, and the comment lines around them.

Reading of numbers in the spellings that spreadsheets of several countries use. All numbers of a sheet together decide
its decimal sign.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from torsionnet.base.delimited.dialect import detect_encoding
from torsionnet.base.errors import Fault, ModelError, Position

# Tables of text whose columns are aligned by blanks, as of reports and mails.

_RUN = re.compile(r"\S+(?: \S+)*")
"""Expression of a text without two blanks side by side."""
_NUMBER = re.compile(r"[+\-−]?[\d.,'’]*\d(?:[eE][+\-]?\d+)?")
_RULE = re.compile(r"[\s\-=_+|]*")
"""Expression of a line that only separates others."""
MOST_WORDS = 2
"""Largest number of words of a line with one text that may be a row of a table; more are a sentence."""
CellText = tuple[str, int, int]
"""Text of a cell, its line and its column, from 1."""


@dataclass
class _Column:
    """Characters of a line, from start to end, that may be a column of a table."""

    start: int
    end: int

    def text(self, line: str) -> str:
        return line[self.start : self.end].strip()


def aligned_rows(body: Iterable[tuple[int, str]]) -> list[list[CellText]]:
    """Cells of a table by row, with their line and column; a line that is no row is one cell.

    Columns are apart where all rows have a blank, but for blanks within a heading or a name. Empty where the lines are
    no such table.

    >>> lines = ["Mass of 2020", "Name      J [kg m2]", "Cyl. 1        0,45", "Cyl. 2       14"]
    >>> rows = aligned_rows(enumerate(lines, 1))
    >>> [[text for text, _, _ in row] for row in rows]
    [['Mass of 2020'], ['Name', 'J [kg m2]'], ['Cyl. 1', '0,45'], ['Cyl. 2', '14']]
    """
    lines = [(number, line.replace("\t", " ")) for number, line in body if not _RULE.fullmatch(line)]
    runs = [_RUN.findall(line) for _, line in lines]
    most = max(map(len, runs), default=0)
    # The headings are the longest row without numbers; titles above are no rows.
    heads = [0 if any(map(_NUMBER.fullmatch, texts)) else len(texts) for texts in runs]
    begin = heads.index(max(heads)) if heads else 0
    while begin and 2 * heads[begin - 1] >= most and lines[begin - 1][0] == lines[begin][0] - 1:
        begin -= 1
    table = [line for line, texts in zip(lines[begin:], runs[begin:], strict=True) if _is_row(texts, most)]
    if most < 2 or 2 * len(table) <= len(lines):
        return []
    texts = [line for _, line in table]
    first = next((at for at, line in enumerate(texts) if any(map(_NUMBER.fullmatch, _RUN.findall(line)))), len(texts))
    columns = _joined(_apart(texts), texts[:first], texts[first:])
    inside = {number for number, _ in table}
    return [[_cell(column, number, line) for column in columns] if number in inside
            else [(line.strip(), number, len(line) - len(line.lstrip()) + 1)] for number, line in lines]  # fmt: skip


def _is_row(runs: Sequence[str], most: int) -> bool:
    """Whether a line is a row of a table: of at least half as many texts as the longest, or with a number."""
    if len(runs) == 1:
        return len(runs[0].split()) <= MOST_WORDS and any(map(_NUMBER.fullmatch, runs[0].split()))
    return 2 * len(runs) >= most or any(map(_NUMBER.fullmatch, runs))


def _apart(lines: Sequence[str]) -> list[_Column]:
    """Columns between the places at which every line has a blank."""
    width = max(map(len, lines))
    filled = "".join("x" if any(at < len(line) and line[at] != " " for line in lines) else " " for at in range(width))
    return [_Column(match.start(), match.end()) for match in re.finditer(r"x+", filled)]


def _joined(columns: Sequence[_Column], heads: Sequence[str], below: Sequence[str]) -> list[_Column]:
    """Columns without those that only blanks in a heading, a name or above a number set apart."""
    done = [columns[0]]
    for column in columns[1:]:
        before = done[-1]
        if _belong_together(before, column, heads, below):
            done[-1] = _Column(before.start, column.end)
        else:
            done.append(column)
    return done


def _belong_together(first: _Column, second: _Column, heads: Sequence[str], below: Sequence[str]) -> bool:
    headed = [any(column.text(line) for line in heads) for column in (first, second)]
    filled = [any(column.text(line) for line in below) for column in (first, second)]
    both = [line for line in (*heads, *below) if first.text(line) and second.text(line)]
    if (all(headed) and all(filled)) or any(_NUMBER.fullmatch(first.text(line)) and _NUMBER.fullmatch(second.text(line))
                                            for line in both):  # fmt: skip
        return False
    if not both:
        # A number beside its heading, not below it.
        return headed != [True, True] and filled != [True, True]
    return all("  " not in line[first.start : second.end].strip() for line in both)


def _cell(column: _Column, number: int, line: str) -> CellText:
    text = column.text(line)
    return " ".join(text.split()), number, (line.find(text, column.start) if text else column.start) + 1


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

    def fault(self, text: str, cell: Cell, severity: str = "error", *, kind: str) -> Fault:
        """Fault in a cell of the sheet, with its position in the file."""
        return Fault(text, severity=severity, position=self.position(cell), kind=kind)

    def position(self, cell: Cell) -> Position:
        """Position of a cell in the file."""
        source = self.lines[cell.line - 1][:200].replace("\t", " ") if cell.line <= len(self.lines) else ""
        end = cell.column + max(len(cell.text), 1)
        return Position(self.file, cell.line, cell.column, end, source)


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
            raise ModelError([Fault(text, position=Position(path.name, 1, 1, 2), kind="wrong-file")], path.name)
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
    return ModelError(
        [Fault(text, position=Position(file, 1, 1, 2, lines[0][:200] if lines else ""), kind="unreadable-file")], file
    )


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
        begin = line.find(text.split(" ")[0], at) if text else -1
        column = begin if begin >= 0 else min(at, len(line))
        placed.append(Cell(text, number, column + 1))
        at = column + len(text) if text else column + 1
    return tuple(placed)


# Reading of numbers in the spellings that spreadsheets of several countries use.

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
    match = re.fullmatch(
        rf"(?P<sign>[+\-−]?)(?:(?P<whole>{whole})(?:{sign}(?P<part>\d*))?|{sign}(?P<only>\d+))(?P<power>[eE][+\-−]?\d+)?",
        text,
    )
    if match is None:
        return None
    digits = re.sub(r"\D", "", match["whole"] or "0").lstrip("0") or "0"
    decimals = match["part"] or match["only"] or ""
    power = (match["power"] or "").replace("−", "-")
    return f"{'-' if match['sign'] in ('-', '−') else ''}{digits}{'.' if decimals else ''}{decimals}{power}"
