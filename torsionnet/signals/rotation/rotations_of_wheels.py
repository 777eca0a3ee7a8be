"""Rotations of all wheels of a record, from the channels of their pulses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import gcd

import numpy as np

from torsionnet.base.errors import Fault, ModelError, UsageError
from torsionnet.base.notes import warning
from torsionnet.signals.recording import FloatArray, Recording, Signal
from torsionnet.signals.resampling import even_times
from torsionnet.signals.rotation.counter import PulseReading
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.wheel import Wheel, WheelPattern
from torsionnet.signals.rotation.wheel_channel import WheelChannel, counted_reading, wheel_pulses
from torsionnet.signals.rotation.wheel_rotation import WheelRotation, wheel_rotation


def rotations_of_wheels(
    recording: Recording,
    wheels: Mapping[str, WheelChannel],
    patterns: Mapping[str, WheelPattern] | None = None,
    *,
    marks: Mapping[str, PulseReading] | None = None,
    index: str = "",
) -> dict[str, WheelRotation]:
    """Rotation of the reference shaft in rad as each wheel of a record shows it, by the channel of its pulses.

    Parameters
    ----------
    recording : Recording
        Record with the pulses of the wheels or the signals of their teeth.
    wheels : mapping of str to WheelChannel
    patterns : mapping of str to WheelPattern, optional
        Pitch patterns of the wheels that have one, which are removed.
    marks : mapping of str to PulseReading, optional
        How channels of index pulses are read; those left out are read with the counter of their wheel.
    index : str, optional
        Index pulse of the reference shaft: that of wheels which turn as fast and have neither gap nor index.

    Raises
    ------
    ModelError
        Channels that hold no pulses, or pulses that do not fit their wheel; of all wheels at once.

    Examples
    --------
    >>> import numpy as np
    >>> from torsionnet.signals import PulseChannel
    >>> record = Recording((), 600.0, pulses=(PulseChannel("n1", np.arange(600) / 600),))
    >>> print(f"{rotations_of_wheels(record, {'n1': WheelChannel(teeth=60)})['n1'].revolutions:.3f}")
    9.983
    """
    rotations: dict[str, WheelRotation] = {}
    faults: list[Fault] = []
    for name, wheel in wheels.items():
        try:
            mark = wheel.index or (index if index != name and wheel.ratio == 1 and not wheel.shows_tooth_0 else "")
            reading = (marks or {}).get(mark) or counted_reading(wheel)
            pulses = wheel_pulses(recording, mark, reading) if mark else None
            pattern = (patterns or {}).get(name)
            rotations[name] = wheel_rotation(wheel_pulses(recording, name, wheel), wheel, pattern, index=pulses)
        except UsageError as error:
            faults.append(error.fault)
    if faults:
        raise ModelError(faults, recording.title or "record")
    return rotations


# Rotation of a shaft from long trains of pulses, block by block, so that the memory does not grow with the record.

PULSES_PER_BLOCK = 200_000
"""Number of pulses of a block, some minutes of a usual wheel, for which about 50 MB are needed."""
OVERLAP = 200
"""Number of pulses that blocks share on either side, after which the error of their ends is below 1e-6."""


@dataclass(frozen=True, eq=False)
class RotationBlock:
    """Rotation over a part of a record, to be used from ``start`` up to ``stop``, times in s."""

    rotation: WheelRotation
    start: float
    stop: float


def iter_wheel_rotations(
    channel: PulseChannel,
    wheel: Wheel,
    pattern: WheelPattern | None = None,
    *,
    index: PulseChannel | None = None,
    first: int | None = None,
    pulses_per_block: int = PULSES_PER_BLOCK,
) -> Iterator[RotationBlock]:
    """Yield the rotation of the reference shaft over parts of a record, which meet in time; angles go on across them.

    The first block tells tooth 0, as :func:`wheel_rotation` does for the whole; the others count on from it.

    Parameters
    ----------
    channel, wheel, pattern, index, first
        As of :func:`wheel_rotation`.
    pulses_per_block : int
        Number of pulses of a block, beside those that it shares with its neighbours.

    Examples
    --------
    >>> channel = PulseChannel("n1", np.arange(3000) / 600)
    >>> blocks = list(iter_wheel_rotations(channel, Wheel(teeth=60), pulses_per_block=1000))
    >>> [(round(block.start, 3), round(block.stop, 3)) for block in blocks]
    [(0.0, 1.667), (1.667, 3.333), (3.333, 4.998)]
    >>> [round(float(block.rotation.angle(np.array([block.stop]))[0] / (2 * np.pi)), 3) for block in blocks]
    [16.667, 33.333, 49.983]
    """
    times, begin, before = channel.times, 0, None
    start = float(times[0])
    while True:
        end = begin + pulses_per_block + (OVERLAP if before is None else 2 * OVERLAP)
        last = len(times) - end < pulses_per_block // 2
        part = replace(channel, times=times[begin : None if last else end])
        if before is None:
            rotation = wheel_rotation(part, wheel, pattern, index=index, first=first)
        else:
            # The first pulse of a part is in the overlap: its tooth is that which the part before has counted.
            number = int(before.numbers[np.searchsorted(before.times, times[begin])])
            counted = wheel_rotation(part, wheel, pattern, first=number % wheel.teeth)
            rotation = replace(counted, numbers=counted.numbers + (number - number % wheel.teeth), zero=before.zero)
        stop = float(rotation.times[-1] if last else rotation.times[-OVERLAP])
        yield RotationBlock(rotation, start, stop)
        if last:
            return
        start, before = stop, rotation
        begin = int(np.searchsorted(times, rotation.times[-2 * OVERLAP]))


# Record of angle, speed and uncertainty of wheels, at the times of channels kept or at the rate of the pulses.

SPEED_TOLERANCE = 1e-3
"""Relative difference of the turns of the reference shaft that two wheels show above which one of them is not as given:
more than vibration makes over a record, less than one tooth of a thousand."""


def angle_record(
    recording: Recording,
    wheels: Sequence[WheelRotation],
    *,
    keep: Sequence[str] = (),
    sampling_rate: float | None = None,
) -> Recording:
    """Recording with angle in rad, speed in rad/s and standard deviation of the angle in rad for every wheel.

    Parameters
    ----------
    recording : Recording
        Record that the pulses are from.
    wheels : sequence of WheelRotation
    keep : sequence of str
        Signals of the record that are kept, at whose times the angles are then; by default none.
    sampling_rate : float, optional
        Sampling rate in Hz where no signals are kept; by default that of the fastest pulses.

    Raises
    ------
    UsageError
        The wheels have no time in common.

    Examples
    --------
    >>> from torsionnet.signals.rotation.pulse_channel import PulseChannel
    >>> from torsionnet.signals.rotation.wheel import Wheel
    >>> from torsionnet.signals.rotation.wheel_rotation import wheel_rotation
    >>> wheel = wheel_rotation(PulseChannel("n1", np.arange(600) / 600), Wheel(teeth=60))
    >>> angle_record(Recording((), 600.0), [wheel]).names
    ('n1 angle', 'n1 speed', 'n1 angle deviation')
    """
    first, last = max(wheel.times[0] for wheel in wheels), min(wheel.times[-1] for wheel in wheels)
    if not last > first:
        spans = "; ".join(f"{wheel.name} from {wheel.times[0]:.6g} to {wheel.times[-1]:.6g} s" for wheel in wheels)
        raise UsageError(f"the pulses have no time in common: {spans}", kind="unlike-results")
    kept = recording.select(keep) if keep else replace(recording, signals=(), times=None)
    notes = list(recording.notes)
    if keep:
        times = kept.time
        inside = (times >= first) & (times <= last)
        if not inside.any():
            raise UsageError(
                f"no sample of {keep[0]} lies between first and last pulse, {first:.6g} and {last:.6g} s",
                kind="unlike-results",
            )
        if not inside.all():
            notes.append(f"cut to where there are pulses: from {times[inside][0]:.6g} to {times[inside][-1]:.6g} s")
        times = times[inside]
        signals = tuple(replace(signal, values=signal.values[inside]) for signal in kept)
        stamps = None if kept.times is None else times
        kept = replace(kept, signals=signals, start=float(times[0]), times=stamps)
    else:
        # With no signals to go by, samples are as close as the closest pulses.
        rate = sampling_rate or max(float(np.ceil(1 / np.diff(wheel.times).min())) for wheel in wheels)
        times = even_times(float(first), float(last), rate, max(len(wheel.times) for wheel in wheels), "pulses")
        kept = replace(kept, sampling_rate=rate, start=float(first))
    notes += [warning(text) for text in (*_unequal(wheels, first, last), *_coarse(wheels, kept.sampling_rate))]
    made = tuple(signal for wheel in wheels for signal in _signals(wheel, times))
    return replace(kept, signals=(*kept.signals, *made), notes=tuple(notes))


def _signals(wheel: WheelRotation, times: FloatArray) -> tuple[Signal, Signal, Signal]:
    origin = (f"from {len(wheel.times)} pulses of {wheel.wheel.teeth} teeth, 0 at {wheel.zero}", *wheel.remarks)
    deviation = np.interp(times, wheel.times, wheel.angle_deviation)
    return (
        Signal(f"{wheel.name} angle", "angle", wheel.angle(times), origin),
        Signal(f"{wheel.name} speed", "velocity", wheel.speed(times), origin),
        Signal(
            f"{wheel.name} angle deviation", "angle", deviation, ("standard deviation that counter and teeth leave",)
        ),
    )


def _unequal(wheels: Sequence[WheelRotation], first: float, last: float) -> list[str]:
    """Remarks on wheels that show other turns of the reference shaft than the first one."""
    ends = np.array([first, last])
    turns = [abs(float(np.diff(wheel.angle(ends))[0])) / (2 * np.pi) for wheel in wheels]
    return [
        f"{wheel.name} shows {count:.4f} turns of the reference shaft, {wheels[0].name} {turns[0]:.4f}: the teeth or "
        "the ratio of one are wrong, or something between them slips"
        for wheel, count in zip(wheels[1:], turns[1:], strict=True)
        if abs(count - turns[0]) > SPEED_TOLERANCE * turns[0] + 1
    ]


def _coarse(wheels: Sequence[WheelRotation], rate: float) -> list[str]:
    """Remarks on wheels of which the teeth tell higher orders than the samples hold."""
    remarks = []
    for wheel in wheels:
        fastest = float(np.abs(wheel.speeds).max()) / (2 * np.pi)
        held = rate / (2 * fastest)
        if held < wheel.highest_order:
            remarks.append(
                f"{wheel.name}: {rate:g} Hz hold orders up to {held:.3g} at {60 * fastest:.4g} rpm, and higher ones "
                f"alias: the teeth tell up to {wheel.highest_order:.3g}"
            )
    return remarks


# Tooth numbers on a wheel without gap, from a second wheel on the same shaft with another number of teeth.

LARGEST_SHARE = 0.25
"""Largest distance of the phase seen from that of a tooth, in shares of the step between neighbouring phases, half of
what would fit the next tooth as well."""


def phase_between(first: WheelRotation, second: WheelRotation) -> float:
    """Share of a pitch of the second wheel that has passed when tooth 0 of the first passes, from 0 to 1.

    It is what :func:`tooth_by_difference` needs of a record in which tooth 0 is known, as by an index pulse.

    Raises
    ------
    UsageError
        The wheels do not turn together.
    """
    shares = _tooth_phases(first, second, 0)
    return float(np.angle(np.exp(2j * np.pi * shares).mean()) / (2 * np.pi) % 1)


def tooth_by_difference(first: WheelRotation, second: WheelRotation, phase: float) -> int:
    """Tooth of the first pulse of a wheel, counted from its tooth 0, by a wheel of another number of teeth beside it.

    When tooth k of z1 passes, the phase of z2 teeth is ``phase`` + k z2/z1: without a common divisor it is another at
    each tooth, so that their difference is an absolute position, as on a vernier.

    Parameters
    ----------
    first, second : WheelRotation
        On one shaft, over a common time.
    phase : float
        As of :func:`phase_between`, in shares of a pitch of the second wheel.

    Raises
    ------
    UsageError
        The counts have a common divisor, the wheels do not turn together, or two teeth fit about as well.
    """
    teeth, others = first.wheel.teeth, second.wheel.teeth
    if gcd(teeth, others) > 1:
        raise UsageError(
            f"{first.name} and {second.name}: {teeth} and {others} teeth have the common divisor {gcd(teeth, others)}, "
            "so that their difference returns within a turn; take counts without one, as 60 and 61",
            kind="contradicting-values",
        )
    shares = _tooth_phases(first, second, int(first.numbers[0]))
    # The phase goes on by n_2/n_1 of a pitch per tooth: all differ where the numbers have no common divisor.
    seen = np.exp(2j * np.pi * shares).mean()
    expected = np.exp(2j * np.pi * (phase + np.arange(teeth) * others / teeth))
    away = np.abs(np.angle(seen * expected.conj())) / (2 * np.pi) * teeth
    best = int(away.argmin())
    if away[best] > LARGEST_SHARE:
        raise UsageError(
            f"{first.name} and {second.name}: the phase of the two is {away[best]:.2f} of a step beside tooth {best}, "
            "and the next tooth fits about as well: the phase is from another assembly, or errors of the teeth are "
            "larger than a quarter of a step",
            kind="ambiguous-tooth",
        )
    return best


def _tooth_phases(first: WheelRotation, second: WheelRotation, number: int) -> FloatArray:
    """Phases of the second wheel at whole turns of the first after its tooth ``number``, in shares of a pitch (n,)."""
    inside = (first.times >= second.times[0]) & (first.times <= second.times[-1])
    times, numbers = first.times[inside], first.numbers[inside] - number
    if len(times) < 2:
        raise UsageError(f"{first.name} and {second.name} have no time in common", kind="unlike-results")
    # Less n_2/n_1 pitches for each tooth the phase is constant.
    pitches = second.rotation.at(times) - numbers * second.wheel.teeth / first.wheel.teeth
    if np.ptp(pitches) > 1:
        raise UsageError(
            f"{first.name} and {second.name}: their teeth drift apart by {np.ptp(pitches):.2f} pitches: they are not "
            "on one shaft, or their numbers of teeth are wrong",
            kind="unfit-wheel",
        )
    return np.asarray(pitches % 1)
