"""Recordings of which some channels hold the pulses of incremental encoders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsionnet.base.delimited.dialect import plain_unit
from torsionnet.base.errors import Fault, ModelError, SolveError, UsageError, unknown_name
from torsionnet.base.notes import NoteOrText, about_channel
from torsionnet.base.units import parse_unit
from torsionnet.signals.bandlimited import Rotation
from torsionnet.signals.encoder import (
    angle_from_counts,
    holds_pulse_times,
    pulse_times,
    refuse_unlikely_unit,
    rotation_of,
)
from torsionnet.signals.recording import FloatArray, Recording, Signal
from torsionnet.signals.records.assembling import recordings
from torsionnet.signals.records.channel_choice import ReadOptions
from torsionnet.signals.records.source import FileChannel, Source
from torsionnet.signals.records.stored_pulses import pulses_of
from torsionnet.signals.resampling import even_times


@dataclass(frozen=True, eq=False)
class EncoderRotation:
    """Rotation of a shaft from the pulses of an encoder in one channel.

    ``times`` are those of the pulses kept, s.
    """

    name: str
    steps: float
    times: FloatArray
    rotation: Rotation
    notes: tuple[NoteOrText, ...]

    def signal(self, times: FloatArray) -> Signal:
        """Angle in rad of the shaft at these times (n,) in s, counted from the first of them."""
        steps = self.rotation.at(times)
        angle = angle_from_counts(steps - steps[0], self.steps)
        return Signal(self.name, "angle", angle, self.notes)


def encoder_recording(source: Source, options: ReadOptions, file: str) -> Recording:
    """Recording with an angle in rad for every channel of pulses, cut to the time in which all of them turn.

    Raises
    ------
    ModelError
        Names that the file lacks, or pulses that cannot be read.
    """
    every = {stored.channel.name: stored.channel for stored in source.pulses} | source.every
    faults = [unknown_name("channel", name, every, ("channels",)) for name in options.pulses if name not in every]
    faults += [
        Fault(
            f"the steps per revolution must be a positive number, got {steps:g}",
            ("channels", name),
            kind="out-of-range",
        )
        for name, steps in options.pulses.items()
        if not steps > 0
    ]
    if faults:
        raise ModelError(faults, file)
    turning = [
        _turning(source, every[name], options, file)
        for name in options.pulses
        if options.names is None or name in options.names
    ]
    return _together(_others(source, options, file), turning, options, file)


def _others(source: Source, options: ReadOptions, file: str) -> Recording | None:
    """Recording of the channels that hold no pulses, None if there are none."""
    names = options.names
    if isinstance(names, Mapping):
        names = {name: new for name, new in names.items() if name not in options.pulses}
    elif names is not None:
        names = [name for name in names if name not in options.pulses]
    channels = tuple(channel for channel in source.channels if channel.name not in options.pulses)
    pulses = tuple(stored for stored in source.pulses if stored.channel.name not in options.pulses)
    if not (channels or pulses) or (names is not None and not names):
        return None
    rest = replace(source, channels=channels, pulses=pulses, time=_clock(source, options))
    units, quantities = (
        {name: word for name, word in given.items() if name not in options.pulses}
        for given in (options.units, options.quantities)
    )
    return next(recordings(rest, replace(options, names=names, quantities=quantities, units=units, pulses={}), file))


def _clock(source: Source, options: ReadOptions) -> FileChannel | None:
    """Channel of time stamps of the file, None where there is none or its stamps are those of pulses."""
    return None if source.time is None or source.time.name in options.pulses else source.time


def _turning(source: Source, channel: FileChannel, options: ReadOptions, file: str) -> EncoderRotation:
    steps = float(options.pulses[channel.name])
    train = next((stored for stored in source.pulses if stored.channel.name == channel.name), None)
    raw = np.empty(0) if train else next(source.blocks([channel.column], 0))[0]
    raw = raw[np.isfinite(raw)]
    stamped, unit = bool(train) or holds_pulse_times(raw), options.units.get(channel.name, channel.unit)
    read: tuple[NoteOrText, ...] = ()
    try:
        if train:
            known = pulses_of(source, train, channel.name)
            stamps, read, unit = known.times, known.notes, "s"
        elif stamped:
            stamps = raw * (float(parse_unit(plain_unit(unit)).factor) if unit else 1.0)
        else:
            alone = replace(channel, unit="", quantity="", notes=())
            rest = replace(source, channels=(alone,), time=_clock(source, options))
            # A rate that is chosen for the other channels is none of this one, if it has its own.
            rate = None if channel.rate or channel.clock else options.sampling_rate
            shape = next(recordings(rest, ReadOptions(sampling_rate=rate), file))
            stamps = pulse_times(shape.signals[0].values, shape.time)
        if stamped and not unit:
            refuse_unlikely_unit(stamps, steps)
        times, rotation, remarks = rotation_of(stamps, steps)
    except (UsageError, SolveError) as error:
        raise ModelError(
            [Fault(f"{channel.name}: {error}", ("channels", channel.name), kind=error.kind)], file
        ) from None
    kind = "time stamps of pulses" if stamped else "a pulse train"
    name = options.names[channel.name] if isinstance(options.names, Mapping) else channel.name
    notes = (f"angle from {kind}: {len(times)} pulses of {steps:g} a turn, band-limited between them", *remarks, *read)
    return EncoderRotation(name, steps, times, rotation, notes)


def _even(first: float, last: float, rate: float, turning: Sequence[EncoderRotation], file: str) -> FloatArray:
    """Uniform times (n,) in s from ``first`` to ``last``, in which all encoders turn."""
    place, most = ("channels", turning[0].name), max(len(rotation.times) for rotation in turning)
    if last < first:
        spans = "; ".join(f"{wheel.name} from {wheel.times[0]:.6g} to {wheel.times[-1]:.6g} s" for wheel in turning)
        raise ModelError([Fault(f"the pulses have no time in common: {spans}", place, kind="unlike-results")], file)
    try:
        return even_times(first, last, rate, most, "pulses")
    except UsageError as error:
        raise ModelError([error.fault.under(*place)], file) from None


def _together(
    record: Recording | None, turning: Sequence[EncoderRotation], options: ReadOptions, file: str
) -> Recording:
    if not turning:
        assert record is not None
        return record
    first, last = max(rotation.times[0] for rotation in turning), min(rotation.times[-1] for rotation in turning)
    if record is None or not record.signals:
        rate = options.sampling_rate or max(float(np.ceil(1 / np.diff(rotation.times).min())) for rotation in turning)
        record = replace(record or Recording((), rate, title=file), sampling_rate=rate, start=float(first))
        times = _even(float(first), float(last), rate, turning, file)
    else:
        inside = (record.time >= first) & (record.time <= last)
        times = record.time[inside]
        if not len(times):
            text = (
                f"pulses from {first:.6g} to {last:.6g} s and a record from {record.start:.6g} s have no time in common"
            )
            raise ModelError([Fault(text, ("channels",), kind="unlike-results")], file)
        if not inside.all():
            record = record.with_notes(f"cut to where there are pulses: from {times[0]:.6g} to {times[-1]:.6g} s")
        signals = tuple(replace(signal, values=signal.values[inside]) for signal in record)
        stamps = None if record.times is None else times
        record = replace(record, signals=signals, start=float(times[0]), times=stamps)
    remarks = [
        replace(about_channel(note, wheel.name), severity="warning") for wheel in turning for note in wheel.notes[1:]
    ]
    return replace(record, signals=(*record.signals, *(wheel.signal(times) for wheel in turning))).with_notes(*remarks)
