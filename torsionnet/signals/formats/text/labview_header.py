"""Reading of headers of LabVIEW's measurement files, and of text exports with the same entries."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from torsionnet.base.delimited.dialect import Dialect, split_heading
from torsionnet.base.errors import Fault, ModelError, Position, remedy
from torsionnet.signals.records.clock import UNIFORM_TOLERANCE

# Lines of LabVIEW's text files, of headers and rows told apart, and the separator of their cells.

FIRST_LINE, END, X_VALUE, COMMENT = "LabVIEW Measurement", "***End_of_Header***", "X_Value", "Comment"
SPECIAL, SPECIAL_END = "***Start_Special***", "***End_Special***"
SEGMENT_KEYS = frozenset({"Channels", "Samples", "Y_Unit_Label", "Y_Dimension", "X_Dimension", "X0", "Delta_X"})
"""Entries that the header of a LabVIEW segment has for every channel, besides Date and Time."""
SEPARATORS = {"tab": "\t", "comma": ",", "semicolon": ";"}
"""Separators of cells by their names in a header of a LabVIEW file."""
_KEYS = SEGMENT_KEYS | {"Date", "Time", X_VALUE}


@dataclass
class HeadedLines:
    """Lines of a text file with their numbers, of which the last one taken can be given back."""

    lines: Iterator[str]
    number: int = 0
    _back: list[str] = field(default_factory=list)

    def take(self) -> str:
        """Next line of the LabVIEW file, an empty text at its end."""
        line = self._back.pop() if self._back else next(self.lines, "")
        self.number += bool(line)
        return line

    def give_back(self, line: str) -> None:
        """Put back the line that was taken last, so that it is read again."""
        self._back.append(line)
        self.number -= 1

    def data(self) -> Iterator[str]:
        """Yield the lines of numbers up to the next header, with blank lines only where more numbers follow."""
        blank = 0
        while line := self.take():
            if line.startswith(SPECIAL):
                while line and not line.startswith(SPECIAL_END):
                    blank, line = blank + 1, self.take()
                blank += bool(line)
            elif not line.strip():
                blank += 1
            elif line.startswith("***") or (line[0].isalpha() and re.split(r"[\t,;]", line)[0].strip() in _KEYS):
                self.give_back(line)
                return
            else:
                yield from ["\n"] * blank
                blank = 0
                yield line


def is_labview(lines: Sequence[str]) -> bool:
    """Whether a text begins as LabVIEW's measurement files do, or has a header with the same entries."""
    keys = {re.split(r"[\t,;]", line.lstrip("\ufeff"), maxsplit=1)[0].strip() for line in lines}
    return bool(lines) and (lines[0].startswith(FIRST_LINE) or END in keys or {"Delta_X", X_VALUE} <= keys)


def dialect_of(lines: Iterable[str], file: str, separator: str | None, decimal: str | None) -> Dialect:
    """Separator and decimal sign that a LabVIEW header gives, unless ``separator`` and ``decimal`` are given."""
    said: dict[str, tuple[int, str]] = {}
    between = "\t"
    for number, line in enumerate(lines, 1):
        match = re.match(r"(Separator|Decimal_Separator|Delta_X|X_Value)([\t,;])\s*([^\t\r\n]*)", line)
        if match:
            between = match[2] if match[1] != "Decimal_Separator" else between
            said.setdefault(match[1], (number, match[3].strip(" ,;") or match[3].strip()))
    number, word = said.get("Separator", (1, ""))
    known = SEPARATORS.get(word.casefold())
    if word and known is None and separator is None:
        raise line_error(f'Separator is "{word}"; expected Tab, Comma or Semicolon', file, number, kind="unknown-word")
    sign = decimal or said.get("Decimal_Separator", (0, "."))[1] or ","
    if sign not in (".", ","):
        raise line_error(
            f'Decimal_Separator is "{sign}"; expected . or ,', file, said["Decimal_Separator"][0], kind="unknown-word"
        )
    chosen = separator or known or between
    if chosen == sign:
        raise line_error(
            "Separator and Decimal_Separator are the same sign; correct one, or give "
            f"{remedy('separator=')} and {remedy('decimal=')}",
            file,
            number,
            kind="contradicting-values",
        )
    return Dialect(chosen, sign)


def line_error(text: str, file: str, line: int, source: str = "", *, kind: str) -> ModelError:
    """Error on a line of a text file, with the position of that line."""
    position = Position(file, line, 1, 2, source.rstrip()[:200].replace("\t", " "))
    return ModelError([Fault(text, position=position, kind=kind)], file)


