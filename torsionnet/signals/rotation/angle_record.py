"""Record of angle, speed and uncertainty of wheels, at the times of channels kept or at the rate of the pulses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import warning
from torsionnet.signals.recording import FloatArray, Recording, Signal
from torsionnet.signals.rotation.wheel_rotation import WheelRotation
from torsionnet.signals.sample_counts import even_times

SPEED_TOLERANCE = 1e-3
"""Relative difference of the turns of the reference shaft that two wheels show above which one of them is not as given:
more than vibration makes over a record, less than one tooth of a thousand."""


def angle_record(
    record: Recording, wheels: Sequence[WheelRotation], *, keep: Sequence[str] = (), sampling_rate: float | None = None
) -> Recording:
    """Recording with angle in rad, speed in rad/s and standard deviation of the angle in rad for every wheel.

    Parameters
    ----------
    record : Recording
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
    first, last = max(one.times[0] for one in wheels), min(one.times[-1] for one in wheels)
    if not last > first:
        spans = "; ".join(f"{one.name} from {one.times[0]:.6g} to {one.times[-1]:.6g} s" for one in wheels)
        raise UsageError(f"the pulses have no time in common: {spans}")
    kept = record.select(keep) if keep else replace(record, signals=(), times=None)
    notes = list(record.notes)
    if keep:
        times = kept.time
        inside = (times >= first) & (times <= last)
        if not inside.any():
            raise UsageError(f"no sample of {keep[0]} lies between first and last pulse, {first:.6g} and {last:.6g} s")
        if not inside.all():
            notes.append(f"cut to where there are pulses: from {times[inside][0]:.6g} to {times[inside][-1]:.6g} s")
        times = times[inside]
        signals = tuple(replace(one, values=one.values[inside]) for one in kept)
        stamps = None if kept.times is None else times
        kept = replace(kept, signals=signals, start=float(times[0]), times=stamps)
    else:
        rate = sampling_rate or max(float(np.ceil(1 / np.diff(one.times).min())) for one in wheels)
        times = even_times(float(first), float(last), rate, max(len(one.times) for one in wheels), "pulses")
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
    turns = [abs(float(np.diff(one.angle(ends))[0])) / (2 * np.pi) for one in wheels]
    return [
        f"{one.name} shows {count:.4f} turns of the reference shaft, {wheels[0].name} {turns[0]:.4f}: the teeth or the "
        "ratio of one are wrong, or something between them slips"
        for one, count in zip(wheels[1:], turns[1:], strict=True)
        if abs(count - turns[0]) > SPEED_TOLERANCE * turns[0] + 1
    ]


def _coarse(wheels: Sequence[WheelRotation], rate: float) -> list[str]:
    """Remarks on wheels of which the teeth tell higher orders than the samples hold."""
    found = []
    for one in wheels:
        fastest = float(np.abs(one.speeds).max()) / (2 * np.pi)
        held = rate / (2 * fastest)
        if held < one.highest_order:
            found.append(
                f"{one.name}: {rate:g} Hz hold orders up to {held:.3g} at {60 * fastest:.4g} rpm, and higher ones "
                f"alias: the teeth tell up to {one.highest_order:.3g}"
            )
    return found
