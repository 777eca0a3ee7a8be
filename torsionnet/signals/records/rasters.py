"""Rasters of a file: which of its channels were sampled together, by their rates, starts and time stamps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from torsionnet.base.errors import Fault, comma_list
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.signals.foreign.content import Blocks
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.records.channel_choice import ChannelChoice
from torsionnet.signals.records.clock import (
    UNIFORM_TOLERANCE,
    Clock,
    clock_in_days,
    clock_of,
    coarse_clock,
    is_coarse,
    order_faults,
    time_unit_warnings,
    value_faults,
)
from torsionnet.signals.records.source import Source, seconds_in

EQUAL_RATES = 1e-7
"""Relative difference of sampling rates that are the same, as those of intervals with rounded decimals are."""
SAME_START, START_STEP = UNIFORM_TOLERANCE, 1e-6
"""Share of a sampling interval by which samples of channels may be apart and count as taken together, as even time
stamps may be off by it, and the step in s in which programs write the times at which channels began."""
MOST_NAMED = 5
"""Number of channels of one rate that a message names at most, so that it stays short."""


@dataclass(frozen=True)
class Raster:
    """Channels of one sampling rate in Hz; those at uneven time stamps are a raster of their own."""

    rate: float
    choices: list[ChannelChoice]

    @property
    def is_even(self) -> bool:
        """Whether the channels were sampled at even steps."""
        return all(choice.channel.clock is None for choice in self.choices)


@dataclass(frozen=True)
class OwnClocks:
    """Choices of channels that carry rate and start of their time stamps, and stamps (n,) in s by their column."""

    choices: list[ChannelChoice]
    stamps: Mapping[int, FloatArray] = field(default_factory=dict)
    faults: list[Fault] = field(default_factory=list)
    notes: tuple[NoteOrText, ...] = ()


def own_clocks(source: Source, choices: Sequence[ChannelChoice], rate: float | None = None) -> OwnClocks:
    """Read the time stamps of channels that have some of their own; of even ones rate and start are kept.

    The sampling ``rate`` in Hz, if given, is that of stamps coarser than the sampling.
    """
    clocks = {choice.channel.clock.column: choice.channel.clock for choice in choices if choice.channel.clock}
    raw = {column: next(source.blocks([column], 0), [np.empty(0)])[0] for column in clocks}
    stamps, even, faults, notes = dict[int, FloatArray](), dict[int, Clock](), list[Fault](), list[NoteOrText]()
    zero: float | None = None  # numbers of days count from that of the first
    for column, given in clocks.items():
        clock, said = clock_in_days(given, raw[column])
        zero = clock.zero if zero is None and said else zero
        scale, origin = seconds_in(clock.unit), (zero or 0.0) if said else 0.0
        stamps[column] = (raw[column] - origin) * scale
        timed_by = replace(source, time=clock)
        wrong = value_faults(stamps[column], timed_by)
        is_coarser = bool(rate) and not wrong and is_coarse(stamps[column])
        if is_coarser:
            own, wrong = _coarse_clock(stamps[column], rate or 1.0, float(raw[column][0] * scale), clock.name)
        else:
            own = Clock(1.0, 0.0) if wrong else clock_of(raw[column], None, scale=scale)
        uneven = own.times is not None
        even[column] = replace(own, start=own.start - origin * scale, times=stamps[column] if uneven else None)
        faults += wrong or (order_faults(stamps[column], timed_by) if uneven else [])
        notes += [warning(f"{clock.name} is coarser than the sampling: the rate given was taken")] * is_coarser
        notes += filter(None, [said, own.note and f"{clock.name}: {own.note}"])
        notes += () if wrong or faults else time_unit_warnings(stamps[column], timed_by)
    if faults:
        return OwnClocks(list(choices), stamps, faults)
    # Equal stamps in two columns are one raster.
    same = {column: next(at for at in stamps if np.array_equal(stamps[at], stamps[column])) for column in stamps}

    def timed(choice: ChannelChoice) -> ChannelChoice:
        if choice.channel.clock is None:
            return choice
        column = same[choice.channel.clock.column]
        own = None if even[column].times is None else clocks[column]
        channel = replace(choice.channel, rate=even[column].rate, start=even[column].start, clock=own)
        return replace(choice, channel=channel)

    return OwnClocks([timed(choice) for choice in choices], stamps, notes=tuple(notes))


def _coarse_clock(stamps: FloatArray, rate: float, begin: float, name: str) -> tuple[Clock, list[Fault]]:
    found = coarse_clock(stamps, rate, begin)
    return (Clock(rate, begin), [replace(found, path=("channels", name))]) if isinstance(found, Fault) else (found, [])


def rasters_of(choices: Sequence[ChannelChoice]) -> list[Raster]:
    """Rasters of channels by rising rate; a channel without rate belongs to each."""
    found: list[Raster] = []
    for choice in sorted((one for one in choices if one.channel.rate), key=lambda one: one.channel.rate or 0.0):
        rate, clock = choice.channel.rate or 0.0, choice.channel.clock
        fitting = [one for one in found if one.choices[0].channel.clock == clock and _is_of(choice, one.rate)]
        if fitting:
            fitting[0].choices.append(choice)
        else:
            found.append(Raster(rate, [choice]))
    return found


def in_raster(raster: Raster, choices: Sequence[ChannelChoice]) -> tuple[list[ChannelChoice], list[ChannelChoice]]:
    """Choices that belong to a raster, or have no rate, and the others, in their order."""
    columns = {choice.channel.column for choice in raster.choices}
    inside = [not choice.channel.rate or choice.channel.column in columns for choice in choices]
    kept, others = (
        [choice for choice, here in zip(choices, inside, strict=True) if here is side] for side in (True, False)
    )
    return kept, others


def own_start(choice: ChannelChoice, source: Source) -> float:
    """Time in s of the first sample of a channel."""
    return source.start if choice.channel.start is None else choice.channel.start


def is_whole(shift: float, rate: float) -> bool:
    """Whether a time in s is a whole number of sampling intervals.

    >>> is_whole(0.25, 1000.0), is_whole(0.0001, 1000.0)
    (True, False)
    """
    count = shift * rate
    return abs(count - round(count)) <= max(SAME_START, START_STEP * rate)


def cut_together(source: Source, kept: Sequence[ChannelChoice], rate: float) -> tuple[Source, list[ChannelChoice]]:
    """Channels of one rate cut to where all of them were recorded; their starts differ by whole samples.

    ``length`` of a channel is 0 where there is no time in common.
    """
    starts = [own_start(choice, source) for choice in kept]
    latest = max(starts)
    skips = {choice.channel.column: round((latest - start) * rate) for choice, start in zip(kept, starts, strict=True)}
    lengths = [choice.channel.length or 0 for choice in kept]
    if not any(skips.values()) and len(set(lengths)) < 2:
        return replace(source, rate=rate, start=latest), list(kept)
    count = max(0, min(length - skip for length, skip in zip(lengths, skips.values(), strict=True)))
    where = comma_list([_span(choice, source, rate) for choice in kept], MOST_NAMED)
    note = f"cut to where all channels were recorded, from {latest:.6g} to {latest + (count - 1) / rate:.6g} s: {where}"
    found = replace(source, blocks=_cut_blocks(source.blocks, skips, count), rate=rate, start=latest)
    cut = [replace(choice, channel=replace(choice.channel, start=latest, length=count)) for choice in kept]
    return replace(found, notes=(*found.notes, note)), cut


def _cut_blocks(blocks: Blocks, skips: Mapping[int, int], count: int) -> Blocks:
    """Reader of blocks of channels that begin with different samples, each of which is read as a whole."""

    def cut(columns: Sequence[int], size: int) -> Iterator[list[FloatArray]]:
        values = [next(blocks([column], 0))[0][skips[column] : skips[column] + count] for column in columns]
        step = size or max(count, 1)
        for first in range(0, count, step):
            yield [found[first : first + step] for found in values]

    return cut


def _span(choice: ChannelChoice, source: Source, rate: float) -> str:
    start = own_start(choice, source)
    return f"{choice.channel.name} from {start:.6g} to {start + ((choice.channel.length or 1) - 1) / rate:.6g} s"


def _is_of(choice: ChannelChoice, rate: float) -> bool:
    own, count = choice.channel.rate, choice.channel.length or 1
    return own is None or abs(own / rate - 1) <= max(EQUAL_RATES, SAME_START / count)


def listed(choices: Sequence[ChannelChoice], source: Source) -> str:
    """Channels with their rates and starts, for a message."""
    return comma_list([f"{choice.channel.name} ({_clock(choice, source)})" for choice in choices], MOST_NAMED)


def _clock(choice: ChannelChoice, source: Source) -> str:
    uneven = " at uneven stamps" if choice.channel.clock else ""
    return f"{choice.channel.rate or 0:g} Hz{uneven} from {own_start(choice, source):.9g} s"
