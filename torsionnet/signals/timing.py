"""Intervals between time stamps."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from torsionnet.response.recording import FloatArray

GAP = 1.9  # of the usual interval: one sample is missing


def gaps(times: FloatArray) -> NDArray[np.intp]:
    """Index of the last sample before every gap.

    >>> gaps(np.array([0.0, 1.0, 2.0, 5.0, 6.0]))
    array([2])
    """
    intervals = np.diff(times)
    return np.flatnonzero(intervals > GAP * np.median(intervals)) if len(intervals) else np.empty(0, np.intp)


def jitter(times: FloatArray) -> float:
    """Standard deviation of the intervals that are no gaps, as a part of their mean.

    >>> round(jitter(np.array([0.0, 0.9, 2.0, 2.9, 4.0])), 9)
    0.1
    """
    intervals = np.delete(np.diff(times), gaps(times))
    return float(np.std(intervals) / np.mean(intervals)) if len(intervals) else 0.0
