"""How far an interval reaches from a value whose error is noise, and in part that of steps of sensors.

What steps of a sensor do to a fitted value follows from the place within a step that a rig rests at. It has an end: for
a sine of it 1.4 standard deviations, where 1.96 of them would be usual. What both errors together exceed at a stated
level is found by averaging the distribution of the noise over the places.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import stats
from scipy.optimize import brentq

from torsionnet.assembly.rows import FloatArray

COMBINATIONS = 1024
LITTLE = 1e-3
"""Share of the variance below which steps count as noise like all the rest, or noise as no longer there."""


def reach(level: float, error: float, steps: Sequence[Sequence[float]], freedom: float) -> float:
    """Half the width of an interval around a value.

    Parameters
    ----------
    level : float
    error : float
        Standard error of the value, steps included.
    steps : sequence of sequences of float
        By how much they move it, from places that are all as likely; those of several tests are independent.
    freedom : float
        Degrees of freedom of Student's distribution, which the noise has.

    Examples
    --------
    >>> round(reach(0.95, 1.0, [], 1e6), 3)
    1.96
    >>> cosine = 2**0.5 * np.cos(2 * np.pi * (np.arange(64) + 0.5) / 64)
    >>> round(reach(0.95, 1.0, [cosine.tolist()], 1e6), 1)
    1.4
    """
    usual = float(stats.t.ppf(0.5 + level / 2, freedom)) * error
    known = sum(float(np.mean(np.square(one))) for one in steps)
    if not np.isfinite(error) or known <= LITTLE * error**2:
        return usual
    moved, noise = _combined(steps), np.sqrt(max(error**2 - known, LITTLE * error**2))

    def missed(width: float) -> float:
        outside = stats.t.sf((width - moved) / noise, freedom) + stats.t.cdf((-width - moved) / noise, freedom)
        return float(outside.mean()) - (1 - level)

    return float(brentq(missed, 0.0, usual + float(np.abs(moved).max())))


def _combined(steps: Sequence[Sequence[float]]) -> FloatArray:
    """Sums over the tests, of places that fill a cube evenly: multiples of powers of a generalised golden ratio."""
    ratio = float(brentq(lambda x: x ** (len(steps) + 1) - x - 1, 1.0, 2.0))
    places = (np.arange(COMBINATIONS)[:, None] + 0.5) * ratio ** -np.arange(1.0, len(steps) + 1) % 1.0
    return np.asarray(
        np.sum([np.asarray(one)[(places[:, i] * len(one)).astype(int)] for i, one in enumerate(steps)], axis=0)
    )
