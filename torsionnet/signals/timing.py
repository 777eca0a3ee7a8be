"""Gaps and jitter of the time stamps of a recording."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from torsionnet.signals.recording import FloatArray

GAP_RATIO = 1.9
"""Interval of time stamps over the usual one above which it is a gap, just below 2, where one sample is missing."""


def gaps(times: FloatArray) -> NDArray[np.intp]:
    """Indices of the last sample before every gap in time stamps, (n_gaps,).

    >>> gaps(np.array([0.0, 1.0, 2.0, 5.0, 6.0]))
    array([2])
    """
    intervals = np.diff(times)
    return np.flatnonzero(intervals > GAP_RATIO * np.median(intervals)) if len(intervals) else np.empty(0, np.intp)


def jitter(times: FloatArray) -> float:
    """Standard deviation of the sampling intervals over their mean, without unit, gaps left out.

    >>> round(jitter(np.array([0.0, 0.9, 2.0, 2.9, 4.0])), 9)
    0.1
    """
    intervals = np.delete(np.diff(times), gaps(times))
    return float(np.std(intervals) / np.mean(intervals)) if len(intervals) else 0.0