LARGEST_NUMBER = 1e15
"""Largest number that the header of a recording may hold, as larger ones are damage."""
_NUMBER = re.compile(r"[+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][+-]?\d+)?")


@dataclass(frozen=True)
class Segment:
    """Header of a segment of a LabVIEW file, with names and units of its channels and their columns.

    ``columns`` are those of the channels in the rows below, ``times`` those of X_Value.

    ``interval`` is Delta_X and ``start`` X0, both in s; ``clock`` is the time of day in s.
    """

    line: int
    names: tuple[str, ...]
    units: tuple[str, ...]
    columns: tuple[int, ...]
    times: tuple[int, ...]
    width: int
    start: float
    interval: float | None
    interval_place: Position | None
    samples: int | None
    begun: str
    clock: float | None
    heading: Position

    @property
    def labels(self) -> list[str]:
        """Name of every column of the rows in a segment."""
        known = dict(zip(self.columns, self.names, strict=True))
        return [known.get(at, X_VALUE if at in self.times else COMMENT) for at in range(self.width)]


@dataclass(frozen=True)
class _Entry:
    line: int
    cells: list[str]
    text: str

    def place(self, file: str, separator: str, cell: int = 1) -> Position:
        """Position of a cell of the header's entry in the file."""
        parts = self.text.rstrip("\r\n").split(separator)
        at = sum(len(part) + 1 for part in parts[:cell]) if cell < len(parts) else 0
        width = len(parts[cell]) if cell < len(parts) else len(self.text.rstrip())
        return Position(file, self.line, at + 1, at + 1 + max(width, 1), self.text.rstrip()[:200].replace("\t", " "))


def next_segment(lines: HeadedLines, file: str, dialect: Dialect, *, is_first: bool) -> Segment | None:
    """Header of the next segment of a LabVIEW file with its row of names; None at the end of the file."""
    entries, ends, line, whole = dict[str, _Entry](), 0, "", False
    while line := lines.take():
        key, *cells = (cell.strip() for cell in line.rstrip("\r\n").lstrip("\ufeff").split(dialect.separator))
        if key == SPECIAL:
            while line and not line.startswith(SPECIAL_END):
                line = lines.take()
        elif key == END:
            ends += 1
        elif key.startswith(FIRST_LINE):
            whole = True
        elif key == X_VALUE:
            if whole and ends < 2:
                raise line_error(_no_end(ends), file, lines.number, line, kind="wrong-file")
            return _segment(file, dialect, entries, _Entry(lines.number, [key, *cells], line))
        elif key in SEGMENT_KEYS and whole and not ends:
            raise line_error(_no_end(0), file, lines.number, line, kind="wrong-file")
        elif dialect.is_data(line):
            raise line_error(f"numbers begin without a row of names above them that begins with {X_VALUE}", file,
                           lines.number, line, kind="wrong-file")  # fmt: skip
        elif key:
            entries[key] = _Entry(lines.number, cells, line)
    if is_first or entries:
        text = f"the file ends within its header: no row of names follows that begins with {X_VALUE}"
        raise line_error(text, file, max(lines.number, 1), kind="wrong-file")
    return None


def _no_end(ends: int) -> str:
    which = "the header of the file" if not ends else "the header of the channels"
    return f"{END} is missing above this line: {which} ends with it"


