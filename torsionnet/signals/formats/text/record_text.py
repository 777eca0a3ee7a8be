"""Recordings in CSV and other text files of columns, whose separator, decimal sign, names and units are detected.

Headings of the text files of oscilloscopes that tell first time and interval of the samples, but list no times. Rigol
DS and MSO1000Z: ``X,CH1,Start,Increment`` above ``Sequence,Volt,-1.2E-02,1E-04``; MSO5000: ``CH1(V),t0 = -25s, tInc =
2e-06s``.
"""

from __future__ import annotations

import contextlib
import io
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice, zip_longest
from pathlib import Path

from torsionnet.base.atomic import atomic_replacement
from torsionnet.base.delimited.dialect import (
    Dialect,
    Headings,
    data_start,
    detect_dialect,
    detect_encoding,
    headings,
    stamp_columns,
)
from torsionnet.base.delimited.number_rows import NumberRows, StampReader
from torsionnet.base.errors import Fault, ModelError, Position, UsageError, remedy
from torsionnet.base.notes import NoteOrText
from torsionnet.signals.formats.text.labview_header import is_labview
from torsionnet.signals.formats.text.labview_text import EmptyCells, check_lengths, labview_source
from torsionnet.signals.recording import FloatArray, Recording
from torsionnet.signals.records.arrays import with_table_clocks
from torsionnet.signals.records.source import (
    KEY,
    TIME,
    FileChannel,
    Source,
    check_names,
    is_time,
    plain_keys,
    recording_json,
    with_description,
)

# Tables of numbers as CSV with a line of description above them, which this module also reads.

ROWS_PER_PIECE = 20_000
"""Rows of a CSV file that are converted to text at a time, as more take more memory, fewer more time."""


def description_in(comments: Iterable[str], key: str) -> str | None:
    """Description after ``key`` in the first comment of a CSV file that has it; None where none has.

    >>> description_in(["% a comment", '# torsionnet_recording: {"title": "run 7"}'], "torsionnet_recording")
    '{"title": "run 7"}'
    """
    matches = (re.match(rf"#\s*{key}:\s*(.*)", comment) for comment in comments)
    return next((match[1] for match in matches if match), None)


def write_columns(
    path: Path, key: str, description: str, headings: Sequence[str], columns: Sequence[FloatArray]
) -> None:
    """Write a CSV file of a line of description, headings, and the columns beside each other with all digits."""
    with atomic_replacement(path) as temporary, temporary.open("w", encoding="utf-8", newline="\n") as file:
        file.write(f"# {key}: {description}\n{','.join(headings)}\n")
        for first in range(0, len(columns[0]), ROWS_PER_PIECE):
            rows = zip(*(column[first : first + ROWS_PER_PIECE].tolist() for column in columns), strict=True)
            file.writelines(",".join(map(repr, row)) + "\n" for row in rows)


# Headings of the text files of oscilloscopes that tell first time and interval of the samples, but list no times.

START, INCREMENT, COUNTED = "start", "increment", "sequence"
"""Headings above the first time and the interval in s, and the unit of a column that counts samples, in lower case."""
_STATED = re.compile(r"\s*(?P<name>t0|tinc)\s*=\s*(?P<number>[+-]?[\d.]+(?:[eE][+-]?\d+)?)\s*s?\s*", re.IGNORECASE)
_CHANNEL = re.compile(r"\s*(?P<name>[^()]*[^()\s])\s*(?:\((?P<unit>[^()]*)\))?\s*")


@dataclass(frozen=True)
class ScopeHeading:
    """Names and units of the columns of an oscilloscope's file, with the clock that its heading tells.

    ``start`` and ``interval`` are in s; the first ``skipped`` columns only count samples.
    """

    headings: Headings
    start: float
    interval: float
    skipped: int = 0


