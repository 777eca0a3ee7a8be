"""Search of a signal for spikes, which are single samples far from both their neighbours."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from torsionnet.signals.recording import FloatArray

NEIGHBOUR_SAMPLES = 50
"""Number of samples on either side with whose changes and second differences those of a possible spike are compared."""
LEAST_SHARPNESS, LEAST_SIZE, SKIPPED_SPIKES = 8.0, 2.0, 3
"""Least second difference and least change of a spike over those around it, more than noise reaches, and number of
other spikes around that are left out of the comparison."""
EXAMINED_SHARPNESS = 4.0
"""Second difference of a sample over the mean around it above which it is examined closely, a quick test that saves
time."""
LEAST_STEPS = 3.0
"""Least second difference of a spike in steps of the sensor, as rounding to steps makes smaller ones."""
MOST_ASYMMETRY = 2.0
"""Largest ratio of the rise and the fall of a spike, as a larger one is an edge of the signal."""
SAMPLES_PER_BATCH = 2000
"""Number of possible spikes that are examined together, which limits the memory."""


def spikes(values: FloatArray, step: float = 0.0) -> NDArray[np.intp]:
    """Indices of the samples of a signal that are spikes, for a sensor with steps of size ``step`` or 0.

    A spike rises and falls by about the same, and has a far larger second difference than the hundred samples around.
    Noise has not, whatever its distribution, nor has the end of a burst.

    >>> values = np.sin(np.arange(500) / 10)
    >>> values[300] += 5
    >>> spikes(values)
    array([300])
    """
    if len(values) < 2 * NEIGHBOUR_SAMPLES:
        return np.empty(0, np.intp)
    rise, fall = np.diff(values)[:-1], -np.diff(values)[1:]
    turn = np.abs(rise + fall) / 2
    sums = np.cumsum(np.concatenate([[0.0], turn]))
    ends = np.clip(np.arange(len(turn))[:, None] + [-NEIGHBOUR_SAMPLES, NEIGHBOUR_SAMPLES + 1], 0, len(turn))
    usual = (sums[ends[:, 1]] - sums[ends[:, 0]] - turn) / (ends[:, 1] - ends[:, 0] - 1)
    sizes = np.sort(np.abs([rise, fall]), axis=0)
    seen = (
        (rise * fall > 0)
        & (sizes[1] <= MOST_ASYMMETRY * sizes[0])
        & (turn > LEAST_STEPS * step)
        & (turn > EXAMINED_SHARPNESS * usual)
    )
    places = np.flatnonzero(seen)
    found = [np.empty(0, np.intp)]
    for begin in range(0, len(places), SAMPLES_PER_BATCH):
        some = places[begin : begin + SAMPLES_PER_BATCH]
        sharp, large = (
            turn[some] > LEAST_SHARPNESS * _level(turn, some),
            sizes[0, some] > LEAST_SIZE * _level(np.abs(rise), some),
        )
        found.append(some[sharp & large])
    return np.concatenate(found) + 1


def _level(values: FloatArray, places: NDArray[np.intp]) -> FloatArray:
    """Largest value around each index, (n,), without those of SKIPPED_SPIKES other spikes (three samples each)."""
    around = np.concatenate([np.arange(-NEIGHBOUR_SAMPLES, -1), np.arange(2, NEIGHBOUR_SAMPLES + 1)])
    near = places[:, None] + around
    others = np.where((near >= 0) & (near < len(values)), values[np.clip(near, 0, len(values) - 1)], 0.0)
    return np.asarray(np.partition(others, -1 - 3 * SKIPPED_SPIKES, axis=1)[:, -1 - 3 * SKIPPED_SPIKES])
