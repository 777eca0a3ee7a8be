"""Removal of double pulses of an encoder, caused by a bouncing contact or a disturbance."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from torsionnet.signals.recording import FloatArray

MEDIAN_INTERVALS = 5
"""Number of intervals whose median is the usual interval where lost pulses are counted, few so that it follows the
speed."""
WIDE_MEDIAN_INTERVALS = 9
"""Number of intervals whose median is the usual interval where double pulses are searched, more since each spoils two
intervals."""
SHORT_INTERVAL_SHARE, SAME_INTERVAL_RATIO = 0.6, 1.25
"""Interval over the usual one below which a pulse may be double, and factor within which the interval joined without it
is usual again."""
CLEAR_MISFIT_DIFFERENCE = 0.1
"""Difference of the logarithm of an interval over the usual one by which the rarer kind of double pulse must fit
better."""


def indices_without_double(times: FloatArray) -> NDArray[np.intp]:
    """Indices of an encoder's pulses that remain when double ones are left out."""
    intervals = np.diff(times)
    if len(intervals) < MEDIAN_INTERVALS:
        return np.arange(len(times))
    level = running_median(intervals, WIDE_MEDIAN_INTERVALS)
    stay, done = np.ones(len(times), dtype=bool), 0
    for place in np.flatnonzero(intervals < SHORT_INTERVAL_SHARE * level):
        if place >= done:
            first, last = _false(times, int(place), float(level[place]))
            stay[first:last] = False
            done = last
    return np.flatnonzero(stay)


def _false(times: FloatArray, place: int, level: float) -> tuple[int, int]:
    """Range (first, last) of the superfluous pulses at a short interval, empty where no choice gives even intervals.

    Either those after this pulse up to the next good one, as by a bouncing contact, or this pulse and those after it:
    whichever leaves the more regular intervals.
    """
    after, misfit = _next(times, place, level)
    if place:
        misfit = max(misfit, _misfit(times[place] - times[place - 1], level))
        good, other = _next(times, place - 1, level)
        other = max(other, _next(times, good, level)[1])
        if other < misfit - CLEAR_MISFIT_DIFFERENCE and other < np.log(SAME_INTERVAL_RATIO):
            return place, good
    return (place + 1, after) if misfit < np.log(SAME_INTERVAL_RATIO) else (place, place)


def _next(times: FloatArray, place: int, level: float) -> tuple[int, float]:
    """Index of the pulse nearest to one usual interval later, and the logarithm of its interval over the usual."""
    due = times[place] + level
    near = int(np.searchsorted(times, due))
    found = min((one for one in (near - 1, near) if place < one < len(times)), key=lambda one: abs(times[one] - due))
    return found, _misfit(times[found] - times[place], level)


def _misfit(interval: float, level: float) -> float:
    return abs(float(np.log(interval / level)))


def running_median(values: FloatArray, count: int) -> FloatArray:
    """Median of the ``count`` values around each value, (n,), in their unit."""
    from scipy.ndimage import median_filter

    return np.asarray(median_filter(values, min(count, (len(values) - 1) // 2 * 2 + 1), mode="mirror"))