def scope_heading(dialect: Dialect, above: Sequence[str], width: int) -> ScopeHeading | None:
    """Heading of an oscilloscope's file in the lines above its numbers, None where there is none of these kinds.

    >>> lines = ["X,CH1,Start,Increment,", "Sequence,Volt,-1.2E-02,1.0E-04,"]
    >>> scope = scope_heading(Dialect(","), lines, 3)
    >>> scope.headings.names, scope.headings.units, scope.start, scope.interval
    (('X', 'CH1', ''), ('Sequence', 'Volt', ''), -0.012, 0.0001)
    """
    if len(above) > 1:
        names, second = (dialect.cells(line) for line in above[-2:])
        places = [at for word in (START, INCREMENT) for at, name in enumerate(names) if name.casefold() == word]
        if len(places) == 2 and max(places) < len(second) and all(dialect.is_number(second[at]) for at in places):
            start, interval = (dialect.number(second[at]) for at in places)
            count = min(places)
            headings = _padded(names[:count], second[:count], width, 2)
            return ScopeHeading(headings, start, interval, int(second[0].casefold() == COUNTED))
    cells = re.split(r"[,;\t]", above[-1].strip()) if above else []
    stated = {match["name"].casefold(): float(match["number"]) for match in map(_STATED.fullmatch, cells) if match}
    if stated.keys() < {"t0", "tinc"} or not stated:
        return None
    channels = [match for cell in cells if not _STATED.fullmatch(cell) and (match := _CHANNEL.fullmatch(cell))]
    headings = _padded([match["name"] for match in channels], [match["unit"] or "" for match in channels], width, 1)
    return ScopeHeading(headings, stated["t0"], stated["tinc"])


def _padded(names: Sequence[str], units: Sequence[str], width: int, lines: int) -> Headings:
    """Headings of as many columns as there are, those without a name at the end being empty."""
    rest = [""] * width
    note = "names, start and interval from the heading of an oscilloscope"
    return Headings(tuple([*names, *rest][:width]), tuple([*units, *rest][:width]), lines, (note,))


SNIFFED_LINES = 400
"""Number of lines at the beginning from which the format of a text file is detected."""
STAMP_UNIT = "s"
"""Unit in which columns of time stamps are read."""
READ_ONLY_ENDING = ".lvm"
"""Ending of LabVIEW's measurement files, which are read but not written."""


@contextlib.contextmanager
def open_source(path: Path, separator: str | None = None, decimal: str | None = None) -> Iterator[Source]:
    """Yield the channels of a text file of columns.

    ``separator`` and ``decimal`` are detected where they are not given.
    """
    encoding = detect_encoding(path)
    with path.open(encoding=encoding, newline=None) as file:
        lines = list(islice(file, SNIFFED_LINES))
        if is_labview(lines):
            yield labview_source(file, path.name, path.stem, lines, separator, decimal)
            return
        comments = [line for line in lines if line.startswith(("#", "%"))]
        skipped = next((at for at, line in enumerate(lines) if not line.startswith(("#", "%")) and line.strip()), 0)
        body = lines[skipped:]
        dialect = detect_dialect(
            body if len(body) < SNIFFED_LINES - skipped else body[:-1], separator, decimal, stamps=True
        )
        first = data_start(dialect, body)
        if first == len(body):
            raise ModelError([_no_data(path, lines)], path.name)
        row = dialect.cells(body[first])
        stamped = stamp_columns(row)
        above = body[: first - next((at for at in range(first) if any(dialect.cells(body[first - 1 - at]))), first)]
        scope = scope_heading(dialect, above, len(row))
        heading = scope.headings if scope else _headings(dialect, above, len(row), stamped)
        file.seek(0)
        for _ in range(skipped + first):
            file.readline()
        described = description_in(comments, KEY)
        places = _cell_places(path.name, skipped + len(above), above[-1], dialect, len(row)) if heading.lines else []
        source = _source(
            path, file, dialect, heading, (skipped + first, places), lines, stamped, own=described is not None
        )
        notes = _notes(dialect, encoding, len(above) - heading.lines, heading)
        if scope:
            source = _with_stated_clock(source, scope)
        stamps = {columns[0] for columns in stamped}
        yield (
            with_description(source, described) if described is not None else _with_notes(source, notes, scope, stamps)
        )


