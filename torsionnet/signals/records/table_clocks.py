"""Several columns of times in one table: each holds the time stamps of the columns behind it, up to the next."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from torsionnet.base.errors import ModelError
from torsionnet.base.notes import warning
from torsionnet.signals.foreign.content import Blocks
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.records.axes import seconds_in
from torsionnet.signals.records.source import TIME_NAMES, FileChannel, Source, is_time, time_note

_TIME = rf"(?:t|(?i:{'|'.join(map(re.escape, sorted(TIME_NAMES)))}))"
_NUMBERED = re.compile(rf"{_TIME}[\s_.:-]*(?:\d+\s+-\s.*|\d*)")
"""Pattern of the name of a column of times, which may have a number, and words behind it; T is a torque."""
_WITHIN = re.compile(rf"(.*[\s_.:-]){_TIME}[\s_.:-]+(.+)")
"""Pattern of the name of times that have the name of their channel around them, as ``Data1_time_T``."""


def with_table_clocks(source: Source, stamped: Collection[int] = ()) -> Source:
    """Source of a table whose columns have the time stamps to the left of them, where there are several of these.

    Times of other things (pulses, durations) are columns like others: their name is none of a time, or they do not
    rise, or equal the first stamps. Columns ``stamped`` held dates and times, whatever their name.
    """
    ordered = sorted((*source.channels, *([source.time] if source.time else [])), key=lambda one: one.column)
    named = [
        one
        for one, behind in pairwise(ordered)
        if _is_clock(one, behind) or (one.column in stamped and not is_time(behind))
    ]
    if len(named) < 2 or source.time not in (None, named[0]):
        return source
    stamps = _read(source, named)
    first = stamps.get(named[0].column, np.empty(0))
    clocks = [one for one in named[1:] if one.column in stamps and not _same(stamps[one.column], first)]
    if not clocks or not len(first):
        return source
    clocks = [named[0], *clocks]
    lengths = dict[int, int]()
    channels, clock = list[FileChannel](), clocks[0]
    for channel in ordered:
        clock = channel if channel in clocks else clock
        lengths[channel.column] = len(stamps[clock.column])
        if channel not in clocks:
            length = len(stamps[clock.column])
            channels.append(replace(channel, clock=replace(clock, length=length), length=length))
    names = ", ".join(f'"{one.name}"' for one in clocks)
    notes = [note for note in source.notes if note != time_note(clocks[0])]
    said = f"{names} were taken for the time stamps of the columns behind each"
    return replace(
        source, channels=tuple(channels), time=None, blocks=_cut(source.blocks, lengths), notes=(*notes, said)
    )


def with_named_clocks(source: Source) -> Source:
    """Source of arrays without order, of which times may be named after a channel, as ``t_T`` with ``T``."""
    alone = [one for one in source.channels if not one.clock and not one.rate]
    times = [*alone, *([source.time] if source.time else [])]
    clocks = {one.name: time for one in alone for time in times if time is not one and _is_time_of(time, one)}
    if clocks:
        stamps = {time.column for time in clocks.values()}
        rest = [one for one in source.channels if one.column not in stamps]
        of_all = None if source.time in clocks.values() else source.time
        paired = [replace(one, clock=clocks.get(one.name, one.clock or of_all)) for one in rest]
        return replace(source, channels=tuple(paired), time=None)
    return with_doubts(source)


def with_doubts(source: Source) -> Source:
    """Source with a warning where it has other times than those taken for all channels, and nothing tells of what."""
    if source.time is None:
        return source
    alone = [one for one in source.channels if not one.clock and not one.rate]
    doubted = [one for one in alone if (not one.unit or is_time(one)) and _NUMBERED.fullmatch(one.name)]
    stamps_of = _read(source, [source.time, *doubted]) if doubted else {}
    first = stamps_of.get(source.time.column, np.empty(0))
    others = [one.name for one in doubted if one.column in stamps_of and not _same(stamps_of[one.column], first)]
    text = warning(f"{', '.join(others)} holds other times than {source.time.name}, which was taken for all channels")
    return replace(source, notes=(*source.notes, *([text] if others else [])))


def _is_clock(channel: FileChannel, behind: FileChannel) -> bool:
    """Whether a column is named as time stamps are, alone, with a number, or with the name of the column behind it."""
    if (channel.unit and not is_time(channel)) or is_time(behind):
        return False
    return bool(_NUMBERED.fullmatch(channel.name.strip())) or _is_time_of(channel, behind)


def _is_time_of(time: FileChannel, channel: FileChannel) -> bool:
    """Whether times are named after a channel, as ``t_T``, ``time w``, ``w.time`` or ``Data1_time_T`` are."""
    if time.unit and not is_time(time):
        return False
    within = _WITHIN.fullmatch(time.name)
    if within and f"{within[1]}{within[2]}" == channel.name:
        return True
    own, count = re.subn(rf"[\s_.:-]+{re.escape(channel.name)}|{re.escape(channel.name)}[\s_.:-]+", "", time.name)
    return bool(count == 1 and _NUMBERED.fullmatch(own))


def _read(source: Source, clocks: Sequence[FileChannel]) -> Mapping[int, FloatArray]:
    """Time stamps (n,) in s by column, without empty cells behind them; only those that rise."""
    found = dict[int, FloatArray]()
    for clock in clocks:
        try:
            values = next(source.blocks([clock.column], 0), [np.empty(0)])[0]
        except ModelError:
            continue  # told with all others when the table is read
        filled = np.flatnonzero(np.isfinite(values))
        values = values[: filled[-1] + 1] if len(filled) else values[:0]
        if len(values) > 1 and np.all(np.diff(values) > 0):
            found[clock.column] = values * seconds_in(clock.unit)
    return found


def _same(stamps: FloatArray, first: FloatArray) -> bool:
    return len(stamps) == len(first) and bool(np.allclose(stamps, first, rtol=1e-12, atol=1e-9))


def _cut(blocks: Blocks, lengths: Mapping[int, int]) -> Blocks:
    """Reader of blocks of columns without the empty cells behind the last time stamp of each."""

    def cut(columns: Sequence[int], count: int) -> Iterator[list[FloatArray]]:
        left = min(lengths[column] for column in columns)
        for block in blocks(columns, count):
            yield [values[:left] for values in block]
            left -= len(block[0])
            if left <= 0:
                return

    return cut
