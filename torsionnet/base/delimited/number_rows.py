"""Rows of numbers in a text file, parsed in pieces, with the position of every cell that is not a number."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.delimited.dialect import (
    NANOSECONDS_PER_DAY,
    NANOSECONDS_PER_SECOND,
    STAMP_PATTERN,
    Dialect,
    day_month_order,
    invalid_date,
    nanoseconds,
    ordinal,
    stamp_format,
    written_date,
    zone_offset,
)
from torsionnet.base.errors import Fault, ModelError, Position

# Columns of time stamps, with or without a date, as seconds from the first stamp.

FloatArray = NDArray[np.float64]


@dataclass
class StampReader:
    """Reader of a column of time stamps, which all have one format; ``first`` is the first of them."""

    first: str = ""
    _form: tuple[str, ...] = ()
    _mark: str = ""
    _begun: bool = False
    _begin: int = 0
    _last: int = 0
    _days: int = 0
    _first_date: str = ""
    _dates: dict[str, int] = field(default_factory=dict)

    def seconds(self, texts: Sequence[str]) -> tuple[FloatArray, list[tuple[int, str]]]:
        """Seconds since the first stamp, shape (n_texts,), NaN for empty cells, and (index, message) of faults."""
        if texts and not self.first and (begins := STAMP_PATTERN.fullmatch(texts[0])):
            self._unlike(texts[0], begins)
            self._learn_date(written_date(begins), texts[:1])
        quick = self._alike(texts)
        faults: list[tuple[int, str]] = []
        if quick is not None:
            clocks, known = quick, np.ones(len(texts), dtype=bool)
        else:
            clocks, known = np.zeros(len(texts), dtype=np.int64), np.zeros(len(texts), dtype=bool)
            matches = [STAMP_PATTERN.fullmatch(text) for text in texts]
            for at, (text, stamp) in enumerate(zip(texts, matches, strict=True)):
                wrong = self._unlike(text, stamp) if text else ""
                if wrong:
                    faults.append((at, wrong))
                elif stamp:
                    unknown = written_date(stamp) not in self._dates and self._learn_date(
                        written_date(stamp), texts[at:]
                    )
                    if unknown:  # no date below it can be counted either
                        faults.append((at, unknown))
                        break
                    clocks[at], known[at] = (
                        nanoseconds(stamp) + self._dates.get(written_date(stamp), 0) * NANOSECONDS_PER_DAY,
                        True,
                    )
        if faults:
            return np.full(len(texts), np.nan), faults
        return self._counted(clocks, known), []

    def _counted(self, clocks: NDArray[np.int64], known: NDArray[np.bool_]) -> FloatArray:
        values = clocks[known]
        if self._form and not self._form[0]:  # a clock without a date passes midnight
            before = np.concatenate([[self._last] if self._begun else values[:1], values[:-1]])[: len(values)]
            # A clock that falls by more than half a day has passed midnight.
            days = self._days + np.cumsum(values - before < -NANOSECONDS_PER_DAY // 2)
            self._last = int(values[-1]) if len(values) else self._last
            self._days = int(days[-1]) if len(days) else self._days
            values = values + days * NANOSECONDS_PER_DAY
        if len(values) and not self._begun:
            self._begin, self._begun = int(values[0]), True
        seconds = np.full(len(clocks), np.nan)
        seconds[known] = (values - self._begin) / NANOSECONDS_PER_SECOND
        return seconds

    def _unlike(self, text: str, stamp: re.Match[str] | None) -> str:
        """Message about a time stamp whose format differs from that of the first stamp."""
        if stamp is None:
            return f'"{text}" is not a time stamp; write it like "{self.first or "10:12:13.001"}"'
        form, mark = stamp_format(stamp), stamp["mark"] or ""
        if not self.first:
            self.first, self._form = text, form
        self._mark = self._mark or mark
        if form != self._form or (mark and mark != self._mark):
            return f'"{text}" is written otherwise than the time stamps above it, like "{self.first}"; write all alike'
        return ""

    def _learn_date(self, text: str, left: Sequence[str]) -> str:
        """Message about the date of a time stamp that cannot be read.

        A good date is stored as days from the first date.
        """
        if not text:
            return ""
        order = self._form[0]
        if not self._first_date:
            if order != "either" and ordinal(text, order) is None:
                return invalid_date(text)
            self._first_date, self._dates[text] = text, 0
            return ""
        if order == "either":
            later = {written_date(stamp) for stamp in map(STAMP_PATTERN.fullmatch, left) if stamp}
            orders = {order for written in (*self._dates, *later) if (order := day_month_order(written))}
            if len(orders) != 1:
                what = "whether day or month comes first is not said" if not orders else "day and month change places"
                return f"the date changes from {self._first_date} to {text}: {what}; write dates as 2024-05-03"
            (order,) = orders
        days, begun = ordinal(text, order), ordinal(self._first_date, order)
        if days is None or begun is None:
            return invalid_date(text)
        self._dates[text] = days - begun
        return ""

    def _alike(self, texts: Sequence[str]) -> NDArray[np.int64] | None:
        """Nanoseconds, shape (n_texts,), of stamps that differ only in the digits of their times.

        None for all others.
        """
        stamp = STAMP_PATTERN.fullmatch(texts[0]) if texts else None
        date_text = written_date(stamp) if stamp else ""
        if stamp is None or stamp["half"] or (date_text and date_text not in self._dates):
            return None
        if stamp_format(stamp) != self._form or (stamp["mark"] or self._mark) != self._mark or not texts[0].isascii():
            return None
        try:
            rows = np.array(texts, dtype=f"S{len(texts[0]) + 1}")
        except UnicodeEncodeError:
            return None
        # A row of characters per stamp: but for digits (48 to 57) all are those of the first row.
        signs = rows.view(np.uint8).reshape(len(texts), -1)
        template, fixed = signs[0], np.ones(signs.shape[1], dtype=bool)
        groups = [stamp.span(name) for name in ("hours", "minutes", "seconds", "part")]
        for begin, end in groups:
            fixed[begin:end] = False
        digits = signs[:, ~fixed]
        if (signs[:, fixed] != template[fixed]).any() or (digits < 48).any() or (digits > 57).any():
            return None
        hours, minutes, seconds, part = (_whole(signs[:, begin:end]) for begin, end in groups)
        if (hours > 23).any() or (minutes > 59).any() or (seconds > 60).any():
            return None
        length = groups[3][1] - groups[3][0]
        if length > 9:
            return None
        whole = (hours * 60 + minutes) * 60 + seconds - zone_offset(stamp["zone"])
        nano = whole * NANOSECONDS_PER_SECOND + part * 10 ** (9 - length)
        return np.asarray(nano + self._dates.get(date_text, 0) * NANOSECONDS_PER_DAY, dtype=np.int64)


def _whole(digits: NDArray[np.uint8]) -> NDArray[np.int64]:
    powers = 10 ** np.arange(digits.shape[1] - 1, -1, -1, dtype=np.int64)
    return np.asarray((digits.astype(np.int64) - 48) @ powers, dtype=np.int64)


# Detection of a table of text that ends early, within its last row or within its last number.

COMPARED_ROWS = 3
"""Number of rows above the last one that must all have equally many decimals before a shorter number counts as cut;
with fewer, numbers of varying length would be taken for cut ones."""
_DECIMALS = re.compile(r"[+-]?\d*[.,](?P<decimals>\d+)(?P<exponent>[eEdD][+-]?\d+)?")
_BEGUN = re.compile(r"[+-]?(?:\d+[.,]?\d*|[.,]\d*)?(?:[eEdD][+-]?)?")


def truncation_message(
    cells: Sequence[str], above: Sequence[Sequence[str]], names: Sequence[str], *, own: bool = False
) -> str:
    """Message that the last row of a file without a final line end is cut; empty where the row may be complete.

    ``above`` are rows before it; a file of this package's ``own`` ends with the end of a line.

    >>> truncation_message(["0.2", "-1."], [["0.1", "-1.12"]] * 3, ["time", "T"])
    'the file ends early: the last number of T is cut'
    >>> truncation_message(["0.2"], [["0.1", "-1.12", "3"]], ["time", "T", "phi"])
    'the file ends early: the last row lacks T, phi, and its time may be cut'
    """
    if len(cells) < len(names):
        known = names[len(cells) - 1]
        return f"the file ends early: the last row lacks {', '.join(names[len(cells) :])}, and its {known} may be cut"
    if len(cells) > len(names):
        return ""
    last, others = cells[-1], [row[-1] for row in above if len(row) == len(names)]
    if own or _is_begun(last, others) or _is_shorter(last, others):
        return f"the file ends early: the last number of {names[-1]} is cut"
    return ""


def _is_begun(cell: str, others: Sequence[str]) -> bool:
    """Whether a cell is only the beginning of a number: ``-``, ``1.2e-``, or nothing where there were numbers."""
    if not cell:
        return bool(others) and all(others)
    return _BEGUN.fullmatch(cell) is not None and cell[-1] not in "0123456789.,"


def _is_shorter(cell: str, others: Sequence[str]) -> bool:
    """Whether a number has fewer decimals, or no exponent, where all rows above have equally many."""
    forms = {_form(other) for other in others}
    if len(others) < COMPARED_ROWS or len(forms) != 1:
        return False
    (form,) = forms
    return form is not None and (_form(cell) or (0, 0)) < form


def _form(cell: str) -> tuple[int, int] | None:
    """Number of digits behind the decimal sign of a number, and of characters of its exponent."""
    match = _DECIMALS.fullmatch(cell)
    return (len(match["decimals"]), len(match["exponent"] or "")) if match else None


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
                    self._fault("truncated-file", short, number, line, 0, len(line))
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
            self._fault("not-a-number", text, numbers[row], line, at, max(len(texts[row]), 1))

    def _check_end(self, lines: list[str]) -> None:
        """Add a fault where the last line of a file without a final line end is cut."""
        above = [self.dialect.cells(line)[: self._least] for line in [*self._above, *lines[-1 - COMPARED_ROWS : -1]]]
        last = self.dialect.cells(lines[-1])
        text = truncation_message(
            last if len(last) > self.width else last[: self._least], above, self.names[: self._least], own=self.own
        )
        if text:
            self._fault("truncated-file", text, self.line + len(lines) - 1, lines[-1], 0, len(lines[-1]))

    def _row(self, cells: list[str], line: str, number: int, count: int) -> list[float]:
        if not self._least <= len(cells) <= self.width:
            self._fault("wrong-count", self.other_width(len(cells), self.width), number, line, 0, len(line))
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
        self._fault("not-a-number", self.no_number(cell), number, line, at, len(cell))
        return float("nan")

    def _offset(self, line: str, column: int) -> int:
        if self.dialect.separator == " ":
            return 0
        if '"' in line:
            return max(line.find(f'"{self.dialect.cells(line)[column]}"'), 0)
        return sum(len(part) + 1 for part in line.split(self.dialect.separator)[:column])

    def _fault(self, kind: str, text: str, number: int, line: str, at: int, width: int) -> None:
        if len(self.faults) < MOST_FAULTS:
            source = line[:200].replace("\t", " ")
            position = Position(self.file, number, at + 1, at + 1 + width, source)
            self.faults.append(Fault(text, position=position, kind=kind))
