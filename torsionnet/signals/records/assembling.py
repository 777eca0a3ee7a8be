"""Recordings from an open file: channels are chosen, units converted to SI, times checked, pulses of encoders read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsionnet.base.delimited.dialect import plain_unit
from torsionnet.base.errors import Fault, ModelError, SolveError, UsageError, comma_list, remedy, unknown_name
from torsionnet.base.expressions import LARGEST_SIZE
from torsionnet.base.notes import NoteOrText, about_channel, warning
from torsionnet.base.units import parse_unit
from torsionnet.linear.between_samples import Between, check_between
from torsionnet.signals.bandlimited import Rotation
from torsionnet.signals.encoder import (
    angle_from_counts,
    holds_pulse_times,
    pulse_times,
    refuse_unlikely_unit,
    rotation_of,
)
from torsionnet.signals.recording import FloatArray, Recording, Signal, is_rate
from torsionnet.signals.records.arrays import with_doubts
from torsionnet.signals.records.channel_choice import MOST_NAMED, ChannelChoice, ReadOptions, choose, length_faults
from torsionnet.signals.records.clock import (
    SAME_RATE_TOLERANCE,
    Clock,
    clock_in_days,
    clock_of,
    coarse_clock,
    interval_fault,
    is_coarse,
    order_faults,
    rate_fault,
    time_unit_warnings,
    value_faults,
)
from torsionnet.signals.records.several_rates import choose_rate, read_others, shares_time, unit_of_scale, with_others
from torsionnet.signals.records.source import FileChannel, Source, is_time, other_axis, seconds_in
from torsionnet.signals.records.stored_pulses import names_of_signals, pulses_of, rate_of, stored_pulses, with_pulses
from torsionnet.signals.resampling import even_times

# Recordings from an open file, for which channels are chosen, units converted to SI, times checked.


def with_given_clock(source: Source, options: ReadOptions) -> tuple[Source, ReadOptions]:
    """Source whose time stamps are the channel that the caller gives a unit of time, and the options left over.

    A unit of time stamps, or of a dimension scale, that only some channels have stays with these channels.
    """
    axes = {axis.name for channel in source.channels if (axis := channel.clock or channel.scale)}
    own = {name: plain_unit(unit) for name, unit in options.units.items() if name in axes}
    if own:
        left = {name: unit for name, unit in options.units.items() if name not in own}
        rest = (channel for channel in source.channels if channel.name not in own)
        channels = tuple(_with_unit_of_axis(channel, own, source.time) for channel in rest)
        source, options = replace(source, channels=channels, time=None), replace(options, units=left)
    every = source.every
    times = [
        name
        for name, unit in options.units.items()
        if name in every and is_time(replace(every[name], unit=plain_unit(unit))) and name not in (options.names or ())
    ]
    times = [name for name in times if not {name} & {*options.pulses, *options.readings}]
    if len(times) > 1:
        text = f"{comma_list(times, MOST_NAMED)} were given units of time, and nothing tells which channels go with "
        raise ModelError([Fault(f"{text}which; give one, and name its channels", kind="ambiguous-name")], source.title)
    for name, unit in options.units.items():
        channel = replace(every[name], unit=plain_unit(unit)) if name in every else None
        is_clock = channel is not None and (source.time is None or source.time.name == name)
        if channel is not None and is_clock and is_time(channel) and not {name} & {*options.pulses, *options.readings}:
            others = tuple(other for other in source.channels if other.name != name)
            left = {other: word for other, word in options.units.items() if other != name}
            return with_doubts(replace(source, channels=others, time=channel)), replace(options, units=left)
    return source, options


def _with_unit_of_axis(channel: FileChannel, units: Mapping[str, str], time: FileChannel | None) -> FileChannel:
    """Channel whose axis has its unit; one without an axis of its own keeps the time stamps of all."""
    axis = channel.clock or channel.scale
    if axis is None or axis.name not in units:
        return replace(channel, clock=channel.clock or time) if not (channel.scale or channel.over) else channel
    over = other_axis(units[axis.name])
    clock = None if over else replace(axis, unit=units[axis.name])
    return replace(channel, clock=clock, scale=None, over=over)


def with_given_courses(source: Source, between: Mapping[str, str], file: str) -> Source:
    """Source whose channels run between samples as the caller says by name.

    Raises
    ------
    ModelError
        There is no such channel, or no such course.
    """
    names, faults = [channel.name for channel in source.channels], list[Fault]()
    courses = dict[str, Between]()
    for name, given in between.items():
        try:
            courses[name] = check_between(given)
        except UsageError as error:
            faults.append(error.fault.under("channels", name))
        if name not in names:
            faults.append(unknown_name("channel", name, names, ("channels",)))
    if faults:
        raise ModelError(faults, file)
    channels = (
        replace(channel, between=courses[channel.name], course_rate=None) if channel.name in courses else channel
        for channel in source.channels
    )
    return replace(source, channels=tuple(channels))


def recordings(source: Source, options: ReadOptions, file: str, seconds: float | None = None) -> Iterator[Recording]:
    """Yield recordings of ``seconds`` each in SI, one after the other, or one of the whole file; raise ModelError."""
    pulses = stored_pulses(source, options.names, file)
    units = {name: unit for name, unit in options.units.items() if name not in options.readings}
    rest = replace(options, names=names_of_signals(source, options.names), units=units)
    if source.pulses and (not source.channels if rest.names is None else not rest.names):
        rate = options.sampling_rate or source.rate or rate_of(pulses)
        start = (
            source.start
            if source.rate
            else min((float(channel.times[0]) for channel in pulses if len(channel)), default=0.0)
        )
        yield Recording((), rate, start, None, source.title or file, source.notes, pulses)
        return
    yield from with_pulses(_sampled(source, rest, file, seconds), pulses)


def _sampled(source: Source, options: ReadOptions, file: str, seconds: float | None) -> Iterator[Recording]:
    """Yield recordings of the sampled channels, of ``seconds`` each."""
    stamps = source.time.name if source.time else ""
    units = {name: unit for name, unit in options.units.items() if name != stamps}
    choices, faults = choose(source, options.names, options.quantities, units)
    if stamps in options.units:
        text = f'{stamps} was taken for the time stamps, and "{options.units[stamps]}" is no unit of time'
        faults.append(Fault(text, kind="wrong-unit"))
    chosen = choose_rate(source, choices, options)
    every, whole, source, choices = choices, source, chosen.source, chosen.together
    # Channels of several rates differ in length: one of the two is said.
    faults += chosen.faults or length_faults(source, choices)
    has_axes = any(channel.rate or channel.clock or channel.over for channel in source.channels)
    if not chosen.faults and (choices or (source.channels and not has_axes)):
        faults += _rate_faults(source, options, choices)
    if faults:
        raise ModelError([*faults, *([Fault(source.hint, (), "note")] if source.hint and not has_axes else [])], file)
    source = _with_rate_note(source, options)
    others = read_others(whole, chosen, file)
    rate, done, begin = options.sampling_rate or source.rate, 0, 0.0
    count = 0 if seconds is None else max(1, round(seconds * (rate or _first_rate(source))))
    columns = [choice.channel.column for choice in choices]
    stamps_of = [source.time.column] if source.time else []
    for block in source.blocks([*columns, *stamps_of], count):
        source = source if done else _with_days(source, block[len(columns) :])
        clock = _clock(source, options, block[len(columns) :], rate, done, file, begin)
        rate, begin = rate or clock.rate, begin if done else clock.start
        record = _recording(source, choices, block, clock, file)
        done += len(block[0])
        if seconds is None or shares_time(record, others):
            yield with_others(record, chosen, every, others, file)
    if not done:
        raise ModelError([Fault("there are no samples in the file; export the record again", kind="too-short")], file)


def _rate_faults(source: Source, options: ReadOptions, choices: Sequence[ChannelChoice]) -> list[Fault]:
    if source.time is None and not options.sampling_rate and source.rate and not is_rate(source.rate):
        text = f"the file has a sampling rate of {source.rate:g} Hz, which no recorder has"
        return [Fault(f"{text}; give {remedy('sampling_rate=')} in Hz", kind="implausible-size")]
    if source.time is not None or options.sampling_rate or source.rate:
        return []
    advice = f"{unit_of_scale(choice.channel for choice in choices)}{remedy('sampling_rate=')} in Hz"
    return [Fault(f"nothing in the file tells the sampling rate; give {advice}", kind="missing-entry")]


def _with_rate_note(source: Source, options: ReadOptions) -> Source:
    """Source with a warning where the rate of the file is another than the one given, which is taken."""
    given, own = options.sampling_rate, source.rate
    if source.time is not None or not (given and own) or abs(given / own - 1) < SAME_RATE_TOLERANCE:
        return source
    note = warning(f"the file has a sampling rate of {own:g} Hz; the {given:g} Hz given were taken")
    return replace(source, notes=(*source.notes, note))


def _first_rate(source: Source) -> float:
    assert source.time is not None
    stamps = next(source.blocks([source.time.column], 1000))[0]
    span = float(stamps[-1] - stamps[0]) * seconds_in(clock_in_days(source.time, stamps)[0].unit)
    return (len(stamps) - 1) / span if span > 0 else 1.0


def _with_days(source: Source, stamps: Sequence[FloatArray]) -> Source:
    """Source whose time stamps are in days where they have no unit and are such numbers."""
    if source.time is None or not stamps:
        return source
    time, note = clock_in_days(source.time, stamps[0])
    return replace(source, time=time, notes=(*source.notes, *([note] if note else [])))


def _clock(
    source: Source,
    options: ReadOptions,
    stamps: Sequence[FloatArray],
    rate: float | None,
    done: int,
    file: str,
    begin: float,
) -> Clock:
    """Clock of a block that ``done`` samples come before, the first of them at the time ``begin`` in s."""
    if not stamps:
        assert rate is not None
        first, start = next((seam for seam in reversed(source.seams) if seam[0] <= done), (0, source.start))
        return Clock(rate, start + (done - first) / rate)
    assert source.time is not None
    scale, zero = seconds_in(source.time.unit), source.time.zero
    with np.errstate(over="ignore"):
        times = (stamps[0] - zero) * scale
    if options.sampling_rate and is_coarse(times):
        start = begin + done / options.sampling_rate if done else float(times[0])
        coarse = coarse_clock(times, options.sampling_rate, start)
        if isinstance(coarse, Fault):
            raise ModelError([coarse], file)
        source.discovered.append(warning("the time stamps are coarser than the sampling: the rate given was taken"))
        return coarse
    faults = value_faults(times, source, done)
    if faults:
        raise ModelError(faults, file)
    clock = clock_of(stamps[0], rate, stamped=source.stamped, scale=scale)
    if zero:
        clock = replace(clock, start=clock.start - zero * scale, times=None if clock.times is None else times)
    faults = order_faults(times, source, done) if clock.times is not None else []
    faults = faults or rate_fault(times, options.sampling_rate)
    if not faults and not options.sampling_rate:
        faults = interval_fault(times, source)
    if not faults and rate is None and len(times) == 1:
        faults = [
            Fault(
                f"one sample does not tell the sampling rate; give {remedy('sampling_rate=')} in Hz",
                kind="missing-entry",
            )
        ]
    if faults:
        raise ModelError(faults, file)
    if not source.stamped:
        source.discovered.extend(() if done else time_unit_warnings(times, source))
        source.discovered.extend(filter(None, [clock.note]))
        if source.rate and abs(source.rate / clock.rate - 1) >= SAME_RATE_TOLERANCE:
            text = f"the file has a sampling rate of {source.rate:g} Hz; that of its time stamps was taken, "
            source.discovered.append(warning(f"{text}{clock.rate:g} Hz"))
    return clock


def _recording(
    source: Source, choices: Sequence[ChannelChoice], block: Sequence[FloatArray], clock: Clock, file: str
) -> Recording:
    signals = tuple(_signal(choice, values) for choice, values in zip(choices, block, strict=False))
    faults = [fault for signal in signals for fault in _size_faults(signal)]
    if faults:
        raise ModelError(faults, file)
    title = source.title or file
    notes = dict.fromkeys([*source.notes, *source.discovered])
    return Recording(signals, clock.rate, clock.start, clock.times, title, tuple(notes))


def _size_faults(signal: Signal) -> list[Fault]:
    sizes = np.abs(signal.values)
    beyond = np.flatnonzero((sizes > LARGEST_SIZE) & np.isfinite(sizes))
    if not len(beyond):
        return []
    text = f"{signal.name} has the value {signal.values[beyond[0]]:g}, too large for a measurement; check its unit"
    return [Fault(text, ("channels", signal.name), kind="implausible-size")]


def _signal(choice: ChannelChoice, values: FloatArray) -> Signal:
    with np.errstate(over="ignore"):
        scaled = values if choice.factor == 1.0 else values * choice.factor
    samples, channel = np.asanyarray(scaled, dtype=float), choice.channel
    return Signal(choice.name, choice.quantity, samples, choice.notes, channel.between, channel.course_rate)


# Recordings of which some channels hold the pulses of incremental encoders.


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
    rest = replace(source, channels=channels, pulses=pulses, time=_clock_channel(source, options))
    units, quantities = (
        {name: word for name, word in given.items() if name not in options.pulses}
        for given in (options.units, options.quantities)
    )
    return next(recordings(rest, replace(options, names=names, quantities=quantities, units=units, pulses={}), file))


def _clock_channel(source: Source, options: ReadOptions) -> FileChannel | None:
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
            rest = replace(source, channels=(alone,), time=_clock_channel(source, options))
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
