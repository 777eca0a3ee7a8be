"""A recording of which some channels hold the pulses of encoders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsionnet.core.delimited.headings import plain_unit
from torsionnet.core.errors import Fault, ModelError, SolveError, UsageError, unknown_name
from torsionnet.core.units import parse_unit
from torsionnet.io.records.assembling import Wanted, recordings
from torsionnet.io.records.source import FileChannel, Source
from torsionnet.response.recording import FloatArray, Recording, Signal
from torsionnet.signals.bandlimited import Rotation
from torsionnet.signals.encoder import angle_from_counts, rotation_of
from torsionnet.signals.pulse_train import is_stamped, pulse_times
from torsionnet.signals.sample_counts import even_times

LEAST_PACE = 1.0
"""Pulses a second, below which their times are hardly in s."""


@dataclass(frozen=True, eq=False)
class Turning:
    """What the pulses of a channel say.

    ``times`` are those of the pulses kept, s.
    """

    name: str
    steps: float
    times: FloatArray
    rotation: Rotation
    notes: tuple[str, ...]

    def signal(self, times: FloatArray) -> Signal:
        """Angle since the first of these times."""
        steps = self.rotation.at(times)
        angle = angle_from_counts(steps - steps[0], self.steps)
        return Signal(self.name, "angle", angle, self.notes)


def pulsed(source: Source, wanted: Wanted, file: str) -> Recording:
    """The recording, with an angle of every channel of pulses, cut to where all of them turn.

    Raises
    ------
    ModelError
        Names that the file lacks, or pulses that cannot be read.
    """
    every = {channel.name: channel for channel in (*source.channels, *([source.time] if source.time else []))}
    faults = [unknown_name("channel", name, every, ("channels",)) for name in wanted.pulses if name not in every]
    faults += [
        Fault(f"the steps per revolution must be a positive number, got {steps:g}", ("channels", name))
        for name, steps in wanted.pulses.items()
        if not steps > 0
    ]
    if faults:
        raise ModelError(faults, file)
    turning = [_turning(source, every[name], wanted, file) for name in wanted.pulses if _is_asked(name, wanted.names)]
    return _together(_others(source, wanted, file), turning, wanted, file)


def _is_asked(name: str, names: Sequence[str] | Mapping[str, str] | None) -> bool:
    return names is None or name in names


def _others(source: Source, wanted: Wanted, file: str) -> Recording | None:
    """The recording of the other channels, if there are any."""
    names = wanted.names
    if isinstance(names, Mapping):
        names = {name: new for name, new in names.items() if name not in wanted.pulses}
    elif names is not None:
        names = [name for name in names if name not in wanted.pulses]
    channels = tuple(channel for channel in source.channels if channel.name not in wanted.pulses)
    if not channels or (names is not None and not names):
        return None
    rest = replace(source, channels=channels, time=_clock(source, wanted))
    units, quantities = (
        {name: word for name, word in given.items() if name not in wanted.pulses}
        for given in (wanted.units, wanted.quantities)
    )
    return next(recordings(rest, Wanted(names, quantities, units, wanted.sampling_rate), file))


def _clock(source: Source, wanted: Wanted) -> FileChannel | None:
    """The channel of time stamps, unless its stamps are those of pulses."""
    return None if source.time is None or source.time.name in wanted.pulses else source.time


def _turning(source: Source, channel: FileChannel, wanted: Wanted, file: str) -> Turning:
    steps = float(wanted.pulses[channel.name])
    raw = next(source.blocks([channel.column], 0))[0]
    raw = raw[np.isfinite(raw)]
    stamped, unit = is_stamped(raw), wanted.units.get(channel.name, channel.unit)
    try:
        if stamped:
            stamps = raw * (float(parse_unit(plain_unit(unit)).factor) if unit else 1.0)
        else:
            alone = replace(channel, unit="", quantity="", notes=())
            rest = replace(source, channels=(alone,), time=_clock(source, wanted))
            train = next(recordings(rest, Wanted(sampling_rate=wanted.sampling_rate), file))
            stamps = pulse_times(train.signals[0].values, train.time)
        times, rotation, remarks = rotation_of(stamps, steps)
    except (UsageError, SolveError) as error:
        raise ModelError([Fault(f"{channel.name}: {error}", ("channels", channel.name))], file) from None
    slow = len(stamps) < LEAST_PACE * (stamps[-1] - stamps[0])
    if stamped and not unit and slow:
        told = f"the times of pulses have no unit and were taken for s: {len(stamps)} in {stamps[-1] - stamps[0]:.4g} s"
        remarks = (*remarks, f"{told}; if they are in ms, or count ticks, give their unit")
    kind = "time stamps of pulses" if stamped else "a pulse train"
    name = wanted.names[channel.name] if isinstance(wanted.names, Mapping) else channel.name
    notes = (f"angle from {kind}: {len(times)} pulses of {steps:g} a turn, band-limited between them", *remarks)
    return Turning(name, steps, times, rotation, notes)


def _even(first: float, last: float, rate: float, turning: Sequence[Turning], file: str) -> FloatArray:
    """Times at which all turn, s."""
    place, most = ("channels", turning[0].name), max(len(one.times) for one in turning)
    if last < first:
        spans = "; ".join(f"{one.name} from {one.times[0]:.6g} to {one.times[-1]:.6g} s" for one in turning)
        raise ModelError([Fault(f"the pulses have no time in common: {spans}", place)], file)
    try:
        return even_times(first, last, rate, most, "pulses")
    except UsageError as error:
        raise ModelError([Fault(str(error), place)], file) from None


def _together(record: Recording | None, turning: Sequence[Turning], wanted: Wanted, file: str) -> Recording:
    if not turning:
        assert record is not None
        return record
    first, last = max(one.times[0] for one in turning), min(one.times[-1] for one in turning)
    if record is None:
        rate = wanted.sampling_rate or max(float(np.ceil(1 / np.diff(one.times).min())) for one in turning)
        record = Recording((), rate, float(first), title=file)
        times = _even(float(first), float(last), rate, turning, file)
    else:
        inside = (record.time >= first) & (record.time <= last)
        times = record.time[inside]
        if not len(times):
            text = (
                f"pulses from {first:.6g} to {last:.6g} s and a record from {record.start:.6g} s have no time in common"
            )
            raise ModelError([Fault(text, ("channels",))], file)
        if not inside.all():
            record = record.noted(f"cut to where there are pulses: from {times[0]:.6g} to {times[-1]:.6g} s")
        signals = tuple(replace(signal, values=signal.values[inside]) for signal in record)
        stamps = None if record.times is None else times
        record = replace(record, signals=signals, start=float(times[0]), times=stamps)
    remarks = [f"warning: {one.name}: {note}" for one in turning for note in one.notes[1:]]
    return replace(record, signals=(*record.signals, *(one.signal(times) for one in turning))).noted(*remarks)
