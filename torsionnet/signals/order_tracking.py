"""Order maps of signals, complex amplitudes at multiples of the rotation over time and speed, by order tracking."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.errors import UsageError
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.signals.harmonics import sweep_cycles
from torsionnet.signals.record_blocks import check_processable
from torsionnet.signals.recording import FloatArray, Recording

MOST_ANGLE_SAMPLES = 20_000_000
"""Largest number of samples at equal steps of angle, as more would take too much memory."""


@dataclass(frozen=True, eq=False)
class OrderMap:
    """Amplitude (n_o, n_t) of a signal over order and time, with the mean speed at each time.

    Attributes
    ----------
    orders : (n_o,) array
        Multiples of the rotation.
    times : (n_t,) array
        Middle of each window, s.
    speeds : (n_t,) array
        Mean speed of each window, rad/s.
    amplitude : (n_o, n_t) array
        Peak amplitude of a sine that would give this line, in the unit of the signal.
    name, unit : str
    values : (n_o, n_t) complex array, optional
        Complex peak amplitudes X of Re X exp(j o phi), where phi is the angle turned since the begin of the record.
    """

    orders: FloatArray
    times: FloatArray
    speeds: FloatArray
    amplitude: FloatArray
    name: str
    unit: str
    values: ComplexArray | None = None

    def along(self, order: float) -> FloatArray:
        """Peak amplitude of the line nearest to one order at each time, (n_t,), in the signal's unit."""
        return np.asarray(self.amplitude[np.abs(self.orders - order).argmin()])


def order_map(
    recording: Recording,
    name: str,
    speed: ArrayLike,
    *,
    highest: float = 10,
    revolutions: int = 8,
    overlap: float = 0.75,
) -> OrderMap:
    """Order map of a signal from spectra over whole revolutions, the signal resampled at equal steps of angle.

    The steps are as fine as the time samples at the lowest speed, so that nothing aliases; windows are Hann's.

    Parameters
    ----------
    recording : Recording
    name : str
    speed : (n,) array
        Speed of the shaft whose orders are wanted, at every sample, rad/s, positive.
    highest : float, optional
        Highest order kept.
    revolutions : int, optional
        Length of a window; the orders are ``1 / revolutions`` apart.
    overlap : float, optional

    Raises
    ------
    UsageError
        The record is too short, the speed is not positive, or the lowest speed makes the steps too fine to store;
        leave the start of the run-up out then.

    Examples
    --------
    >>> from torsionnet.signals.recording import Signal
    >>> time = np.arange(20_000) / 1000
    >>> turns = 10 * time + time**2
    >>> record = Recording((Signal("T", "torque", 3 * np.sin(2 * np.pi * 2 * turns)),), sampling_rate=1000)
    >>> order_map(record, "T", 2 * np.pi * (10 + 2 * time)).along(2).round(2)[[0, -1]].tolist()
    [3.0, 3.0]
    """
    chosen = recording.select([name])
    check_processable(chosen)
    rotation = _rotation(speed, len(chosen))
    turns = sweep_cycles(rotation, chosen.sampling_rate)
    per_turn = _samples_per_turn(rotation, turns, chosen.sampling_rate, highest)
    count = int(turns[-1] * per_turn) + 1
    equal = np.arange(count) / per_turn
    length, step = revolutions * per_turn, max(1, round(revolutions * per_turn * (1 - overlap)))
    if count < length:
        text = f"the record of {turns[-1]:.3g} revolutions is too short for one window of {revolutions}"
        raise UsageError(f"{text}; take fewer revolutions")
    times = np.interp(equal, turns, chosen.time)
    starts = np.arange(0, count - length + 1, step)
    orders = np.arange(int(highest * revolutions) + 1) / revolutions
    values = _lines(_at(times, chosen, name), starts, length, orders / per_turn)
    middles, ends = starts + length // 2, np.minimum(starts + length, count - 1)
    return OrderMap(
        orders=orders,
        times=times[middles],
        speeds=2 * np.pi * (equal[ends] - equal[starts]) / (times[ends] - times[starts]),
        amplitude=np.abs(values),
        name=name,
        unit=chosen[name].unit,
        values=values,
    )


def _rotation(speed: ArrayLike, count: int) -> FloatArray:
    values = np.asarray(speed, dtype=np.float64)
    if values.shape != (count,) or not np.all(values > 0):
        raise UsageError(f"the speed must be a positive number of rad/s for each of the {count} samples")
    return values / (2 * np.pi)


def _samples_per_turn(rotation: FloatArray, turns: FloatArray, sampling_rate: float, highest: float) -> int:
    per_turn = int(np.ceil(max(sampling_rate / rotation.min(), 2.5 * highest)))
    if per_turn * turns[-1] > MOST_ANGLE_SAMPLES:
        raise UsageError(
            f"the lowest speed, {rotation.min() * 60:.3g} rpm, makes the steps of angle too fine; cut the record "
            "where the speed is higher"
        )
    return per_turn


def _at(times: FloatArray, recording: Recording, name: str) -> FloatArray:
    from scipy.interpolate import CubicSpline

    return np.asarray(CubicSpline(recording.time, recording[name].values)(times), dtype=np.float64)


def _lines(values: FloatArray, starts: NDArray[np.intp], length: int, cycles: FloatArray) -> ComplexArray:
    """Complex peak amplitudes of lines with so many cycles a sample, (n_lines, n_starts), in the values' unit."""
    weights = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(length) / length)
    scale = np.full(len(cycles), 2 / weights.sum())
    scale[0] /= 2
    lines = (np.fft.rfft(values[begin : begin + length] * weights)[: len(cycles)] for begin in starts)
    turned = np.exp(-2j * np.pi * np.outer(cycles, starts))
    return np.asarray(np.array([line * scale for line in lines]).T * turned)
