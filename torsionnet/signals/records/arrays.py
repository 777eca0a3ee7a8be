"""Channels and sampling rate of files that hold named arrays (NPZ, MAT, HDF5)."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from torsionnet.base.errors import ModelError, comma_list
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.base.plain_names import free_name
from torsionnet.signals.foreign import StoredArray
from torsionnet.signals.foreign.content import (
    COMPLEX,
    FACTOR_NAMES,
    INTERVAL_NAMES,
    MISSING,
    OFFSET_NAMES,
    RATE_NAMES,
    START_NAMES,
    UNIT_NAMES,
    WAVE_INTERVAL,
    WAVE_NAME,
    WAVE_OFFSET,
    WAVE_START,
    WAVE_UNIT,
    Blocks,
    Plain,
)
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.records.source import (
    NOWHERE,
    TIME_NAMES,
    FileChannel,
    Source,
    clock_entry,
    is_time,
    nearest,
    other_axis,
    seconds_in,
    structure_of,
    time_note,
    with_description,
)

# Several columns of times in one table: each holds the time stamps of the columns behind it, up to the next.

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
    ordered = sorted((*source.channels, *([source.time] if source.time else [])), key=lambda channel: channel.column)
    named = [
        channel
        for channel, behind in pairwise(ordered)
        if _is_clock(channel, behind) or (channel.column in stamped and not is_time(behind))
    ]
    if len(named) < 2 or source.time not in (None, named[0]):
        return source
    stamps = _time_columns(source, named)
    first = stamps.get(named[0].column, np.empty(0))
    clocks = [clock for clock in named[1:] if clock.column in stamps and not _same(stamps[clock.column], first)]
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
    names = ", ".join(f'"{clock.name}"' for clock in clocks)
    notes = [note for note in source.notes if note != time_note(clocks[0])]
    said = f"{names} were taken for the time stamps of the columns behind each"
    return replace(
        source, channels=tuple(channels), time=None, blocks=_cut(source.blocks, lengths), notes=(*notes, said)
    )


def with_named_clocks(source: Source) -> Source:
    """Source of arrays without order, of which times may be named after a channel, as ``t_T`` with ``T``."""
    alone = [channel for channel in source.channels if not channel.clock and not channel.rate]
    times = [*alone, *([source.time] if source.time else [])]
    clocks = {
        channel.name: time for channel in alone for time in times if time is not channel and _is_time_of(time, channel)
    }
    if clocks:
        stamps = {time.column for time in clocks.values()}
        rest = [channel for channel in source.channels if channel.column not in stamps]
        of_all = None if source.time in clocks.values() else source.time
        paired = [replace(channel, clock=clocks.get(channel.name, channel.clock or of_all)) for channel in rest]
        return replace(source, channels=tuple(paired), time=None)
    return with_doubts(source)


def with_doubts(source: Source) -> Source:
    """Source with a warning where it has other times than those taken for all channels, and nothing tells of what."""
    if source.time is None:
        return source
    alone = [channel for channel in source.channels if not channel.clock and not channel.rate]
    doubted = [
        channel for channel in alone if (not channel.unit or is_time(channel)) and _NUMBERED.fullmatch(channel.name)
    ]
    stamps_of = _time_columns(source, [source.time, *doubted]) if doubted else {}
    first = stamps_of.get(source.time.column, np.empty(0))
    others = [
        channel.name
        for channel in doubted
        if channel.column in stamps_of and not _same(stamps_of[channel.column], first)
    ]
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


def _time_columns(source: Source, clocks: Sequence[FileChannel]) -> Mapping[int, FloatArray]:
    """Time stamps (n,) in s by column, without empty cells behind them; only those that rise."""
    stamps = dict[int, FloatArray]()
    for clock in clocks:
        try:
            values = next(source.blocks([clock.column], 0), [np.empty(0)])[0]
        except ModelError:
            continue  # told with all others when the table is read
        filled = np.flatnonzero(np.isfinite(values))
        values = values[: filled[-1] + 1] if len(filled) else values[:0]
        if len(values) > 1 and np.all(np.diff(values) > 0):
            stamps[clock.column] = values * seconds_in(clock.unit)
    return stamps


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


MOST_LEFT_OUT = 5
"""Number of things left out that a note names at most, so that it stays short."""
MOST_COLUMNS = 256
"""Most columns of an array that are taken for channels, as more make a picture, or a matrix of something else."""


def array_source(
    arrays: Sequence[StoredArray],
    blocks: Blocks,
    stored: str,
    title: str,
    attributes: Mapping[str, Plain] | None = None,
) -> Source:
    """Channels, sampling rate in Hz and start in s of a recording from named arrays.

    Numbers named ``fs``, ``dt``, ``Tstart`` or the like tell the clock, of a structure that of its fields; other
    single numbers are left out. ``attributes`` are those of the file, which may tell it, too. ``blocks`` knows the
    arrays by their place in ``arrays``.

    Raises
    ------
    ValueError
        Such a number is no rate or interval, or two of them contradict each other.
    """
    channels, places, notes, clocks = list[FileChannel](), list[tuple[int, int]](), list[str](), dict[str, _Numbers]()
    of_file = {} if stored else _clock_numbers(StoredArray("", (), attributes or {}))
    if of_file:
        clocks[""] = of_file
    for number, item in enumerate(arrays):
        if len(item.shape) > 2 or item.attributes.get(COMPLEX):
            kind = " by ".join(map(str, item.shape)) if len(item.shape) > 2 else "complex"
            notes.append(f"{item.name} was left out: {kind} numbers are no channels")
            continue
        rows, columns = (*item.shape, 1, 1)[:2]
        if rows == columns == 1 and not stored:
            kind = clock_entry(item.name)
            if kind:
                clocks.setdefault(structure_of(item.name), {})[kind] = (item.name, float(item.value or 0.0))
            notes.append(f"{item.name} {_TAKEN[kind]}")
        elif columns > MOST_COLUMNS:
            notes.append(f"{item.name} was left out: {rows} by {columns} numbers are no channels")
        else:
            for column in range(columns):
                name = item.name if columns == 1 else f"{item.name}_{column + 1}"
                channels.append(channel_of(item, len(channels), name, attribute_text(item, *UNIT_NAMES)))
                places.append((number, column))
    by_structure = {structure: _rate_and_start(numbers) for structure, numbers in clocks.items()}
    rate, start = next(iter(by_structure.values())) if len(by_structure) == 1 else (None, 0.0)
    if len(by_structure) > 1:
        channels = [_clocked(channel, nearest(channel.name, by_structure)) for channel in channels]
    source = Source(
        _with_scales(channels, arrays, places), by_column(blocks, places), rate=rate, start=start, title=title,
        notes=tuple(notes),
    )  # fmt: skip
    described = with_description(source, stored)
    return described if stored else _with_clock_of_file(_of_its_own(with_named_clocks(described)))


def with_left_out(source: Source, names: Sequence[str]) -> Source:
    """Source with a note on what else is in the file, and is no column of numbers."""
    if not names:
        return source
    text = f"left out, as no column of numbers: {comma_list(list(names), MOST_LEFT_OUT)}"
    return replace(source, notes=(*source.notes, text), hint="; ".join(filter(None, [source.hint, text])))


_Numbers: TypeAlias = dict[str, tuple[str, float]]
_TAKEN = {
    "rate": "was taken for the sampling rate", "interval": "was taken for the sampling interval in s",
    "start": "was taken for the time of the first sample in s", "": "is a single number, no channel",
}  # fmt: skip
SAME_RATE = 1e-6
"""Relative difference up to which a rate and an interval in one file agree."""


def _rate_and_start(numbers: _Numbers) -> tuple[float | None, float]:
    """Sampling rate in Hz and start in s by the numbers of a file or structure that tell them."""
    spaced, interval = numbers.get("interval", ("", 1.0))
    # A rate that nothing has is refused later, unless another one is given.
    of_interval = 1 / interval if interval else np.inf
    rated, rate = numbers.get("rate", ("", of_interval if spaced else None))
    if rate and rated and spaced and abs(rate * interval - 1) > SAME_RATE:
        raise ValueError(f"{rated} says {rate:g} Hz, {spaced} {interval:g} s between samples: {of_interval:g} Hz")
    return rate, numbers.get("start", ("", 0.0))[1]


def _with_clock_of_file(source: Source) -> Source:
    """Source whose channels without a clock have that of the file, where others have a rate or start of their own."""
    own = any(channel.rate or channel.clock or channel.start is not None for channel in source.channels)
    if not own or source.time is not None or not source.rate:
        return source
    clocked = (
        channel
        if channel.rate or channel.clock or channel.over
        else replace(channel, rate=source.rate, start=source.start if channel.start is None else channel.start)
        for channel in source.channels
    )
    return replace(source, channels=tuple(clocked))


def _of_its_own(source: Source) -> Source:
    """Source whose time stamps hold for the structure that they stand in, and for those inside it.

    They hold for all channels where none stands beside them, and never for one over another dimension scale.
    """
    time = source.time
    if time is None:
        return source
    around = structure_of(time.name)
    # A structure of time stamps alone holds the clock of all others.
    if not any(structure_of(channel.name) == around for channel in source.channels):
        around = ""

    def belongs(channel: FileChannel) -> bool:
        inside = not around or f"{channel.name}.".startswith(f"{around}.")
        return inside and channel.shares_axis(time)

    if all(belongs(channel) or channel.over for channel in source.channels):
        return source
    own = (
        replace(channel, clock=time) if belongs(channel) and not (channel.clock or channel.over) else channel
        for channel in source.channels
    )
    notes = tuple(note for note in source.notes if note != time_note(time))
    return replace(source, channels=tuple(own), time=None, notes=notes)


def _clocked(channel: FileChannel, clock: tuple[float | None, float] | None) -> FileChannel:
    return channel if clock is None or channel.rate else replace(channel, rate=clock[0], start=clock[1])


def _with_scales(
    channels: Sequence[FileChannel], arrays: Sequence[StoredArray], places: Sequence[tuple[int, int]]
) -> tuple[FileChannel, ...]:
    """Channels with the dimension scales that their arrays name: time stamps, what is no time, or unknown."""
    named = {channel.name: channel for channel in channels}
    scaled, others = list[FileChannel](), dict[str, str]()
    for channel, (number, _) in zip(channels, places, strict=True):
        axis = attribute_text(arrays[number], "clock")
        scale = named.get(axis) or (FileChannel(axis, NOWHERE) if axis else None)
        over = other_axis(scale.unit, scale.name) if scale else ""
        clock = scale if scale and not over and is_time(scale) else None
        over = over or channel.over
        scaled.append(replace(channel, clock=clock, over=over, scale=None if clock or over else scale))
        others |= {scale.name: over} if scale and over else {}
    return tuple(replace(channel, over=others.get(channel.name, channel.over)) for channel in scaled)


def by_column(blocks: Blocks, places: Sequence[tuple[int, int]]) -> Blocks:
    """Reader of blocks of columns from a reader of blocks of arrays, each of which is read once."""

    def columns_of(columns: Sequence[int], count: int) -> Iterator[list[FloatArray]]:
        wanted = [places[column] for column in columns]
        numbers = list(dict.fromkeys(number for number, _ in wanted))
        for block in blocks(numbers, count):
            arrays = dict(zip(numbers, block, strict=True))
            yield [_column(arrays[number], column) for number, column in wanted]

    return columns_of


def _column(block: FloatArray, column: int) -> FloatArray:
    return np.asarray(block if block.ndim == 1 else block[:, column], dtype=float)


def channel_of(item: StoredArray, number: int, name: str, unit: str) -> FileChannel:
    """Channel of an array in a file, with the quantity, rate and start that the array has as attributes."""
    numbers = _clock_numbers(item)
    rate, start = _rate_and_start(numbers)
    quantity = attribute_text(item, "quantity") or None
    own = FileChannel(name, number, unit, quantity, item.length, notes=_packing_notes(item))
    if WAVE_INTERVAL in item.attributes:
        return _with_waveform(own, item)
    if rate and 0 < rate < np.inf:
        return replace(own, rate=rate, start=start)
    return replace(own, start=start) if "start" in numbers else own


def _with_waveform(channel: FileChannel, item: StoredArray) -> FileChannel:
    """Channel with the clock, or other axis, that the waveform properties of LabVIEW say."""
    keys = WAVE_INTERVAL, WAVE_OFFSET, WAVE_START
    interval, offset, begun = (float(item.attributes.get(key) or 0.0) for key in keys)
    axis = attribute_text(item, WAVE_UNIT)
    over = other_axis(axis, attribute_text(item, WAVE_NAME))
    if over or not 0 < abs(interval) < float("inf"):
        return replace(channel, over=over if interval else "")
    # The time of day at which it began is in s, interval and offset are in the unit of the axis.
    seconds = seconds_in(axis)
    return replace(channel, rate=1 / (interval * seconds), start=begun + offset * seconds)


def _clock_numbers(item: StoredArray) -> _Numbers:
    """Numbers that tell a clock among the attributes of an array in a file, with their names."""
    kinds = {"rate": RATE_NAMES, "interval": INTERVAL_NAMES, "start": START_NAMES}
    attributes = ((kind, name, _number_of(item, name)) for kind, names in kinds.items() for name in reversed(names))
    whose = f" of {item.name}" if item.name else ""
    return {kind: (f"{name}{whose}", number) for kind, name, number in attributes if number is not None}


def _number_of(item: StoredArray, *names: str) -> float | None:
    """Finite number of the first of these attributes that an array in a file has, None where it has none."""
    for name in names:
        with contextlib.suppress(KeyError, TypeError, ValueError):
            number = float(item.attributes[name])  # type: ignore[arg-type]
            if np.isfinite(number):
                return number
    return None


def _packing_notes(item: StoredArray) -> tuple[NoteOrText, ...]:
    """Notes on what was done to the values of an array that is packed into whole numbers."""
    scale, offset = _number_of(item, "scale_factor"), _number_of(item, "add_offset")
    packed = f"multiplied by {scale or 1:g}, then {offset or 0:g} added, as the file says"
    missing = attribute_text(item, MISSING)
    plain = dict.fromkeys(FACTOR_NAMES, (None, 0.0, 1.0)) | dict.fromkeys(OFFSET_NAMES, (None, 0.0))
    unused = [f"{name} ({number:g})" for name, none in plain.items() if (number := _number_of(item, name)) not in none]
    doubt = warning(f"not applied, as nothing says how: its attribute{'s' * (len(unused) > 1)} {', '.join(unused)}")
    return (*([packed] if scale or offset else []), *([missing] if missing else []), *([doubt] if unused else []))


def told_apart(names: Sequence[str], longer: Sequence[str]) -> list[str]:
    """Names of channels, of which equal ones are replaced by ``longer`` ones, with numbers where these are equal, too.

    >>> told_apart(["T", "w", "T", "T"], ["1/T", "1/w", "2/T", "2/T"])
    ['1/T', 'w', '2/T', '2/T_2']
    """
    apart: list[str] = []
    for name, other in zip(names, longer, strict=True):
        apart.append(name if names.count(name) == 1 else free_name(other, {*apart, *names}))
    return apart


def attribute_text(item: StoredArray, *names: str) -> str:
    """Text of the first of these attributes that an array in a file has, empty where it has none."""
    return next((str(item.attributes[name]) for name in names if name in item.attributes), "")