def _cell_places(file: str, number: int, line: str, dialect: Dialect, width: int) -> list[Position]:
    """Positions of the headings of ``width`` columns in a line; a column without one has the beginning of the line."""
    whole = Position(file, number, 1, 1, line.rstrip()[:200])
    places, end = [], 0
    for cell in dialect.cells(line)[:width]:
        start = whole.source.find(cell, end)
        end = max(end, start + len(cell) if start >= 0 else 0)
        places.append(whole if start < 0 else replace(whole, column=start + 1, end_column=start + 1 + len(cell)))
    return places + [whole] * (width - len(places))


def _with_stated_clock(source: Source, scope: ScopeHeading) -> Source:
    """Source of an oscilloscope's file without its counts of samples, with the clock of its heading."""
    if not scope.interval > 0:
        raise ValueError(f"the heading says {scope.interval:g} s between samples; the time between two is positive")
    channels = tuple(channel for channel in source.channels[scope.skipped :] if channel.name)
    return replace(source, channels=channels, rate=1 / scope.interval, start=scope.start)


def _with_notes(source: Source, notes: tuple[str, ...], scope: ScopeHeading | None, stamps: set[int]) -> Source:
    """Source with the clocks of its columns; those of time stamps that hold for none, being equal, are left out."""
    clocked = source if scope else with_table_clocks(source.with_time_channel(), stamps)
    source.discovered[:0] = notes
    equal = [channel for channel in clocked.channels if channel.column in stamps]
    kept = tuple(channel for channel in clocked.channels if channel not in equal)
    return replace(clocked, channels=kept, notes=(*clocked.notes, *(_left_out(channel.name) for channel in equal)))


def _headings(dialect: Dialect, above: Sequence[str], width: int, stamped: Sequence[tuple[int, ...]]) -> Headings:
    """Headings of columns, where one heading may stand over a date and a time in two columns."""
    whole = headings(dialect, above, width)
    pair = next((columns for columns in stamped if len(columns) > 1), None)
    shorter = headings(dialect, above, width - 1) if pair and not whole.lines else whole
    if pair is None or shorter.lines == whole.lines:
        return whole
    names, units = ([*parts[: pair[1]], "", *parts[pair[1] :]] for parts in (shorter.names, shorter.units))
    return replace(shorter, names=tuple(names), units=tuple(units))


def _notes(dialect: Dialect, encoding: str, preamble: int, heading: Headings) -> tuple[str, ...]:
    notes = [f"assumed: {dialect}", *heading.notes]
    if preamble > 0:
        notes.append(f"{preamble} line{'s' if preamble > 1 else ''} above the heading passed over")
    if encoding != "utf-8-sig":
        notes.append(f"characters read as {encoding}")
    return tuple(notes)


def _no_data(path: Path, lines: Sequence[str]) -> Fault:
    if not any(line.strip() for line in lines):
        return Fault("the file is empty", position=Position(path.name, 1, 1, 1), kind="wrong-file")
    given = f"{remedy('separator=')} and {remedy('decimal=')}"
    text = f"found no rows of numbers in the first {len(lines)} lines; {given} may be given"
    return Fault(text, position=Position(path.name, 1, 1, 1, lines[0].rstrip()[:200]), kind="wrong-file")


def _source(
    path: Path,
    file: io.TextIOWrapper,
    dialect: Dialect,
    heading: Headings,
    begin: tuple[int, Sequence[Position]],
    lines: Sequence[str],
    stamped: Sequence[tuple[int, ...]],
    *,
    own: bool,
) -> Source:
    discovered: list[NoteOrText] = []
    empty_cells = EmptyCells(discovered)
    width, start = len(heading.names), file.tell()
    first, places = begin
    channels = [
        FileChannel(name, column, unit, position=place)
        for column, (name, unit, place) in enumerate(zip_longest(heading.names, heading.units, places))
    ]
    if len(channels) > 1 and all(not dialect.cells(line)[-1] for line in lines[first:] if line.strip()):
        channels.pop()  # every row ends with a separator
    channels, clocks, notes = _with_clocks(channels, stamped)
    every = {column for columns in stamped for column in columns}
    known = {channel.column: channel for channel in channels}
    late = _later(dialect, lines[first:], clocks)
    no_number = partial(_no_number, names=heading.names)

    def blocks(columns: Sequence[int], count: int) -> Iterator[list[FloatArray]]:
        file.seek(start)
        clock = next((clock for clock in clocks if clock[0] in columns), clocks[0] if clocks else ())
        unread = frozenset(every - {*clock})
        rows = NumberRows(
            file, path.name, dialect, width, first + 1, heading.names, own, no_number=no_number, unread=unread,
            stamped=clock,
        )  # fmt: skip
        for read in rows.blocks(columns, count):
            # Each column of stamps counts from its own first one.
            block = [values + late[clock] if at in clock else values for at, values in zip(columns, read, strict=True)]
            if not count:
                check_lengths(rows, [known[column] for column in columns], path.name)
            empty_cells.count(rows, columns)
            if clocks and clock == clocks[0] and rows.stamps.first and not rows.faults:
                zero_note = f"time counts from the first stamp, {rows.stamps.first}"
                discovered[:] = [*(note for note in discovered if note != zero_note), zero_note]
            yield block

    return Source(
        tuple(channels),
        blocks,
        title=path.stem,
        notes=notes,
        discovered=discovered,
        place=lambda row: Position(path.name, first + 1 + row, 1, 1),
    )


