"""Rows of numbers in a text file, parsed in pieces, with the position of every cell that is not a number."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.delimited.dialect import Dialect
from torsionnet.base.delimited.time_stamps import StampReader
from torsionnet.base.delimited.truncation import COMPARED_ROWS, truncation_message
from torsionnet.base.errors import Fault, ModelError, Position

FloatArray = NDArray[np.float64]
LINES_PER_PIECE = 20_000
"""Lines of a text file parsed at once, as larger pieces take more memory and smaller ones more calls of numpy."""
MOST_FAULTS = 20
"""Largest number of faults reported for one file, as more of the same kind say nothing new."""


def _other_width(cells: int, width: int) -> str:
    return f"the row has {cells} cells, the others have {width}"


def _no_number(cell: str) -> str:
    return f'"{cell}" is not a number'


@dataclass
class NumberRows:
    """Reader of rows of numbers from the lines of a text stream; its faults and counts grow while it reads.

    ``other_width`` and ``no_number`` word the refusal of a row of so many cells instead of so many, and of a cell.
    Columns ``unread`` hold no numbers and are NaN; a row may lack those of them that end it. Those of ``stamped`` hold
    time stamps, the date in the first of two: the first becomes seconds since the first stamp, the second is NaN.
    """

    stream: Iterable[str]
    file: str
    dialect: Dialect
    width: int
    line: int
    names: Sequence[str]
    own: bool = False
    other_width: Callable[[int, int], str] = _other_width
    no_number: Callable[[str], str] = _no_number
    unread: frozenset[int] = frozenset()
    stamped: tuple[int, ...] = ()
    stamps: StampReader = field(default_factory=StampReader)
    faults: list[Fault] = field(default_factory=list)
    read: int = 0
    filled: FloatArray = field(init=False)
    empty: FloatArray = field(init=False)

    _above: list[str] = field(default_factory=list)
    _columns: list[int] = field(init=False)
    _least: int = field(init=False)

    def __post_init__(self) -> None:
        self.filled, self.empty = np.zeros(self.width), np.zeros(self.width)
        used = [column for column in range(self.width) if column not in self.unread]
        self._columns = [column for column in used if column not in self.stamped]
        self._least = used[-1] + 1 if used else self.width

    def blocks(self, columns: Sequence[int], count: int) -> Iterator[list[FloatArray]]:
        """Blocks of ``count`` rows, or one of all, each with an array of shape (n_rows,) per column.

        Raises :class:`ModelError` with all faults of a block.
        """
        while True:
            pieces = list(self._pieces(columns, count))
            if self.faults:
                raise ModelError(self.faults, self.file)
            if not pieces:
                return
            yield [np.concatenate([piece[:, i] for piece in pieces]) for i in range(len(columns))]

    def _pieces(self, columns: Sequence[int], count: int) -> Iterator[FloatArray]:
        left = count or None
        while left is None or left > 0:
            lines = list(islice(self.stream, min(LINES_PER_PIECE, left) if left else LINES_PER_PIECE))
            if not lines:
                return
            values = self._parsed(lines)
            if lines[-1].strip() and not lines[-1].endswith("\n") and not self.faults:
                self._check_end(lines)
            self._above = lines[-COMPARED_ROWS:]
            self.line += len(lines)
            self.read += len(values)
            left = None if left is None else left - len(lines)
            if len(values) and len(self.faults) < MOST_FAULTS:
                yield values[:, list(columns)]

    def _parsed(self, lines: list[str]) -> FloatArray:
        both = self.dialect.separator == self.dialect.decimal
        if both or '"' in lines[0] or not lines[0].strip() or self.faults:
            return self._one_by_one(lines)
        text = [line.replace(",", ".") for line in lines] if self.dialect.decimal == "," else lines
        separator = None if self.dialect.separator == " " else self.dialect.separator
        apart = bool(self.unread or self.stamped)
        parts = [line.split(separator) for line in lines] if apart else []
        if not all(self._least <= len(cells) <= self.width for cells in parts):
            return self._one_by_one(lines)
        try:
            columns = self._columns if apart else None
            values = np.loadtxt(text, delimiter=separator, comments=None, ndmin=2, usecols=columns)
        except ValueError:
            return self._one_by_one(lines)
        if apart and values.shape == (len(lines), len(self._columns)):
            values, read = np.full((len(lines), self.width), np.nan), values
            values[:, self._columns] = read
            self._read_stamps(values, parts, range(self.line, self.line + len(lines)), lines)
        if values.shape != (len(lines), self.width):
            return self._one_by_one(lines)
        self.filled[:] = self.read + len(values)
        return values

    def _one_by_one(self, lines: list[str]) -> FloatArray:
        rows: list[list[float]] = []
        read: list[tuple[list[str], int, str]] = []
        for number, line in enumerate(lines, self.line):
            if line.strip():
                cells = self.dialect.cells(line)
                short = (
                    ""
                    if line.endswith("\n")
                    else truncation_message(cells[: self._least], [], self.names[: self._least])
                )
                if short:
                    self._fault(short, number, line, 0, len(line))
                else:
                    rows.append(self._row(cells, line.rstrip("\r\n"), number, self.read + len(rows) + 1))
                    read.append((cells, number, line))
        values = np.array(rows).reshape(-1, self.width)
        if self.stamped and read:
            self._read_stamps(values, *map(list, zip(*read, strict=True)))
        return values

    def _read_stamps(
        self, values: FloatArray, rows: Sequence[list[str]], numbers: Sequence[int], lines: Sequence[str]
    ) -> None:
        if not self.stamped:
            return
        last = self.stamped[-1]
        if len(self.stamped) == 1:
            texts = [cells[last].strip().strip('"') if last < len(cells) else "" for cells in rows]
        else:
            texts = [" ".join(cells[at].strip().strip('"') for at in self.stamped if at < len(cells)) for cells in rows]
        values[:, self.stamped[0]], wrong = self.stamps.seconds(texts)
        for row, text in wrong:
            line = lines[row].rstrip("\r\n")
            at = max(line.find(rows[row][self.stamped[0]].strip()), 0)
            self._fault(text, numbers[row], line, at, max(len(texts[row]), 1))

    def _check_end(self, lines: list[str]) -> None:
        """Add a fault where the last line of a file without a final line end is cut."""
        above = [self.dialect.cells(line)[: self._least] for line in [*self._above, *lines[-1 - COMPARED_ROWS : -1]]]
        last = self.dialect.cells(lines[-1])
        text = truncation_message(
            last if len(last) > self.width else last[: self._least], above, self.names[: self._least], own=self.own
        )
        if text:
            self._fault(text, self.line + len(lines) - 1, lines[-1], 0, len(lines[-1]))

    def _row(self, cells: list[str], line: str, number: int, count: int) -> list[float]:
        if not self._least <= len(cells) <= self.width:
            self._fault(self.other_width(len(cells), self.width), number, line, 0, len(line))
            return [np.nan] * self.width
        row = [np.nan] * self.width
        for column in self.stamped:
            self.filled[column] = count if cells[column] else self.filled[column]
        for column in self._columns:
            row[column] = self._value(cells, column, line, number, count)
        return row

    def _value(self, cells: list[str], column: int, line: str, number: int, count: int) -> float:
        cell = cells[column]
        if not cell:
            self.empty[column] += 1
            return float("nan")
        self.filled[column] = count
        if self.dialect.is_number(cell):
            return self.dialect.number(cell)
        at = self._offset(line, column) + line[self._offset(line, column) :].find(cell)
        self._fault(self.no_number(cell), number, line, at, len(cell))
        return float("nan")

    def _offset(self, line: str, column: int) -> int:
        if self.dialect.separator == " ":
            return 0
        if '"' in line:
            return max(line.find(f'"{self.dialect.cells(line)[column]}"'), 0)
        return sum(len(part) + 1 for part in line.split(self.dialect.separator)[:column])

    def _fault(self, text: str, number: int, line: str, at: int, width: int) -> None:
        if len(self.faults) < MOST_FAULTS:
            source = line[:200].replace("\t", " ")
            self.faults.append(Fault(text, position=Position(self.file, number, at + 1, at + 1 + width, source)))
