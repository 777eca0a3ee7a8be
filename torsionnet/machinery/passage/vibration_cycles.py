"""Half ranges of a vibration over time in windows of one cycle, and number of its cycles above a level.

Half range of each, crests between samples, and how many exceed a level.
"""

from __future__ import annotations

import numpy as np

from torsionnet.linear.frequency_response import FloatArray

WINDOWS_PER_CYCLE = 8
"""Number of overlapping windows, each one cycle long, that begin within each cycle: a shorter step than this changes a
half range by less than the growth of vibration in an eighth of a cycle."""


def crests(values: FloatArray) -> FloatArray:
    """Values over time (n,), in their unit, with local extremes replaced by those of parabolas through three samples.

    Examples
    --------
    >>> wave = np.cos(0.5 * np.arange(20) + 0.2)
    >>> round(float(wave.max()), 4), round(float(crests(wave).max()), 4)
    (0.9965, 0.9998)
    """
    found = values.copy()
    if len(values) < 3:
        return found
    before, here, after = values[:-2], values[1:-1], values[2:]
    bend = before - 2 * here + after
    extreme = (here - before) * (after - here) <= 0
    with np.errstate(divide="ignore", invalid="ignore"):
        rise = np.where(extreme & (bend != 0), (before - after) ** 2 / (-8 * bend), 0.0)
    found[1:-1] = here + rise
    return found


def half_ranges(angles: FloatArray, values: FloatArray, cycle: float) -> tuple[FloatArray, FloatArray]:
    """Middle angles in rad of windows one cycle long, and half ranges in the unit of ``values`` in them, both (n,).

    Parameters
    ----------
    angles, values : (n,) arrays
        Angle of the shaft in rad, rising, and the vibration.
    cycle : float
        Length of a cycle in rad; a shorter record is one window.

    Examples
    --------
    >>> angle = np.linspace(0, 20 * np.pi, 4001)
    >>> middle, found = half_ranges(angle, angle / 100 * np.cos(angle), 2 * np.pi)
    >>> round(float(np.interp(10 * np.pi, middle, found)), 3)  # (31.4 + 34.6)/200
    0.33
    """
    middle, low, high = envelopes(angles, values, cycle)
    return middle, (high - low) / 2


def envelopes(angles: FloatArray, values: FloatArray, cycle: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Middle angles in rad of windows one cycle long, smallest and largest value in them, all (n,).

    Parameters
    ----------
    angles, values : (n,) arrays
        Angle of the shaft in rad, rising, and the vibration in any unit, which the envelopes have too.
    cycle : float
        Length of a cycle in rad; a shorter record is one window.

    Examples
    --------
    >>> angle = np.linspace(0, 20 * np.pi, 4001)
    >>> middle, low, high = envelopes(angle, 1 + 2 * np.cos(angle), 2 * np.pi)
    >>> round(float(low.max()), 3), round(float(high.min()), 3)
    (-1.0, 3.0)
    """
    exact = crests(values)
    count = int((angles[-1] - angles[0]) / cycle * WINDOWS_PER_CYCLE * (1 + 1e-12))
    if count < WINDOWS_PER_CYCLE:
        return np.array([(angles[0] + angles[-1]) / 2]), np.array([exact.min()]), np.array([exact.max()])
    edges = angles[0] + np.arange(count + 1) * cycle / WINDOWS_PER_CYCLE
    starts = np.searchsorted(angles, edges[:-1])
    last = int(np.searchsorted(angles, edges[-1], side="right"))
    starts = np.minimum(starts, last - 1)
    high, low = (operation.reduceat(exact[:last], starts) for operation in (np.maximum, np.minimum))
    wide = np.lib.stride_tricks.sliding_window_view
    most, least = (wide(high, WINDOWS_PER_CYCLE).max(axis=1), wide(low, WINDOWS_PER_CYCLE).min(axis=1))
    return edges[: len(most)] + cycle / 2, np.asarray(least), np.asarray(most)


def cycles_above(values: FloatArray, level: float) -> float:
    """Number of cycles of a vibration around zero whose amplitude exceeds a level, a half for each half cycle.

    Between two crossings of zero the largest value counts alone ("mean crossing peak counting", ASTM E1049-85, 5.2).

    Examples
    --------
    >>> cycles_above(np.cos(np.linspace(0, 20 * np.pi, 2000)) * np.linspace(0, 1, 2000), 0.52)
    5.0
    """
    positive = values > 0
    starts = np.concatenate([[0], np.flatnonzero(positive[1:] != positive[:-1]) + 1])
    peaks = np.maximum.reduceat(np.abs(crests(values)), starts)
    return float((peaks > level).sum() / 2)
