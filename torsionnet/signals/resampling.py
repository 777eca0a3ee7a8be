"""Resampling of recordings with non-uniform time stamps to a uniform sampling rate."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from torsionnet.core.errors import UsageError
from torsionnet.response.recording import FloatArray, Recording, Signal
from torsionnet.signals.sample_counts import even_times
from torsionnet.signals.timing import gaps

LEAST_RATE_SHARE = 0.99
"""Least new rate as a share of a recording's mean rate, below 1 only by rounding, as a lower one needs an anti-alias
filter."""


def resampled(recording: Recording, rate: float | None = None, *, bridge_gaps: bool = False) -> Recording:
    """Recording resampled to a uniform rate (Hz) by cubic splines through its samples.

    Parameters
    ----------
    recording : Recording
    rate : float, optional
        New rate in Hz, by default the mean rate. Not lower than that: fewer samples need an anti-alias filter first.
    bridge_gaps : bool
        Draw the spline across gaps in the time stamps, which invents data there.

    Raises
    ------
    UsageError
        The rate is too low or far too high, values are not finite, or there are gaps.

    Examples
    --------
    >>> times = np.array([0.0, 0.9, 2.1, 3.0])
    >>> record = Recording((Signal("phi", "angle", 2 * times),), 1.0, times=times)
    >>> resampled(record)["phi"].values.round(9).tolist()
    [0.0, 2.0, 4.0, 6.0]
    """
    new = recording.sampling_rate if rate is None else rate
    if recording.times is None and new == recording.sampling_rate:
        return recording
    _check(recording, new, bridge_gaps)
    time = recording.time
    even = even_times(float(time[0]), float(time[-1]), new, len(time), "samples")
    signals = tuple(_resampled(signal, time, even) for signal in recording)
    note = f"resampled to {new:g} Hz by cubic splines"
    return replace(recording, signals=signals, sampling_rate=new, start=float(time[0]), times=None).with_notes(note)


def _resampled(signal: Signal, time: FloatArray, even: FloatArray) -> Signal:
    from scipy.interpolate import CubicSpline

    return replace(signal, values=np.asarray(CubicSpline(time, signal.values)(even), dtype=float))


def _check(recording: Recording, rate: float, bridge_gaps: bool) -> None:
    if not (np.isfinite(rate) and rate >= LEAST_RATE_SHARE * recording.sampling_rate):
        raise UsageError(
            f"cannot resample {recording.sampling_rate:g} Hz to {rate:g} Hz: decimate with a filter instead"
        )
    if len(recording) < 2 or not np.all(np.diff(recording.time) > 0):
        raise UsageError("resampling needs at least two samples, and time stamps that increase")
    broken = [signal.name for signal in recording if not np.all(np.isfinite(signal.values))]
    if broken:
        raise UsageError(
            f"cannot resample {', '.join(broken)}: some values are not finite; cut them out or mend them first"
        )
    found = gaps(recording.time)
    if len(found) and not bridge_gaps:
        where = ", ".join(f"{recording.time[at]:.6g} s" for at in found[:3])
        raise UsageError(
            f"cannot resample across {len(found)} gaps (after {where}); cut the record there, or take bridge_gaps=True"
        )
