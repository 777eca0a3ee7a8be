"""Reading of recordings in LabVIEW's measurement files (.lvm) and in text exports with the same header."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np

from torsionnet.core.delimited.dialect import Dialect
from torsionnet.core.delimited.number_rows import NumberRows
from torsionnet.core.errors import Fault, ModelError, Position
from torsionnet.io.formats.text.channel_lengths import check_lengths, count_empty
from torsionnet.io.formats.text.labview_header import Segment, next_segment
from torsionnet.io.formats.text.labview_lines import COMMENT, X_VALUE, HeadedLines, dialect_of
from torsionnet.io.records.source import FileChannel, Source, StatedInterval
from torsionnet.response.recording import FloatArray

LARGEST_SEGMENT_GAP = 0.1
"""Share of a sampling interval by which a segment may begin off the end of the one before and still continue it."""
SECONDS_PER_DAY = 86_400.0
"""Number of seconds in a day, after which the time of day in a header begins anew."""


def labview_source(
    file: io.TextIOWrapper, name: str, title: str, lines: Sequence[str], separator: str | None, decimal: str | None
) -> Source:
    """Channels of a LabVIEW file that begins with ``lines``, whose consecutive segments are one recording."""
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
    discovered: list[str] = []
    reader = _Reader(file, name, dialect, [*channels, *([time] if time else [])], has_times, discovered)
    stated = None
    if time and first.interval and first.interval_place:
        stated = StatedInterval("Delta_X", first.interval, first.interval_place)
    rate = 1 / first.interval if first.interval and not has_times else None
    return Source(
        tuple(channels), reader.blocks, time=time, rate=rate, start=0.0 if has_times else first.start, title=title,
        notes=tuple(notes), discovered=discovered, place=reader.place,
        stated=stated,
    )  # fmt: skip


def _filled(cells: Sequence[str], at: int) -> bool:
    return at < len(cells) and bool(cells[at])


class _Reader:
    """Reader of the rows of all segments of a LabVIEW file, which refuses one that does not continue the one before."""

    def __init__(
        self,
        file: io.TextIOWrapper,
        name: str,
        dialect: Dialect,
        channels: Sequence[FileChannel],
        has_times: bool,
        discovered: list[str],
    ) -> None:
        self.file, self.name, self.dialect, self.has_times = file, name, dialect, has_times
        self.channels = {channel.column: channel for channel in channels}
        self.discovered = discovered
        self.begun: list[tuple[int, int]] = []

    def place(self, row: int) -> Position | None:
        """Position in the file of a sample in the segments read so far; blank lines between rows are not counted."""
        known = [(first, line) for first, line in self.begun if first <= row]
        return Position(self.name, known[-1][1] + row - known[-1][0], 1, 1) if known else None

    def blocks(self, columns: Sequence[int], count: int) -> Iterator[list[FloatArray]]:
        """Yield blocks of ``count`` samples across segments, or all samples where ``count`` is 0."""
        kept: list[list[FloatArray]] = []
        held = 0
        for piece in self._pieces(columns, count):
            kept.append(piece)
            held += len(piece[0])
            while count and held >= count:
                joined = _joined(kept)
                yield [values[:count] for values in joined]
                kept, held = [[values[count:] for values in joined]], held - count
        if held:
            yield _joined(kept)

    def _pieces(self, columns: Sequence[int], count: int) -> Iterator[list[FloatArray]]:
        self.file.seek(0)
        lines = HeadedLines(iter(self.file))
        self.begun.clear()
        first, done, number = None, 0, 0
        while segment := next_segment(lines, self.name, self.dialect, is_first=first is None):
            number += 1
            if first is not None:
                self._check_next(first, segment, done, number)
            first = first or segment
            self.begun.append((done, lines.number + 1))
            rows = self._rows(lines, segment)
            asked = [*columns, *(segment.times if self.has_times else ())]
            for block in rows.blocks(asked, count):
                if not count:
                    check_lengths(rows, [self.channels[column] for column in columns], self.name)
                count_empty(rows, columns, self.discovered)
                self._check_times(block[len(columns) :], segment)
                yield block[: len(columns)]
            if segment.samples is not None and rows.read < segment.samples:
                text = f"the file ends early: Samples says {segment.samples} rows, there are {rows.read}"
                raise ModelError([Fault(text, position=Position(self.name, max(lines.number, 1), 1, 2))], self.name)
            done += rows.read
        if number > 1:
            self.discovered[:] = [*self.discovered, f"{number} segments that follow each other were joined"]

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
                raise ModelError([Fault(f"{text}; save them in files of their own", position=place)], self.name)

    def _check_next(self, first: Segment, segment: Segment, done: int, number: int) -> None:
        if (segment.names, segment.units, segment.columns, segment.interval) != (
            first.names, first.units, first.columns, first.interval,
        ):  # fmt: skip
            text = f"segment {number} has other channels, units or Delta_X than segment 1 in line {first.line}"
        elif self.has_times or _follows(first, segment, done):
            return
        else:
            assert first.interval is not None
            end = first.start + done * first.interval
            text = (
                f"segment {number} begins at X0 = {segment.start:g} s, "
                f"the segments before it, from line {first.line} on, end at {end:g} s"
            )
        raise ModelError([Fault(f"{text}; save them in files of their own", position=segment.heading)], self.name)


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


def _joined(pieces: Sequence[Sequence[FloatArray]]) -> list[FloatArray]:
    return [np.concatenate(parts) for parts in zip(*pieces, strict=True)]


def _no_number(cell: str, sign: str) -> str:
    other = "," if sign == "." else "."
    hint = f'; Decimal_Separator is "{sign}"' if cell.count(other) == 1 else ""
    return f'"{cell}" is not a number{hint}'
