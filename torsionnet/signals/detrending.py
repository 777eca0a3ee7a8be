"""Removal of the mean or of a straight line from signals."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Literal, TypeAlias, get_args

import numpy as np

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.signals.recording import FloatArray, Recording

Trend: TypeAlias = Literal["none", "mean", "linear"]


def detrend(recording: Recording, trend: Trend = "mean", names: Iterable[str] | None = None) -> Recording:
    """Recording with the mean, or the straight line of least squares, removed from its signals.

    Parameters
    ----------
    recording : Recording
    trend : {"mean", "linear", "none"}
    names : iterable of str, optional
        Signals to treat; all by default.

    Examples
    --------
    >>> from torsionnet.signals.recording import Signal
    >>> record = Recording((Signal("theta", "angle", np.array([1.0, 2.0, 6.0])),), sampling_rate=100)
    >>> detrend(record)["theta"].values.tolist()
    [-2.0, -1.0, 3.0]
    """
    treated = recording.names if names is None else tuple(names)
    if check_trend(trend) == "none":
        return recording
    signals = [recording[name] for name in treated]
    note = f"{'mean' if trend == 'mean' else 'straight line'} taken out"
    return recording.with_signals(
        *(replace(s, values=without_trend(s.values, trend), notes=(*s.notes, note)) for s in signals)
    )


def without_trend(values: FloatArray, trend: Trend) -> FloatArray:
    """Values with their mean or straight line along the last axis removed, same shape and unit."""
    if check_trend(trend) == "none":
        return values
    centred = values - values.mean(axis=-1, keepdims=True)
    if trend == "mean" or values.shape[-1] == 1:
        return np.asarray(centred, dtype=np.float64)
    ramp = np.linspace(-1, 1, values.shape[-1])
    slope = centred @ ramp / (ramp @ ramp)
    return np.asarray(centred - slope[..., None] * ramp, dtype=np.float64)


def check_trend(trend: Trend) -> Trend:
    """Name of a trend unchanged if it is known (none, mean, linear), else an error is raised."""
    known = get_args(Trend)
    if trend not in known:
        raise UsageError(f'no trend is named "{trend}"{did_you_mean(trend, known)}; there is {", ".join(known)}')
    return trend