def _segment(file: str, dialect: Dialect, entries: Mapping[str, _Entry], heading: _Entry) -> Segment:
    cells = list(heading.cells)
    while len(cells) > 1 and not cells[-1]:
        cells.pop()
    times = tuple(at for at, cell in enumerate(cells) if cell == X_VALUE)
    columns = tuple(at for at, cell in enumerate(cells) if cell not in (X_VALUE, COMMENT))
    place = heading.place(file, dialect.separator, 0)
    faults: list[Fault] = []
    channels = _whole(entries.get("Channels"), "Channels", file, dialect, faults)
    if channels is not None and channels != len(columns):
        said = entries["Channels"].line
        text = f"the row of names has {len(columns)} channel{'s' * (len(columns) != 1)}, Channels in line {said} says"
        faults.append(Fault(f"{text} {channels}; columns were lost or added", position=place, kind="wrong-count"))
    pairs = [split_heading(cells[at]) for at in columns]
    labels = _cells(entries, "Y_Unit_Label", len(columns))
    units = tuple(label or unit for label, (_, unit) in zip(labels, pairs, strict=True))
    names = tuple(
        (cells[at] if label else name) or f"column_{at + 1}"
        for at, label, (name, _) in zip(columns, labels, pairs, strict=True)
    )
    for at, what in enumerate(entries["X_Dimension"].cells if "X_Dimension" in entries else (), 1):
        if what and what.casefold() != "time":
            text = f"the values are over {what}; only values over time can be read as a recording"
            faults.append(
                Fault(text, position=entries["X_Dimension"].place(file, dialect.separator, at), kind="wrong-file")
            )
    intervals = _numbers_by_cell(entries.get("Delta_X"), "Delta_X", file, dialect, faults)
    starts = _numbers_by_cell(entries.get("X0"), "X0", file, dialect, faults)
    for at, value in intervals:
        if not value > 0:
            text = f"Delta_X is {value:g} s; the time between two samples is positive"
            faults.append(
                Fault(text, position=entries["Delta_X"].place(file, dialect.separator, at), kind="out-of-range")
            )
    for what, given in (("Delta_X", intervals), ("X0", starts)):
        odd = next(((at, value) for at, value in given if value != given[0][1]), None)
        if odd is not None:
            text = f"channels have {what} of {given[0][1]:g} and {odd[1]:g} s: they were not sampled together"
            position = entries[what].place(file, dialect.separator, odd[0])
            faults.append(Fault(f"{text}; save them in files of their own", position=position, kind="unlike-results"))
    near = UNIFORM_TOLERANCE * (intervals[0][1] if intervals else 0.0)
    clocks = _cells(entries, "Time", len(columns))
    passed = [(_clock(cell) or 0.0) - (_clock(clocks[0]) or 0.0) if cell else 0.0 for cell in clocks]
    late = next((at for at, seconds in enumerate(passed) if abs(seconds) > near), None)
    if late is not None:
        text = f"channels began at {clocks[0]} and {clocks[late]}, as Time says: they were not sampled together"
        position = entries["Time"].place(file, dialect.separator, late + 1)
        faults.append(Fault(f"{text}; save them in files of their own", position=position, kind="unlike-results"))
    samples = [int(value) for _, value in _numbers_by_cell(entries.get("Samples"), "Samples", file, dialect, faults)]
    if faults:
        raise ModelError(faults, file)
    begun = [entries[key].cells[0] for key in ("Date", "Time") if key in entries and entries[key].cells]
    return Segment(
        heading.line, names, units, columns, times, len(cells), starts[0][1] if starts else 0.0,
        intervals[0][1] if intervals else None,
        entries["Delta_X"].place(file, dialect.separator) if intervals else None,
        max(samples) if samples else None, " ".join(part for part in begun if part),
        _clock(entries["Time"].cells[0]) if "Time" in entries and entries["Time"].cells else None, place,
    )  # fmt: skip


def _cells(entries: Mapping[str, _Entry], key: str, count: int) -> list[str]:
    cells = entries[key].cells[:count] if key in entries else []
    return [*cells, *[""] * (count - len(cells))]


def _whole(entry: _Entry | None, key: str, file: str, dialect: Dialect, faults: list[Fault]) -> int | None:
    numbers = _numbers_by_cell(entry, key, file, dialect, faults)
    return int(numbers[0][1]) if numbers else None


def _numbers_by_cell(
    entry: _Entry | None, key: str, file: str, dialect: Dialect, faults: list[Fault]
) -> list[tuple[int, float]]:
    """Numbers of an entry of a header with the number of their cell, whatever their decimal sign."""
    numbers = []
    for at, cell in enumerate(entry.cells if entry else (), 1):
        assert entry is not None
        value = float(cell.replace(",", ".")) if _NUMBER.fullmatch(cell) else float("nan")
        if abs(value) <= LARGEST_NUMBER:
            numbers.append((at, value))
        elif cell:
            faults.append(
                Fault(
                    f'{key}: "{cell}" is not a number up to {LARGEST_NUMBER:g}',
                    position=entry.place(file, dialect.separator, at),
                    kind="not-a-number",
                )
            )
    return numbers


def _clock(text: str) -> float | None:
    """Seconds since midnight of a time of day such as ``10:12:13.001``, None for other text."""
    match = re.fullmatch(r"(\d{1,2}):(\d{2}):(\d{2}(?:[.,]\d+)?)", text.strip())
    return int(match[1]) * 3600 + int(match[2]) * 60 + float(match[3].replace(",", ".")) if match else None
