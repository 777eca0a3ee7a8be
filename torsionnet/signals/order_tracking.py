"""Order maps of signals, complex amplitudes at multiples of the rotation over time and speed, by order tracking."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.errors import UsageError
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.signals.recording import FloatArray, Recording
from torsionnet.signals.resampling import check_processable

# Harmonics of a signal in a sweep, amplitude and phase of multiples of the sweep's frequency along it.


@dataclass(frozen=True, eq=False)
class Harmonics:
    """Amplitude and phase of a signal at multiples of the sweep's frequency, along the sweep, each (n, n_orders).

    Attributes
    ----------
    times, frequencies : (n,) array
        Times in s of the points along the sweep, and frequencies of the fundamental in Hz.
    orders : tuple of float
    amplitude : (n, n_orders) array
        Peak amplitudes, in the unit of the signal.
    phase : (n, n_orders) array
        Phases in degrees, of ``amplitude sin(order * sweep phase + phase)``; negative where the signal lags.
    name, unit : str
    """

    times: FloatArray
    frequencies: FloatArray
    orders: tuple[float, ...]
    amplitude: FloatArray
    phase: FloatArray
    name: str
    unit: str

    @property
    def distortion(self) -> FloatArray:
        """Amplitude of each order over that of the first order listed, without unit, (n, n_orders)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(self.amplitude / self.amplitude[:, :1])


def sweep_harmonics(
    recording: Recording,
    name: str,
    frequency: ArrayLike,
    orders: Sequence[float] = (1, 2, 3),
    *,
    periods: float = 6,
    points: int = 200,
) -> Harmonics:
    """Harmonics of a signal along a sweep, fitted together by weighted least squares over a few periods each.

    Fitting them together, with a mean and a slope, keeps a strong order from leaking into a weak one.

    Parameters
    ----------
    recording : Recording
    name : str
    frequency : (n,) array
        Instantaneous frequency of the fundamental at every sample, Hz, positive: as commanded or as measured.
    orders : sequence of float, optional
    periods : float, optional
        Periods of the fundamental, under a Hann window, that each point rests on.
    points : int, optional
        Points evenly spaced in time over what the windows leave.

    Examples
    --------
    >>> from torsionnet.signals.recording import Signal
    >>> time = np.arange(5000) / 500
    >>> sweep = 2 * np.pi * (5 * time + 0.5 * time**2)
    >>> record = Recording((Signal("T", "torque", 10 * np.sin(sweep) + 0.5 * np.sin(2 * sweep)),), sampling_rate=500)
    >>> sweep_harmonics(record, "T", 5 + time, points=3).amplitude[1].round(3).tolist()
    [10.0, 0.5, 0.0]
    """
    chosen = recording.select([name])
    check_processable(chosen)
    instantaneous = _checked(frequency, len(chosen), points)
    cycles = sweep_cycles(instantaneous, chosen.sampling_rate)
    centres = _centres(cycles, periods, points)
    # All orders at once by weighted least squares over some periods around each centre: none leaks into another.
    fits = np.array([_fitted_amplitudes(chosen[name].values, cycles, centre, orders, periods) for centre in centres])
    return Harmonics(
        times=chosen.time[centres],
        frequencies=instantaneous[centres],
        orders=tuple(orders),
        amplitude=np.abs(fits),
        phase=np.degrees(np.angle(fits)),
        name=name,
        unit=chosen[name].unit,
    )


def sweep_cycles(frequency: FloatArray, sampling_rate: float) -> FloatArray:
    """Number of cycles since the first sample at every sample, (n,), from the frequency in Hz at every sample."""
    # The trapezoidal rule is exact for a frequency that is straight between samples.
    steps = 0.5 * (frequency[1:] + frequency[:-1]) / sampling_rate
    return np.concatenate([[0.0], np.cumsum(steps)])


def _checked(frequency: ArrayLike, count: int, points: int) -> FloatArray:
    values = np.asarray(frequency, dtype=np.float64)
    if values.shape != (count,) or not np.all(values > 0):
        raise UsageError(
            f"the sweep's frequency must be a positive number for each of the {count} samples", kind="out-of-range"
        )
    if points < 1:
        raise UsageError(f"at least one point along the sweep is needed, got {points}", kind="out-of-range")
    return values


