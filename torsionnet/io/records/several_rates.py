"""Channels of a file that were sampled at several rates: one rate is read, others are brought to it when asked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from torsionnet.core.errors import Fault, ModelError
from torsionnet.core.listing import comma_list
from torsionnet.io.records.channel_choice import ChannelChoice
from torsionnet.io.records.clock import SAME_RATE_TOLERANCE
from torsionnet.io.records.read_options import ReadOptions
from torsionnet.io.records.source import Source
from torsionnet.response.recording import FloatArray, Recording, Signal
from torsionnet.signals.resampling import VALID_SHARE, interpolated_at

EQUAL_RATES = 1e-7
"""Relative difference of sampling rates that are the same, as those of intervals with rounded decimals are."""
SAME_START = 1e-3
"""Share of a sampling interval by which channels may begin at different times and count as sampled together."""
MOST_NAMED = 5
"""Number of channels of one rate that a message names at most, so that it stays short."""


@dataclass(frozen=True)
class RateChoice:
    """Channels of one sampling rate that are read together, and others that are brought to it."""

    source: Source
    together: list[ChannelChoice]
    others: list[ChannelChoice] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)


def choose_rate(source: Source, choices: Sequence[ChannelChoice], options: ReadOptions) -> RateChoice:
    """Channels of a file of one sampling rate, that of ``options`` where there are several, and what is wrong."""
    rates = sorted({choice.channel.rate for choice in choices if choice.channel.rate})
    if source.time is not None or not rates:
        return RateChoice(source, list(choices))
    groups = [rate for number, rate in enumerate(rates) if not number or rate > rates[number - 1] * (1 + EQUAL_RATES)]
    if len(groups) == 1:
        return _together(source, choices, (), groups[0], options)
    given = options.sampling_rate
    wanted = next((rate for rate in groups if given and abs(given / rate - 1) < SAME_RATE_TOLERANCE), None)
    if wanted is None:
        return RateChoice(source, list(choices), faults=[_which(choices, groups, given)])
    kept = [choice for choice in choices if _is_of(choice, wanted)]
    others = [choice for choice in choices if not _is_of(choice, wanted)]
    return _together(source, kept, others, wanted, options)


def _together(
    source: Source, kept: Sequence[ChannelChoice], others: Sequence[ChannelChoice], rate: float, options: ReadOptions
) -> RateChoice:
    start = next((choice.channel.start for choice in kept if choice.channel.start is not None), source.start)
    late = [choice for choice in kept if not _begins_at(choice, start, rate)]
    notes = source.notes
    if late and options.resample:
        kept = [choice for choice in kept if _begins_at(choice, start, rate)]
        others = [*others, *late]
    elif late:
        starts = [choice.channel.start for choice in kept if choice.channel.start is not None]
        text = f"warning: channels have starts between {min(starts):.6g} and {max(starts):.6g} s; that of the first "
        notes = (*notes, f"{text}was taken for all; resample=True moves them to their times")
    found = replace(source, rate=rate, start=start, notes=notes)
    if not others or options.resample:
        return RateChoice(found, list(kept), list(others))
    if options.names is not None:
        text = f"{_listed(others)} were not sampled at {rate:g} Hz; give resample=True to interpolate them, or leave "
        return RateChoice(found, list(kept), faults=[Fault(f"{text}them out of names=")])
    note = f"left out, as sampled at other rates than {rate:g} Hz: {_listed(others)}; resample=True interpolates them"
    return RateChoice(replace(found, notes=(*found.notes, note)), list(kept))


def _is_of(choice: ChannelChoice, rate: float) -> bool:
    own = choice.channel.rate
    return own is None or abs(own / rate - 1) <= EQUAL_RATES


def _begins_at(choice: ChannelChoice, start: float, rate: float) -> bool:
    own = choice.channel.start
    return own is None or abs(own - start) * rate <= SAME_START


def _listed(choices: Sequence[ChannelChoice]) -> str:
    names = [f"{choice.channel.name} ({choice.channel.rate or 0:g} Hz)" for choice in choices]
    return comma_list(names, MOST_NAMED)


def _which(choices: Sequence[ChannelChoice], rates: Sequence[float], given: float | None) -> Fault:
    parts = []
    for rate in rates:
        names = [choice.channel.name for choice in choices if choice.channel.rate and _is_of(choice, rate)]
        parts.append(f"{rate:g} Hz ({comma_list(names, MOST_NAMED)})")
    said = f"sampling_rate={given:g} is none of them" if given else "sampling_rate= chooses one"
    text = f"the channels were sampled at {len(rates)} rates: {', '.join(parts)}; {said}"
    return Fault(f"{text}, resample=True brings the others to it, names= chooses channels")


def read_others(source: Source, others: Sequence[ChannelChoice], file: str) -> list[FloatArray]:
    """Samples of channels of other rates, (n,) each, in the units of the file.

    Raises
    ------
    ModelError
        Values that are not finite, as they cannot be interpolated.
    """
    found, faults = list[FloatArray](), list[Fault]()
    for choice in others:
        values = np.asarray(next(source.blocks([choice.channel.column], 0), [np.empty(0)])[0], dtype=np.float64)
        broken = int(np.count_nonzero(~np.isfinite(values)))
        if broken or not len(values):
            says = f"{broken} of its values are not finite" if broken else "it has no values"
            faults.append(Fault(f"cannot be interpolated: {says}; leave it out", ("channels", choice.channel.name)))
        found.append(values)
    if faults:
        raise ModelError(faults, file)
    return found


def with_others(
    record: Recording, chosen: RateChoice, order: Sequence[ChannelChoice], samples: Sequence[FloatArray], file: str
) -> Recording:
    """Recording with the signals of other rates interpolated at its times, cut to where all of them were recorded.

    Its signals stand in the ``order`` of the channels.

    Raises
    ------
    ModelError
        There is no time in common.
    """
    source, together, others = chosen.source, chosen.together, chosen.others
    if not others:
        return record
    clocks = [
        (choice.channel.rate or record.sampling_rate, _own_start(choice, source), len(values))
        for choice, values in zip(others, samples, strict=True)
    ]
    time, slack = record.time, SAME_START / record.sampling_rate
    first = max(start for _, start, _ in clocks) - slack
    last = min(start + (count - 1) / rate for rate, start, count in clocks) + slack
    inside = (time >= first) & (time <= last)
    if not inside.any():
        text = f"channels of other rates, from {first:.6g} to {last:.6g} s, have no time in common with the others, "
        raise ModelError([Fault(f"{text}from {time[0]:.6g} to {time[-1]:.6g} s; read them one by one")], file)
    new, times = record.sampling_rate, time[inside]
    made = [
        Signal(
            choice.name, choice.quantity, choice.factor * interpolated_at(values, rate, start, times, new),
            (*choice.notes, _how(rate, new)),
        )
        for choice, values, (rate, start, _) in zip(others, samples, clocks, strict=True)
    ]  # fmt: skip
    kept = [replace(signal, values=signal.values[inside]) for signal in record]
    what = (
        f"{len(others)} channels of other rates or starts" if len(others) > 1 else "1 channel of another rate or start"
    )
    notes = [f"{what} interpolated at {new:g} Hz: {_listed(others)}"]
    if not inside.all():
        notes.append(f"cut to where all channels were recorded: from {times[0]:.6g} to {times[-1]:.6g} s")
    places = {choice.channel.column: number for number, choice in enumerate(order)}
    columns = [choice.channel.column for choice in (*together, *others)]
    signals = [
        signal for _, signal in sorted(zip(columns, [*kept, *made], strict=True), key=lambda one: places[one[0]])
    ]
    return replace(record, signals=tuple(signals), start=float(times[0])).with_notes(*notes)


def _own_start(choice: ChannelChoice, source: Source) -> float:
    return source.start if choice.channel.start is None else choice.channel.start


def _how(rate: float, new: float) -> str:
    limit = VALID_SHARE * min(rate, new) / 2
    return f"interpolated from {rate:g} to {new:g} Hz, band-limited: holds up to {limit:g} Hz"
