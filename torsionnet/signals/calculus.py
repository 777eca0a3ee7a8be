"""Integration and differentiation of signals between angle, velocity and acceleration, in the frequency domain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal, TypeAlias, get_args

import numpy as np

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.signals.recording import FloatArray, Recording, Signal
from torsionnet.signals.resampling import check_processable

Ends: TypeAlias = Literal["mirror", "periodic"]
MOTION_QUANTITIES = ("angle", "velocity", "acceleration")
"""Names of the quantities of motion, each the time derivative of the one before, as integration needs their order."""


def convert(
    recording: Recording,
    name: str,
    quantity: str,
    *,
    ends: Ends = "mirror",
    lowest_frequency: float = 0.0,
    new_name: str = "",
) -> Recording:
    """Recording with one signal of motion integrated or differentiated to another quantity, in SI.

    Parameters
    ----------
    recording : Recording
    name : str
        A signal that is an angle, a velocity or an acceleration.
    quantity : {"angle", "velocity", "acceleration"}
    ends : {"mirror", "periodic"}, optional
        Continuation beyond the ends of the record. ``periodic``: repeated; exact if it holds whole periods.
        ``mirror``: the straight line from first to last value is treated separately, the rest reflected about its end
        points, which makes no step; the derivative is then inexact only in a few samples at the ends.
    lowest_frequency : float, optional
        Frequency in Hz below which the result is set to zero, as integration amplifies drift by 1/f.
    new_name : str, optional
        Name under which the result is added; by default it replaces the signal.

    Notes
    -----
    The constant of every integration is unknown: it is chosen so that the result has no mean. Periodic records of a
    velocity with a mean have no periodic angle: the mean is taken out first.

    Examples
    --------
    >>> time = np.arange(100) / 100
    >>> record = Recording((Signal("w", "velocity", np.cos(2 * np.pi * time)),), sampling_rate=100)
    >>> angle = convert(record, "w", "angle", ends="periodic")["w"]
    >>> angle.unit, bool(np.allclose(angle.values, np.sin(2 * np.pi * time) / (2 * np.pi)))
    ('rad', True)
    """
    chosen = recording.select([name])
    check_processable(chosen)
    signal = chosen[name]
    values, order = signal.values, _order(signal, quantity)
    _check_ends(ends)
    for _ in range(abs(order)):
        values = _changed(values, np.sign(order), recording.sampling_rate, ends, lowest_frequency)
    note = f"{quantity} from {signal.quantity} in the frequency domain, ends {ends}"
    note += f", nothing below {lowest_frequency:g} Hz" if lowest_frequency else ""
    return recording.with_signals(Signal(new_name or name, quantity, values, (*signal.notes, note)))


def _order(signal: Signal, quantity: str) -> int:
    if quantity not in MOTION_QUANTITIES:
        known = ", ".join(MOTION_QUANTITIES)
        raise UsageError(
            f'"{quantity}" is not a motion{did_you_mean(quantity, MOTION_QUANTITIES)}; there is {known}',
            kind="unknown-word",
        )
    return MOTION_QUANTITIES.index(quantity) - _place(signal.quantity, signal.name)


def _place(quantity: str, name: str) -> int:
    if quantity not in MOTION_QUANTITIES:
        raise UsageError(
            f"{name} is {quantity or 'of unknown quantity'}, not one of {', '.join(MOTION_QUANTITIES)}",
            kind="unfit-channel",
        )
    return MOTION_QUANTITIES.index(quantity)


def _check_ends(ends: str) -> None:
    if ends not in get_args(Ends):
        raise UsageError(f'ends are {" or ".join(get_args(Ends))}, got "{ends}"', kind="unknown-word")


def _changed(values: FloatArray, sign: int, rate: float, ends: Ends, lowest: float) -> FloatArray:
    """Time derivative of a signal (n,) for sign 1, or its time integral without mean for sign -1, in SI."""
    if ends == "periodic":
        return _spectrally(values, sign, rate, lowest)
    # Without the line between its ends, and mirrored oddly there, a signal is periodic without a step.
    slope = (values[-1] - values[0]) / (len(values) - 1)
    place = np.arange(len(values)) - (len(values) - 1) / 2
    line = 0.5 * (values[0] + values[-1]) + slope * place
    rest = values - line
    beyond = np.concatenate([rest, -rest[-2:0:-1]])
    changed = _spectrally(beyond, sign, rate, lowest)[: len(values)]
    if sign > 0:
        return np.asarray(changed + slope * rate)
    if not lowest:
        # The line's own integral, mean t + slope t^2/2.
        changed += (line.mean() * place + 0.5 * slope * place**2) / rate
    return np.asarray(changed - changed.mean())


def _spectrally(values: FloatArray, sign: int, rate: float, lowest: float) -> FloatArray:
    lines = np.fft.rfft(values)
    frequencies = np.fft.rfftfreq(len(values), 1 / rate)
    lines[(frequencies < lowest) | (frequencies == 0)] = 0
    if len(values) % 2 == 0:
        lines[-1] = 0  # at half the sampling rate the derivative is invisible between the samples
    lines[1:] *= (2j * np.pi * frequencies[1:]) ** float(sign)
    return np.asarray(np.fft.irfft(lines, len(values)), dtype=np.float64)


# Corrections of the channels of a record: gains, and delays, as filters and converters make them.


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
    signals = tuple(without_delay(signal, delays.get(signal.name, 0.0), recording.time) for signal in recording)
    pulses = tuple(
        replace(channel, times=channel.times - delays[channel.name]) if delays.get(channel.name) else channel
        for channel in recording.pulses
    )
    return replace(recording, signals=signals, pulses=pulses)