def _no_number(cell: str, names: Sequence[str]) -> str:
    again = "is the heading again, of another record or segment: save each in a file of its own"
    return f'"{cell}" {again if cell in names else "is not a number"}'


def _with_clocks(
    channels: Sequence[FileChannel], stamped: Sequence[tuple[int, ...]]
) -> tuple[list[FileChannel], list[tuple[int, ...]], tuple[str, ...]]:
    """Channels of a text file with its columns of time stamps, unless a column of numbers holds the time.

    Also returned: the columns of these stamps, the first of each run of them, and notes on others, which are left out.
    """
    every = {column for columns in stamped for column in columns}
    numbers = [channel for channel in channels if channel.column not in every]
    is_needed = not any(is_time(channel) for channel in numbers)
    clocks = [columns for columns in stamped if is_needed and columns[0] - 1 not in every]
    clocks = [columns for columns in clocks if columns == clocks[0] or numbers[-1].column > columns[0]]
    by_column = {channel.column: channel for channel in channels}
    named = {columns: " ".join(filter(None, (by_column[at].name for at in columns))) for columns in stamped}
    notes = tuple(_left_out(name) for columns, name in named.items() if columns not in clocks)
    times = [replace(by_column[columns[0]], name=named[columns], unit=STAMP_UNIT) for columns in clocks]
    return sorted([*numbers, *times], key=lambda channel: channel.column), clocks, notes


def _left_out(name: str) -> str:
    return f'"{name}" holds dates and times of day, and was left out'


def _later(dialect: Dialect, lines: Sequence[str], clocks: Sequence[tuple[int, ...]]) -> dict[tuple[int, ...], float]:
    """Time in s by which the first stamp in columns of time stamps is later than that in the first of them."""
    rows = [dialect.cells(line) for line in lines if line.strip()] if len(clocks) > 1 else []
    texts = [
        next((text for row in rows if (text := " ".join(row[at] for at in clock if at < len(row)).strip())), "")
        for clock in clocks
    ]
    seconds, wrong = StampReader().seconds(texts)
    if wrong and rows:
        raise ValueError(f"columns of time stamps are not written alike: {wrong[0][1]}")
    return {clock: float(late) if rows else 0.0 for clock, late in zip(clocks, seconds, strict=True)}


def write(recording: Recording, path: Path) -> None:
    """Write a CSV file of a recording in SI, with a description, headings with units, a column of time, all digits."""
    if path.suffix.lower() == READ_ONLY_ENDING:
        words = f"{READ_ONLY_ENDING} files of LabVIEW are read only; write .tdms, which LabVIEW reads, or .csv"
        raise UsageError(f'"{path.name}": {words}', kind="wrong-file")
    check_names(recording)
    keys = plain_keys(recording.names, r"[^\w .:+-]| in ")
    units = [f"{key} [{signal.unit}]" if signal.unit else key for key, signal in zip(keys, recording, strict=True)]
    columns = [recording.time, *(signal.values for signal in recording)]
    write_columns(path, KEY, recording_json(recording, keys, with_time=True), [f"{TIME} [s]", *units], columns)
