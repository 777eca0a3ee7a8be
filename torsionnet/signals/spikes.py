"""Single samples that are far from both their neighbours."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from torsionnet.response.recording import FloatArray

REACH = 50
"""Samples on either side that say how much the signal usually turns and changes from one to the next."""
SHARPER, LARGER, SKIPPED = 8.0, 2.0, 3
"""So many times as sharp as the turns around it and as large as the changes, of which so many may be spikes as well."""
FIRST_LOOK = 4.0
STEPS = 3.0
"""Steps of a sensor that a spike at least has."""
LOPSIDED = 2.0
BATCH = 2000


def spikes(values: FloatArray, step: float = 0.0) -> NDArray[np.intp]:
    """Places of spikes in a signal whose sensor has such steps (0: none).

    A spike goes up and comes down by about as much, and turns far more sharply than the hundred samples around it.
    Noise does not, however it is distributed, nor the end of a burst.

    >>> values = np.sin(np.arange(500) / 10)
    >>> values[300] += 5
    >>> spikes(values)
    array([300])
    """
    if len(values) < 2 * REACH:
        return np.empty(0, np.intp)
    rise, fall = np.diff(values)[:-1], -np.diff(values)[1:]
    turn = np.abs(rise + fall) / 2
    sums = np.cumsum(np.concatenate([[0.0], turn]))
    ends = np.clip(np.arange(len(turn))[:, None] + [-REACH, REACH + 1], 0, len(turn))
    usual = (sums[ends[:, 1]] - sums[ends[:, 0]] - turn) / (ends[:, 1] - ends[:, 0] - 1)
    sizes = np.sort(np.abs([rise, fall]), axis=0)
    seen = (rise * fall > 0) & (sizes[1] <= LOPSIDED * sizes[0]) & (turn > STEPS * step) & (turn > FIRST_LOOK * usual)
    places = np.flatnonzero(seen)
    found = [np.empty(0, np.intp)]
    for begin in range(0, len(places), BATCH):
        some = places[begin : begin + BATCH]
        sharp, large = turn[some] > SHARPER * _level(turn, some), sizes[0, some] > LARGER * _level(np.abs(rise), some)
        found.append(some[sharp & large])
    return np.concatenate(found) + 1


def _level(values: FloatArray, places: NDArray[np.intp]) -> FloatArray:
    """The largest values around each place but for those that three spikes make, which disturb three samples each."""
    around = np.concatenate([np.arange(-REACH, -1), np.arange(2, REACH + 1)])
    near = places[:, None] + around
    others = np.where((near >= 0) & (near < len(values)), values[np.clip(near, 0, len(values) - 1)], 0.0)
    return np.asarray(np.partition(others, -1 - 3 * SKIPPED, axis=1)[:, -1 - 3 * SKIPPED])
