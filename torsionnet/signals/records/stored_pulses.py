"""Channels of pulses in files: times in s where this package has written them, else counts or times as recorded."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from torsionnet.base.delimited.dialect import plain_unit
from torsionnet.base.errors import Fault, ModelError, UsageError, unknown_name
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.base.units import parse_unit
from torsionnet.signals.recording import Recording, is_rate
from torsionnet.signals.records.source import NOWHERE, FileChannel, Source, StoredPulses, is_time, time_note
from torsionnet.signals.rotation.counter import PulseReading, pulse_channel
from torsionnet.signals.rotation.pulse_channel import PulseChannel

Names = Sequence[str] | Mapping[str, str] | None


LEAST_PULSE_RATE = 1.0
"""Pulses a second below which times of pulses without a unit are probably not in s."""


def with_readings(source: Source, readings: Mapping[str, PulseReading], units: Mapping[str, str], file: str) -> Source:
    """Source of which the channels named in ``readings`` are channels of pulses, so that they share no clock.

    Raises
    ------
    ModelError
        Names that the file lacks, or units that are none of time.
    """
    if not readings:
        return source
    every = source.every
    stored = {stored.channel.name for stored in source.pulses}
    unknown = [
        name
        for name, reading in readings.items()
        if name not in every and not (name in stored and reading.seconds is None)
    ]
    faults = [
        Fault(
            "its pulses are stored as times in s already: leave out tick, clock and bits",
            ("channels", name),
            kind="needless-entry",
        )
        if name in stored
        else unknown_name("channel", name, [*every, *stored], ("channels",))
        for name in unknown
    ]
    trains = list[StoredPulses]()
    for name, reading in readings.items():
        if name in every:
            channel = replace(every[name], unit=units.get(name, every[name].unit))
            fault = _unit_fault(channel, reading)
            faults += [fault] if fault else []
            trains.append(StoredPulses(channel, 0.0, reading))
    if faults:
        raise ModelError(faults, file)
    channels = tuple(channel for channel in source.channels if channel.name not in readings)
    rest = replace(source, channels=channels, pulses=(*source.pulses, *trains))
    if source.time is None or source.time.name not in readings:
        return rest
    notes = tuple(note for note in rest.notes if note != time_note(source.time))
    return replace(rest, time=None, notes=notes).with_time_channel()


def _unit_fault(channel: FileChannel, reading: PulseReading) -> Fault | None:
    if reading.seconds is not None or not channel.unit or is_time(channel):
        return None
    text = f'"{channel.unit}" is no unit of time; give the unit of the times, or the tick or clock of the counter'
    return Fault(text, ("channels", channel.name), kind="wrong-unit")


def rate_of(pulses: Sequence[PulseChannel]) -> float:
    """Sampling rate in Hz of a recording of pulses alone, that of the pulses of the fastest channel, rounded up."""
    intervals = [float(np.median(np.diff(channel.times))) for channel in pulses if len(channel) > 1]
    rate = float(np.ceil(1 / min(intervals))) if intervals else 1.0
    return rate if is_rate(rate) else 1.0


def stored_pulses(source: Source, names: Names, file: str) -> tuple[PulseChannel, ...]:
    """Channels of pulses of a file that are asked for, all where no names are given, under their new names.

    Raises
    ------
    ModelError
        Times that are not finite, or do not rise.
    """
    channels, faults = list[PulseChannel](), list[Fault]()
    for stored in source.pulses:
        name = stored.channel.name
        if names is None or name in names:
            try:
                channels.append(pulses_of(source, stored, names[name] if isinstance(names, Mapping) else name))
            except UsageError as error:
                faults.append(error.fault.under("channels", name))
    if faults:
        raise ModelError(faults, file)
    return tuple(channels)


def names_of_signals(source: Source, names: Names) -> Names:
    """Names without those of channels of pulses; None where all channels were asked for."""
    trains = {stored.channel.name for stored in source.pulses} - {channel.name for channel in source.channels}
    if names is None or not trains:
        return names
    if isinstance(names, Mapping):
        return {name: new for name, new in names.items() if name not in trains}
    return [name for name in names if name not in trains]


def pulses_of(source: Source, stored: StoredPulses, name: str) -> PulseChannel:
    """Channel of the pulses of one channel of a file, its times in s, under the given name.

    Raises
    ------
    UsageError
        Counts or times that cannot be read, or do not rise.
    """
    channel, reading = stored.channel, stored.reading
    raw = np.empty(0) if channel.column == NOWHERE else next(source.blocks([channel.column], 0), [np.empty(0)])[0]
    if reading is None:
        return PulseChannel(name, np.asarray(raw, dtype=np.float64), stored.tick, channel.notes)
    factor = float(parse_unit(plain_unit(channel.unit)).factor) if reading.seconds is None and channel.unit else 1.0
    pulses = pulse_channel(name, raw, reading, factor)
    if reading.seconds is None:
        said: NoteOrText = f"converted from {channel.unit}" if factor != 1.0 else ""
        pulses = replace(pulses, unit_known=bool(channel.unit))
        if not channel.unit and len(pulses) < LEAST_PULSE_RATE * np.ptp(pulses.times):
            said = warning(f"no unit in the file: taken for s: {pulses.span}; if they are in ms, give their unit")
        pulses = replace(pulses, notes=(*pulses.notes, said) if said else pulses.notes)
    return pulses


def with_pulses(blocks: Iterator[Recording], pulses: Sequence[PulseChannel]) -> Iterator[Recording]:
    """Yield recordings one after the other, each with the pulses from its first sample to that of the next.

    The first also has the pulses before it, the last those behind it.
    """
    if not pulses:
        yield from blocks
        return
    begin, held = -np.inf, next(blocks, None)
    while held is not None:
        following = next(blocks, None)
        end = np.inf if following is None else float(following.time[0])
        yield replace(held, pulses=tuple(channel.between(begin, end) for channel in pulses))
        begin, held = end, following
