"""Double pulses of an encoder: a contact that bounces, or a disturbance between two pulses."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from torsionnet.response.recording import FloatArray

NEIGHBOURS = 5
WIDE = 9
SHORT, SAME = 0.6, 1.25
"""A pulse is double where an interval is shorter than this share of those around it, and with the next one the same."""
CLEARLY = 0.1
"""Difference of a logarithm by which one explanation must be better than the usual one."""


def without_double(times: FloatArray) -> NDArray[np.intp]:
    """Places of the pulses that stay."""
    intervals = np.diff(times)
    if len(intervals) < NEIGHBOURS:
        return np.arange(len(times))
    level = around(intervals, WIDE)
    stay, done = np.ones(len(times), dtype=bool), 0
    for place in np.flatnonzero(intervals < SHORT * level):
        if place >= done:
            first, last = _false(times, int(place), float(level[place]))
            stay[first:last] = False
            done = last
    return np.flatnonzero(stay)


def _false(times: FloatArray, place: int, level: float) -> tuple[int, int]:
    """Range of the pulses that are too many where a short interval begins; empty where nothing fits.

    Either those after this pulse up to the next good one, as a contact that bounces makes them, or this one and those
    after it: whichever leaves the more regular intervals.
    """
    after, misfit = _next(times, place, level)
    if place:
        misfit = max(misfit, _misfit(times[place] - times[place - 1], level))
        good, other = _next(times, place - 1, level)
        other = max(other, _next(times, good, level)[1])
        if other < misfit - CLEARLY and other < np.log(SAME):
            return place, good
    return (place + 1, after) if misfit < np.log(SAME) else (place, place)


def _next(times: FloatArray, place: int, level: float) -> tuple[int, float]:
    """The pulse nearest to one interval later, and how far it is off."""
    due = times[place] + level
    near = int(np.searchsorted(times, due))
    found = min((one for one in (near - 1, near) if place < one < len(times)), key=lambda one: abs(times[one] - due))
    return found, _misfit(times[found] - times[place], level)


def _misfit(interval: float, level: float) -> float:
    return abs(float(np.log(interval / level)))


def around(values: FloatArray, count: int) -> FloatArray:
    """Median of every value and its neighbours."""
    count = min(count, (len(values) - 1) // 2 * 2 + 1)
    wide = np.pad(values, count // 2, mode="reflect")
    return np.asarray(np.median(np.lib.stride_tricks.sliding_window_view(wide, count), axis=-1))
