"""Channels of a file that were sampled at several rates: one rate is read, others are brought to it when asked."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from torsionnet.base.errors import Fault, ModelError, comma_list, remedy
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.signals.recording import FloatArray, Recording, Signal
from torsionnet.signals.records.channel_choice import (
    MOST_NAMED,
    SAME_START,
    ChannelChoice,
    Raster,
    ReadOptions,
    cut_together,
    in_raster,
    is_whole,
    listed,
    own_clocks,
    own_start,
    rasters_of,
)
from torsionnet.signals.records.clock import SAME_RATE_TOLERANCE
from torsionnet.signals.records.source import NOWHERE, FileChannel, Source, group_of, time_note
from torsionnet.signals.resampling import band_loss, interpolated_at, resampled


@dataclass(frozen=True)
class RateChoice:
    """Channels of one sampling rate that are read together, and others that are brought to it.

    ``stamps`` are those (n,) in s of channels with uneven time stamps of their own, by the column of these.
    """

    source: Source
    together: list[ChannelChoice]
    others: list[ChannelChoice] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)
    stamps: Mapping[int, FloatArray] = field(default_factory=dict)


def choose_rate(source: Source, choices: Sequence[ChannelChoice], options: ReadOptions) -> RateChoice:
    """Channels of a file of one sampling rate, that of ``options`` where there are several, and what is wrong."""
    source = _without_other_axes(source, options)
    if source.time is not None:
        return RateChoice(source, list(choices))
    single = [choice for choice in choices if choice.channel.clock and choice.channel.clock.length == 1]
    if options.names is None and 0 < len(single) < len(choices):
        names = comma_list([choice.channel.name for choice in single], MOST_NAMED)
        source = replace(source, notes=(*source.notes, f"left out, as they are single samples: {names}"))
        choices = [choice for choice in choices if choice not in single]
    axes = {choice.channel.scale.name for choice in choices if choice.channel.scale}
    if options.names is None and any(choice.channel.clock or choice.channel.rate for choice in choices):
        choices = [choice for choice in choices if choice.channel.name not in axes]
    clocks = {choice.channel.clock.column: choice.channel.clock for choice in choices if choice.channel.clock}
    if len(clocks) == 1 and all(choice.channel.clock for choice in choices):
        return RateChoice(_on_clock(source, next(iter(clocks.values()))), list(choices))
    own = own_clocks(source, choices, options.sampling_rate)
    rasters, source = rasters_of(own.choices), replace(source, notes=(*source.notes, *own.notes))
    if own.faults or not rasters:
        return RateChoice(_told_of_scales(source, choices), own.choices, faults=own.faults)
    given = options.sampling_rate
    wanted = [raster for raster in rasters if given is None or abs(given / raster.rate - 1) < SAME_RATE_TOLERANCE]
    if len(rasters) == 1 and not wanted:
        text = f"the file says {listed(rasters[0].choices, source)}, {remedy('sampling_rate=', f'{given:g}')} was given"
        return RateChoice(
            source,
            own.choices,
            faults=[Fault(f"{text}; leave it out to take the rate of the file", kind="contradicting-values")],
        )
    if len(rasters) > 1 and (not wanted or (given is None and not options.resample)):
        return RateChoice(source, own.choices, faults=[_which(rasters, source, given)])
    raster = max(wanted, key=lambda raster: (raster.is_even, raster.rate))
    stamped = {choice.channel.column for choice in choices if choice.channel.clock}
    source, placed, faults = _placed(source, own.choices, raster, stamped, surely=len(rasters) > 1 or not given)
    if faults:
        return RateChoice(source, placed, faults=faults)
    kept, others = in_raster(raster, placed)
    if raster.is_even:
        chosen = _together(source, kept, others, raster.rate, options)
    else:
        clocked = _on_clock(source, raster.choices[0].channel.clock)
        chosen = _with_others_or_without(clocked, kept, others, raster.rate, options)
    return replace(chosen, stamps=own.stamps)


def _told_of_scales(source: Source, choices: Sequence[ChannelChoice]) -> Source:
    """Source with a warning where channels over several dimension scales are put on one clock."""
    scales = dict.fromkeys(choice.channel.scale.name for choice in choices if choice.channel.scale)
    if len(scales) < 2:
        return source
    note = warning(f"channels over {comma_list(list(scales), MOST_NAMED)} were taken to begin together, at one rate")
    return replace(source, notes=(*source.notes, note))


def _placed(
    source: Source, choices: Sequence[ChannelChoice], raster: Raster, stamped: Collection[int], *, surely: bool
) -> tuple[Source, list[ChannelChoice], list[Fault]]:
    """Channels without a clock placed at the start of a raster, told in the notes of the source, and what forbids it.

    With ``surely`` they have to stand in one group with channels that have rates of their own, and as many values.
    Time stamps, as the columns ``stamped`` have them, may be those of these channels alone.
    """
    timed = [choice for choice in raster.choices if choice.channel.rate]
    unclocked = [choice.channel for choice in choices if not choice.channel.rate]
    starts, doubtful = dict[int, float](), list[FileChannel]()
    for channel in unclocked:
        alike = [choice for choice in timed if choice.channel.length == channel.length]
        # The nearest relatives come first: those of the same group, then those of the same length, then all.
        near = [choice for choice in alike if group_of(choice.channel) == group_of(channel)]
        beside = [choice for choice in near if choice.channel.column not in stamped and channel.scale is None]
        begun = {own_start(choice, source) for choice in (beside if surely else near or alike or timed)}
        # A start is taken over only where all of them agree.
        if len(begun) == 1:
            starts[channel.column] = begun.pop()
        else:
            doubtful.append(channel)
    if doubtful:
        return source, list(choices), [_without_clock(doubtful, raster, source, surely=surely)]
    if unclocked:
        names = comma_list([channel.name for channel in unclocked], MOST_NAMED)
        note = f"{names}: no clock in the file, taken to be sampled with the others"
        source = replace(source, notes=(*source.notes, note))
    placed = [
        replace(choice, channel=replace(choice.channel, start=starts[choice.channel.column]))
        if not choice.channel.rate
        else choice
        for choice in choices
    ]
    return source, placed, []


def _without_clock(unclocked: Sequence[FileChannel], raster: Raster, source: Source, *, surely: bool) -> Fault:
    """Fault that nothing tells when channels were sampled that stand beside others with a clock."""
    said = [f"{channel.name} (over {channel.scale.name})" if channel.scale else channel.name for channel in unclocked]
    have = "have" if len(said) > 1 else "has"
    text = f"{comma_list(said, MOST_NAMED)} {have} no clock in the file, {listed(raster.choices, source)} another; "
    if surely:
        rate = remedy("sampling_rate=", f"{raster.rate:g}")
        text += f"give {unit_of_scale(unclocked)}{rate} if they were sampled together, or "
    return Fault(f"{text}read them one by one", kind="unlike-results")


def unit_of_scale(channels: Iterable[FileChannel]) -> str:
    """Advice to give the first dimension scale of channels, if it is the time, its unit; empty without scales."""
    scales = [channel.scale for channel in channels if channel.scale and channel.scale.column != NOWHERE]
    return f"{remedy('units=', {scales[0].name: 's'})} if {scales[0].name} is the time, or " if scales else ""


def _without_other_axes(source: Source, options: ReadOptions) -> Source:
    left = [f"{channel.name} (over {channel.over})" for channel in source.channels if channel.over]
    if not left or options.names is not None:
        return source
    return replace(
        source, notes=(*source.notes, f"left out, as they are no records over time: {comma_list(left, MOST_NAMED)}")
    )


def _on_clock(source: Source, clock: FileChannel | None) -> Source:
    return replace(
        source, time=clock, notes=(*source.notes, *([time_note(clock)] if clock and not source.stamped else []))
    )


def _together(
    source: Source,
    kept: Sequence[ChannelChoice],
    others: Sequence[ChannelChoice],
    rate: float,
    options: ReadOptions,
) -> RateChoice:
    first = own_start(kept[0], source)
    # Channels of one rate may still be shifted by a part of a sample, which no cut brings together.
    between = [choice for choice in kept if not is_whole(own_start(choice, source) - first, rate)]
    if between and not options.resample:
        text = f"channels begin at times that differ by parts of a sampling interval: {listed(kept, source)}; "
        text += f"{remedy('resample=True')} moves them to their times, or read them one by one"
        return RateChoice(source, list(kept), faults=[Fault(text, kind="unlike-results")])
    kept = [choice for choice in kept if choice not in between]
    cut, cut_choices = cut_together(source, kept, rate)
    if cut_choices[0].channel.length == 0:
        text = f"the channels have no time in common: {listed(kept, source)}; read them one by one"
        return RateChoice(source, list(kept), faults=[Fault(text, kind="unlike-results")])
    return _with_others_or_without(cut, cut_choices, [*others, *between], rate, options)


def _with_others_or_without(
    source: Source,
    kept: Sequence[ChannelChoice],
    others: Sequence[ChannelChoice],
    rate: float,
    options: ReadOptions,
) -> RateChoice:
    if not others or options.resample:
        return RateChoice(source, list(kept), list(others))
    if options.names is not None:
        text = f"{listed(others, source)} were not sampled at {rate:g} Hz; give {remedy('resample=True')} to "
        return RateChoice(
            source, list(kept), faults=[Fault(f"{text}interpolate them, or leave them out", kind="unlike-results")]
        )
    note = f"left out, as sampled at other rates than {rate:g} Hz: {listed(others, source)}; "
    note += f"{remedy('resample=True')} interpolates them"
    return RateChoice(replace(source, notes=(*source.notes, note)), list(kept))


def _which(rasters: Sequence[Raster], source: Source, given: float | None) -> Fault:
    parts = []
    for raster in rasters:
        starts = dict.fromkeys(f"{own_start(choice, source):.9g}" for choice in raster.choices)
        uneven = "" if raster.is_even else " at uneven time stamps"
        names = comma_list([choice.channel.name for choice in raster.choices], MOST_NAMED)
        parts.append(f"{raster.rate:g} Hz{uneven} from {comma_list(list(starts), MOST_NAMED)} s ({names})")
    rate = remedy("sampling_rate=", f"{given:g}" if given else "")
    said = f"{rate} is none of them" if given else f"{rate} chooses one"
    rates = len({raster.rate for raster in rasters})
    text = f"the channels were sampled at {rates} rate{'s' * (rates > 1)}: {'; '.join(parts)}; {said}"
    text += f", {remedy('resample=True')} brings the others to it, or to the highest; or read those of one rate alone"
    return Fault(text, kind="unlike-results")


@dataclass(frozen=True)
class OtherSamples:
    """Samples (n,) of a channel of another rate in Hz in the unit of the file, from its own start in s on."""

    values: FloatArray
    rate: float
    start: float
    notes: tuple[NoteOrText, ...] = ()


def read_others(source: Source, chosen: RateChoice, file: str) -> list[OtherSamples]:
    """Samples of the channels of other rates; uneven ones are brought to their own mean rate.

    Raises
    ------
    ModelError
        Values that are not finite, as they cannot be interpolated.
    UsageError
        Gaps in uneven time stamps.
    """
    samples, faults = list[OtherSamples](), list[Fault]()
    for choice in chosen.others:
        channel = choice.channel
        values = np.asarray(next(source.blocks([channel.column], 0), [np.empty(0)])[0], dtype=np.float64)
        broken = int(np.count_nonzero(~np.isfinite(values)))
        if broken or not len(values):
            says = f"{broken} of its values are not finite" if broken else "it has no values"
            faults.append(
                Fault(f"cannot be interpolated: {says}; leave it out", ("channels", channel.name), kind="not-finite")
            )
            continue
        rate, start = channel.rate or chosen.source.rate or 1.0, own_start(choice, source)
        if channel.clock is None:
            samples.append(OtherSamples(values, rate, start))
        else:
            uneven = Recording((Signal(channel.name, "", values),), rate, times=chosen.stamps[channel.clock.column])
            even = resampled(uneven)
            samples.append(OtherSamples(even.signals[0].values, rate, even.start, even.notes))
    if faults:
        raise ModelError(faults, file)
    return samples


def shares_time(record: Recording, samples: Sequence[OtherSamples]) -> bool:
    """Whether the channels of other rates were recorded at some time of a record, or there are none."""
    if not samples:
        return True
    first, last = _common_span(record, samples)
    return bool(np.any((record.time >= first) & (record.time <= last)))


def _common_span(record: Recording, samples: Sequence[OtherSamples]) -> tuple[float, float]:
    """First and last time in s at which all channels of other rates were recorded, less a rounding error."""
    # First the latest begin, then the earliest end of all channels.
    slack = SAME_START / record.sampling_rate
    last = min(own.start + (len(own.values) - 1) / own.rate for own in samples)
    return max(own.start for own in samples) - slack, last + slack


def with_others(
    record: Recording,
    chosen: RateChoice,
    order: Sequence[ChannelChoice],
    samples: Sequence[OtherSamples],
    file: str,
) -> Recording:
    """Recording with the signals of other rates interpolated at its times, cut to where all of them were recorded.

    Its signals stand in the ``order`` of the channels.

    Raises
    ------
    ModelError
        There is no time in common.
    """
    together, others = chosen.together, chosen.others
    if not others:
        return record
    # Interpolation wants equal steps; the rate that is lost stands in each note.
    record = resampled(record) if record.times is not None else record
    time, (first, last) = record.time, _common_span(record, samples)
    inside = (time >= first) & (time <= last)
    if not inside.any():
        text = f"channels of other rates, from {first:.6g} to {last:.6g} s, have no time in common with the others, "
        raise ModelError(
            [Fault(f"{text}from {time[0]:.6g} to {time[-1]:.6g} s; read them one by one", kind="unlike-results")], file
        )
    new, times = record.sampling_rate, time[inside]
    losses = [
        "; ".join([*map(str, own.notes), f"interpolated from {own.rate:g} to {new:g} Hz, {lost}"])
        for own in samples
        for lost in [band_loss(own.values, own.rate, new)]
    ]
    made = [
        Signal(
            choice.name, choice.quantity, own.values, (*choice.notes, loss), choice.channel.between
        ).at_other_rate(choice.factor * interpolated_at(own.values, own.rate, own.start, times, new), own.rate)
        for choice, own, loss in zip(others, samples, losses, strict=True)
    ]  # fmt: skip
    kept = [replace(signal, values=signal.values[inside]) for signal in record]
    what = (
        f"{len(others)} channels of other rates or starts" if len(others) > 1 else "1 channel of another rate or start"
    )
    notes = [f"{what} interpolated at {new:g} Hz: {listed(others, chosen.source)}"]
    notes += [f"{choice.name}: {loss}" for choice, loss in zip(others, losses, strict=True)]
    if not inside.all():
        notes.append(f"cut to where all channels were recorded: from {times[0]:.6g} to {times[-1]:.6g} s")
    # The signals have the order that was asked for, whichever rate they come from.
    places = {choice.channel.column: number for number, choice in enumerate(order)}
    columns = [choice.channel.column for choice in (*together, *others)]
    signals = [
        signal for _, signal in sorted(zip(columns, [*kept, *made], strict=True), key=lambda pair: places[pair[0]])
    ]
    return replace(record, signals=tuple(signals), start=float(times[0])).with_notes(*notes)
