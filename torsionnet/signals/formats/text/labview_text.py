"""Reading of recordings in LabVIEW's measurement files (.lvm) and in text exports with the same header."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np

from torsionnet.base.delimited.dialect import Dialect
from torsionnet.base.delimited.number_rows import NumberRows
from torsionnet.base.errors import Fault, ModelError, Position
from torsionnet.base.notes import NoteOrText
from torsionnet.signals.formats.text.labview_header import (
    COMMENT,
    X_VALUE,
    HeadedLines,
    Segment,
    dialect_of,
    next_segment,
)
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.records.source import FileChannel, Source, StatedInterval

# Checks of the lengths of channels in a text file, and notes on empty cells.


def check_lengths(rows: NumberRows, channels: Sequence[FileChannel], file: str) -> None:
    """Refuse rows of a text file of which the last are empty in some of the channels, after all were read."""
    lengths = {channel.name: int(rows.filled[channel.column]) for channel in channels}
    if len(set(lengths.values())) > 1:
        sizes = ", ".join(f"{name} has {length}" for name, length in lengths.items())
        raise ModelError([Fault(f"channels of different lengths: {sizes} values", kind="unlike-results")], file)


class EmptyCells:
    """Note on how many cells of a text file were empty so far, among the other notes on the file."""

    def __init__(self, discovered: list[NoteOrText]) -> None:
        self.discovered = discovered
        self.said = ""

    def count(self, rows: NumberRows, columns: Sequence[int]) -> None:
        """Put the number of cells that are empty by now in place of the one before."""
        empty = int(rows.empty[list(columns)].sum())
        if empty:
            kept = [note for note in self.discovered if note != self.said]
            self.said = f"{empty} empty cells are NaN"
            self.discovered[:] = [*kept, self.said]


LARGEST_SEGMENT_GAP = 0.1
"""Share of a sampling interval by which a segment may begin off the end of the one before and still continue it."""
SECONDS_PER_DAY = 86_400.0
"""Number of seconds in a day, after which the time of day in a header begins anew."""


def labview_source(
    file: io.TextIOWrapper, name: str, title: str, lines: Sequence[str], separator: str | None, decimal: str | None
) -> Source:
    """Channels of a LabVIEW file that begins with ``lines``.

    Consecutive segments are one recording, others, and rows beyond Samples, blocks of their own, as after a trigger.
    """
    dialect = dialect_of(lines, name, separator, decimal)
    file.seek(0)
    head = HeadedLines(iter(file))
    first = next_segment(head, name, dialect, is_first=True)
    assert first is not None
    body = [row for row, _ in zip(head.data(), range(len(lines)), strict=False)]
    rows = [dialect.cells(line) for line in body if line.strip()]
    has_times = bool(first.times) and any(_filled(cells, first.times[0]) for cells in rows)
    channels = [
        FileChannel(label, column, unit, position=first.heading)
        for label, column, unit in zip(first.names, first.columns, first.units, strict=True)
    ]
    time = FileChannel(X_VALUE, first.times[0], "s", position=first.heading) if has_times else None
    notes = [f"LabVIEW header: {dialect}"]
    if first.begun:
        notes.append(f"begins at {first.begun}, as the header says")
    if any(first.labels[at] == COMMENT and _filled(cells, at) for cells in rows for at in range(first.width)):
        notes.append("the column of comments was passed over")
    discovered: list[NoteOrText] = []
    reader = _Reader(file, name, dialect, [*channels, *([time] if time else [])], has_times, discovered)
    stated = None
    if time and first.interval and first.interval_place:
        stated = StatedInterval("Delta_X", first.interval, first.interval_place)
    rate = 1 / first.interval if first.interval and not has_times else None
    return Source(
        tuple(channels), reader.blocks, time=time, rate=rate, start=0.0 if has_times else first.start, title=title,
        notes=tuple(notes), discovered=discovered, place=reader.place,
        stated=stated, seams=reader.seams,
    )  # fmt: skip


def _filled(cells: Sequence[str], at: int) -> bool:
    return at < len(cells) and bool(cells[at])


class _Reader:
    """Reader of the rows of all segments of a LabVIEW file, in which it finds the blocks that do not follow each other.

    ``seams`` are the first sample and the start in s of each such block but the first.
    """

    def __init__(
        self,
        file: io.TextIOWrapper,
        name: str,
        dialect: Dialect,
        channels: Sequence[FileChannel],
        has_times: bool,
        discovered: list[NoteOrText],
    ) -> None:
        self.file, self.name, self.dialect, self.has_times = file, name, dialect, has_times
        self.channels = {channel.column: channel for channel in channels}
        self.discovered = discovered
        self.empty_cells = EmptyCells(discovered)
        self.begun: list[tuple[int, int]] = []
        self.seams: list[tuple[int, float]] = []

    def place(self, row: int) -> Position | None:
        """Position in the file of a sample in the segments read so far; blank lines between rows are not counted."""
        known = [(first, line) for first, line in self.begun if first <= row]
        return Position(self.name, known[-1][1] + row - known[-1][0], 1, 1) if known else None

    def blocks(self, columns: Sequence[int], count: int) -> Iterator[list[FloatArray]]:
        """Yield blocks of ``count`` samples across segments that follow each other, or all of these where it is 0."""
        kept: list[list[FloatArray]] = []
        held = 0
        for piece, is_apart in self._blocks_of_rows(columns, count):
            if is_apart and held:
                yield _joined(kept)
                kept, held = [], 0
            kept.append(piece)
            held += len(piece[0])
            while count and held >= count:
                joined = _joined(kept)
                yield [values[:count] for values in joined]
                kept, held = [[values[count:] for values in joined]], held - count
        if held:
            yield _joined(kept)

    def _blocks_of_rows(self, columns: Sequence[int], count: int) -> Iterator[tuple[list[FloatArray], bool]]:
        """Yield pieces of rows, each with a flag whether it does not follow the one before."""
        self.file.seek(0)
        lines = HeadedLines(iter(self.file))
        self.begun.clear()
        self.seams.clear()
        head, first, begin, done, number, end = None, None, 0, 0, 0, float("nan")
        while segment := next_segment(lines, self.name, self.dialect, is_first=head is None):
            number += 1
            if head is not None:
                self._check_alike(head, segment, number)
            head, first, within = head or segment, first or segment, 0
            self.begun.append((done, lines.number + 1))
            rows = self._rows(lines, segment)
            asked = [*columns, *(segment.times if self.has_times else ())]
            for block in rows.blocks(asked, count):
                if not count:
                    check_lengths(rows, [self.channels[column] for column in columns], self.name)
                self.empty_cells.count(rows, columns)
                self._check_times(block[len(columns) :], segment)
                for piece in _parts(block, within, self._samples(segment)):
                    is_apart = done > 0 and self._is_apart(first, segment, (done - begin, within), piece, end)
                    if is_apart:
                        self.seams.append((done, segment.start))
                        first, begin = segment, done
                    yield piece[: len(columns)], is_apart
                    done, within = done + len(piece[0]), within + len(piece[0])
                    end = float(piece[-1][-1]) if self.has_times else end
            self._check_count(segment, rows.read, max(lines.number, 1))
        self._tell(number)

    def _samples(self, segment: Segment) -> int:
        """Rows of one block of a segment, 0 where Samples tells none, as where each sample was written by itself."""
        return segment.samples if segment.samples and segment.samples > 1 else 0

    def _is_apart(
        self, first: Segment, segment: Segment, rows: tuple[int, int], piece: Sequence[FloatArray], end: float
    ) -> bool:
        """Whether a piece does not follow the rows before it, since the last seam and within its segment.

        ``end`` is the last time before it in s.
        """
        before, within = rows
        samples = self._samples(segment)
        if within and (not samples or within % samples):
            return False
        if self.has_times:
            times = piece[-1]
            interval = segment.interval or (float(times[1] - times[0]) if len(times) > 1 else 0.0)
            return bool(abs(float(times[0]) - end - interval) > LARGEST_SEGMENT_GAP * interval)
        return within > 0 or not _follows(first, segment, before)

    def _check_count(self, segment: Segment, read: int, line: int) -> None:
        """Refuse a segment whose last block has fewer rows than Samples says."""
        samples = self._samples(segment)
        missing = read < samples if self.has_times else samples and (read % samples or not read)
        if missing:
            text = f"the file ends early: Samples says {samples} rows, there are {read % samples}"
            which = f" in block {read // samples + 1}" if read > samples else ""
            raise ModelError(
                [Fault(f"{text}{which}", position=Position(self.name, line, 1, 2), kind="truncated-file")], self.name
            )

    def _tell(self, segments: int) -> None:
        if self.seams:
            self.discovered.append(f"{len(self.seams) + 1} blocks that do not follow each other, as after a trigger")
        elif segments > 1:
            self.discovered.append(f"{segments} segments that follow each other were joined")

    def _rows(self, lines: HeadedLines, segment: Segment) -> NumberRows:
        used = {*segment.columns, *(segment.times if self.has_times else ())}
        unread = frozenset(range(segment.width)) - used
        says: Callable[[str], str] = partial(_no_number, sign=self.dialect.decimal)
        return NumberRows(
            lines.data(), self.name, self.dialect, segment.width, lines.number + 1, segment.labels,
            no_number=says, unread=unread,
        )  # fmt: skip

    def _check_times(self, times: Sequence[FloatArray], segment: Segment) -> None:
        for number, other in enumerate(times[1:], 1):
            if not np.array_equal(times[0], other, equal_nan=True):
                text = f"{segment.names[number]} has other times than {segment.names[0]}: X_Value differs"
                place = segment.heading
                raise ModelError(
                    [Fault(f"{text}; save them in files of their own", position=place, kind="unlike-results")],
                    self.name,
                )

    def _check_alike(self, head: Segment, segment: Segment, number: int) -> None:
        if (segment.names, segment.units, segment.columns, segment.interval) != (
            head.names, head.units, head.columns, head.interval,
        ):  # fmt: skip
            text = f"segment {number} has other channels, units or Delta_X than segment 1 in line {head.line}"
            raise ModelError(
                [Fault(f"{text}; save them in files of their own", position=segment.heading, kind="unlike-results")],
                self.name,
            )


def _follows(first: Segment, segment: Segment, done: int) -> bool:
    """Whether a segment begins where ``done`` samples end, by X0 or, with equal X0, by the time of day."""
    if first.interval is None:
        return True
    span, near = done * first.interval, LARGEST_SEGMENT_GAP * first.interval
    if abs(segment.start - first.start - span) <= near:
        return True
    if segment.start != first.start or first.clock is None or segment.clock is None:
        return False
    passed = segment.clock - first.clock
    return abs((passed - span + SECONDS_PER_DAY / 2) % SECONDS_PER_DAY - SECONDS_PER_DAY / 2) <= near


def _parts(block: Sequence[FloatArray], within: int, samples: int) -> Iterator[list[FloatArray]]:
    """Yield the parts of a block, ``within`` rows of its segment before it, that Samples rows make."""
    count, at = len(block[0]), 0
    while at < count:
        end = min(count, at + samples - (within + at) % samples) if samples else count
        yield [values[at:end] for values in block]
        at = end


def _joined(pieces: Sequence[Sequence[FloatArray]]) -> list[FloatArray]:
    return [np.concatenate(parts) for parts in zip(*pieces, strict=True)]


def _no_number(cell: str, sign: str) -> str:
    other = "," if sign == "." else "."
    hint = f'; Decimal_Separator is "{sign}"' if cell.count(other) == 1 else ""
    return f'"{cell}" is not a number{hint}'
