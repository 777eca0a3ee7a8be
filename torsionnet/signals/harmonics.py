"""Harmonics of a signal in a sweep, amplitude and phase of multiples of the sweep's frequency along it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import UsageError
from torsionnet.signals.record_blocks import check_processable
from torsionnet.signals.recording import FloatArray, Recording


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
    fits = np.array([_fit(chosen[name].values, cycles, centre, orders, periods) for centre in centres])
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
    steps = 0.5 * (frequency[1:] + frequency[:-1]) / sampling_rate
    return np.concatenate([[0.0], np.cumsum(steps)])


def _checked(frequency: ArrayLike, count: int, points: int) -> FloatArray:
    values = np.asarray(frequency, dtype=np.float64)
    if values.shape != (count,) or not np.all(values > 0):
        raise UsageError(f"the sweep's frequency must be a positive number for each of the {count} samples")
    if points < 1:
        raise UsageError(f"at least one point along the sweep is needed, got {points}")
    return values


def _centres(cycles: FloatArray, periods: float, points: int) -> list[int]:
    first, last = np.searchsorted(cycles, [periods / 2, cycles[-1] - periods / 2])
    if last <= first:
        text = f"the sweep of {cycles[-1]:.3g} periods is too short for windows of {periods:g}"
        raise UsageError(f"{text}; take fewer periods")
    return [int(place) for place in np.unique(np.linspace(first, last - 1, points).round())]


def _fit(
    values: FloatArray, cycles: FloatArray, centre: int, orders: Sequence[float], periods: float
) -> np.ndarray[tuple[int], np.dtype[np.complex128]]:
    """Complex amplitude c of every order, as in ``Im(c exp(j order phase))``, in the signal's unit, (n_orders,)."""
    begin, end = np.searchsorted(cycles, cycles[centre] + np.array([-0.5, 0.5]) * periods)
    place = (cycles[begin:end] - cycles[centre]) / periods
    weight = np.cos(np.pi * place)
    angles = 2 * np.pi * np.outer(orders, cycles[begin:end])
    basis = np.vstack([np.sin(angles), np.cos(angles), np.ones_like(place), place])
    fit = np.linalg.lstsq((basis * weight).T, values[begin:end] * weight, rcond=None)[0]
    count = len(orders)
    return np.asarray(fit[:count] + 1j * fit[count : 2 * count], dtype=np.complex128)