def _centres(cycles: FloatArray, periods: float, points: int) -> list[int]:
    # Half a window has to fit on either side of every point.
    first, last = np.searchsorted(cycles, [periods / 2, cycles[-1] - periods / 2])
    if last <= first:
        text = f"the sweep of {cycles[-1]:.3g} periods is too short for windows of {periods:g}"
        raise UsageError(f"{text}; take fewer periods", kind="too-short")
    return [int(place) for place in np.unique(np.linspace(first, last - 1, points).round())]


def _fitted_amplitudes(
    values: FloatArray, cycles: FloatArray, centre: int, orders: Sequence[float], periods: float
) -> np.ndarray[tuple[int], np.dtype[np.complex128]]:
    """Complex amplitude c of every order, as in ``Im(c exp(j order phase))``, in the signal's unit, (n_orders,)."""
    begin, end = np.searchsorted(cycles, cycles[centre] + np.array([-0.5, 0.5]) * periods)
    # The cosine is the root of a Hann window, so that the squares of the residuals have the window itself as weight.
    place = (cycles[begin:end] - cycles[centre]) / periods
    weight = np.cos(np.pi * place)
    angles = 2 * np.pi * np.outer(orders, cycles[begin:end])
    # Mean and slope are fitted as well: a drift would else leak into low orders.
    basis = np.vstack([np.sin(angles), np.cos(angles), np.ones_like(place), place])
    fit = np.linalg.lstsq((basis * weight).T, values[begin:end] * weight, rcond=None)[0]
    count = len(orders)
    # a sin + b cos = Im((a + j b) exp(j angle))
    return np.asarray(fit[:count] + 1j * fit[count : 2 * count], dtype=np.complex128)


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
    highest_order: float = 10,
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
    highest_order : float, optional
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
    per_turn = _samples_per_turn(rotation, turns, chosen.sampling_rate, highest_order)
    # At equal steps of angle an order is a line, whatever the speed does.
    count = int(turns[-1] * per_turn) + 1
    equal = np.arange(count) / per_turn
    length, step = revolutions * per_turn, max(1, round(revolutions * per_turn * (1 - overlap)))
    if count < length:
        text = f"the record of {turns[-1]:.3g} revolutions is too short for one window of {revolutions}"
        raise UsageError(f"{text}; take fewer revolutions", kind="too-short")
    times = np.interp(equal, turns, chosen.time)
    starts = np.arange(0, count - length + 1, step)
    orders = np.arange(int(highest_order * revolutions) + 1) / revolutions
    values = _lines(_at(times, chosen, name), starts, length, orders / per_turn)
    # The mean speed of a window is its angle over its time.
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
        raise UsageError(
            f"the speed must be a positive number of rad/s for each of the {count} samples", kind="out-of-range"
        )
    return values / (2 * np.pi)


def _samples_per_turn(rotation: FloatArray, turns: FloatArray, sampling_rate: float, highest: float) -> int:
    # As fine in angle as the samples are in time where the shaft is slowest; 2.5 of them a period of the highest order.
    per_turn = int(np.ceil(max(sampling_rate / rotation.min(), 2.5 * highest)))
    if per_turn * turns[-1] > MOST_ANGLE_SAMPLES:
        raise UsageError(
            f"the lowest speed, {rotation.min() * 60:.3g} rpm, makes the steps of angle too fine; cut the record "
            "where the speed is higher",
            kind="out-of-range",
        )
    return per_turn


def _at(times: FloatArray, recording: Recording, name: str) -> FloatArray:
    from scipy.interpolate import CubicSpline

    return np.asarray(CubicSpline(recording.time, recording[name].values)(times), dtype=np.float64)


def _lines(values: FloatArray, starts: NDArray[np.intp], length: int, cycles: FloatArray) -> ComplexArray:
    """Complex peak amplitudes of lines with so many cycles a sample, (n_lines, n_starts), in the values' unit."""
    # Hann window; twice the line over the sum of its weights is the amplitude, once of the mean.
    weights = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(length) / length)
    scale = np.full(len(cycles), 2 / weights.sum())
    scale[0] /= 2
    lines = (np.fft.rfft(values[begin : begin + length] * weights)[: len(cycles)] for begin in starts)
    # Phases at the beginning of the record, not of each block.
    turned = np.exp(-2j * np.pi * np.outer(cycles, starts))
    return np.asarray(np.array([line * scale for line in lines]).T * turned)
