"""Corrections of the channels of a record: gains, and delays, as filters and converters make them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from torsionnet.signals.recording import FloatArray, Recording, Signal


def with_gain(signal: Signal, gain: float) -> Signal:
    """Signal multiplied by the gain of its channel, with a note where that is not 1."""
    if gain == 1:
        return signal
    return replace(signal, values=gain * signal.values, notes=(*signal.notes, f"multiplied by {gain:g}"))


def without_delay(signal: Signal, delay: float, time: FloatArray) -> Signal:
    """Signal without a delay in s, at the times (n,) in s of its record, by splines between its samples.

    Examples
    --------
    >>> time = np.arange(100) / 100
    >>> late = Signal("T", "torque", np.sin(6 * (time - 0.004)))
    >>> bool(np.abs(without_delay(late, 0.004, time).values - np.sin(6 * time))[:-1].max() < 1e-6)
    True
    """
    if not delay:
        return signal
    from scipy.interpolate import CubicSpline

    # Beyond the last sample nothing is known: its value goes on for the time of the delay.
    values = CubicSpline(time, signal.values)(np.clip(time + delay, time[0], time[-1]))
    note = f"shifted {1e3 * delay:g} ms to earlier times"
    return replace(signal, values=np.asarray(values, dtype=np.float64), notes=(*signal.notes, note))


def without_delays(recording: Recording, delays: Mapping[str, float]) -> Recording:
    """Recording whose signals and pulses are without the delays in s, by the name of their channel."""
    signals = tuple(without_delay(one, delays.get(one.name, 0.0), recording.time) for one in recording)
    pulses = tuple(
        replace(one, times=one.times - delays[one.name]) if delays.get(one.name) else one for one in recording.pulses
    )
    return replace(recording, signals=signals, pulses=pulses)
