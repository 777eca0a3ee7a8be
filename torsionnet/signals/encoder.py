"""Incremental encoders: from counts or the times of pulses to an angle, wrap-around, missing pulses."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.errors import UsageError
from torsionnet.signals.recording import FloatArray, Signal

REVOLUTION = 2 * np.pi
NEIGHBOURS = 5


@dataclass(frozen=True, eq=False)
class MissingPulses:
    """Where an encoder lost pulses: after pulse ``after`` (counted from 0) so many as ``counts`` says."""

    after: NDArray[np.intp]
    counts: NDArray[np.intp]

    @property
    def total(self) -> int:
        return int(self.counts.sum())


def angle_from_counts(counts: ArrayLike, steps_per_revolution: float, bits: int | None = None) -> FloatArray:
    """Angle in rad from the counts of an encoder, without the wrap-around of a counter of so many bits.

    >>> angle_from_counts([254, 255, 0, 1], 4, bits=8).round(3).tolist()
    [398.982, 400.553, 402.124, 403.695]
    """
    if not steps_per_revolution > 0:
        msg = f"the steps per revolution must be a positive number, got {steps_per_revolution}"
        raise UsageError(msg)
    steps = np.asarray(counts, dtype=float)
    whole = steps if bits is None else np.unwrap(steps, period=2.0**bits)
    return whole * (REVOLUTION / steps_per_revolution)


def unwrapped(signal: Signal, period: float = REVOLUTION) -> Signal:
    """An angle without the jumps of an encoder that begins anew after ``period`` rad.

    >>> unwrapped(Signal("phi", "angle", np.array([6.0, 6.2, 0.1]))).values.round(3).tolist()
    [6.0, 6.2, 6.383]
    """
    if not period > 0:
        msg = f"the period must be a positive angle in rad, got {period}"
        raise UsageError(msg)
    values = np.unwrap(signal.values, period=period)
    return replace(signal, values=values, notes=(*signal.notes, f"wrap-around of {period:.6g} rad removed"))


def missing_pulses(times: ArrayLike) -> MissingPulses:
    """Find lost pulses: intervals that are a whole multiple of those around them.

    Parameters
    ----------
    times : (n,) array
        Time of every pulse, s. The speed may change, but by less than half between pulses.

    Examples
    --------
    >>> missing_pulses([0.0, 1.0, 2.0, 5.0, 6.0, 7.0, 8.0]).counts
    array([2])
    """
    intervals = np.diff(np.asarray(times, dtype=float))
    if len(intervals) < NEIGHBOURS:
        return MissingPulses(np.empty(0, np.intp), np.empty(0, np.intp))
    if not np.all(intervals > 0):
        msg = "the times of pulses must be finite and increase"
        raise UsageError(msg)
    missing = np.rint(intervals / _around(intervals)).astype(np.intp) - 1
    after = np.flatnonzero(missing > 0)
    return MissingPulses(after, missing[after])


def _around(values: FloatArray) -> FloatArray:
    """Median of every value and its neighbours."""
    half = NEIGHBOURS // 2
    wide = np.pad(values, half, mode="reflect")
    return np.asarray(np.median(np.lib.stride_tricks.sliding_window_view(wide, NEIGHBOURS), axis=-1))


def angle_from_pulses(
    times: ArrayLike, steps_per_revolution: float, sampling_rate: float, *, fill: bool = True
) -> tuple[FloatArray, float]:
    """Angle in rad at uniform times, straight between pulses, and the time of the first sample.

    Parameters
    ----------
    times : (n,) array
        Time of every pulse, s.
    steps_per_revolution, sampling_rate : float
    fill : bool
        Count the pulses that :func:`missing_pulses` finds.

    Examples
    --------
    >>> angle, start = angle_from_pulses(np.arange(9) / 8, 8, sampling_rate=2.0)
    >>> (angle / np.pi).round(9).tolist(), start
    ([0.0, 1.0, 2.0], 0.0)
    """
    stamps = np.asarray(times, dtype=float)
    if len(stamps) < 2 or not np.all(np.diff(stamps) > 0):  # noqa: PLR2004
        msg = "an angle needs at least two pulses, at finite times that increase"
        raise UsageError(msg)
    steps = np.ones(len(stamps) - 1)
    if fill:
        lost = missing_pulses(stamps)
        steps[lost.after] += lost.counts
    angle = angle_from_counts(np.concatenate([[0.0], np.cumsum(steps)]), steps_per_revolution)
    # A whole number of intervals may miss the last pulse by a rounding error, and would lose its sample.
    count = int(np.floor((stamps[-1] - stamps[0]) * sampling_rate + 1e-9)) + 1
    return np.interp(stamps[0] + np.arange(count) / sampling_rate, stamps, angle), float(stamps[0])
