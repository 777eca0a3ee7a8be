"""How far an interval reaches from a value whose error is noise, and in part the cosine of a place nobody knows.

Where the middle of a motion lies between two steps of a sensor moves a fitted value by a cosine of that place: never by
more than 1.4 standard deviations, where 1.96 of them would be usual. What both together exceed at a stated level is
found by averaging the distribution of the noise over the places.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import stats
from scipy.optimize import brentq

from torsionnet.assembly.rows import FloatArray

PLACES = 512
LITTLE = 1e-3
"""Share of the variance below which an error counts as noise like all the rest, or noise as no longer there."""


def reach(level: float, error: float, amplitudes: Sequence[float], freedom: float) -> float:
    """Half the width of an interval around a value.

    Parameters
    ----------
    level : float
    error : float
        Standard error of the value, cosines included.
    amplitudes : sequence of float
        Of the cosines; their places are independent.
    freedom : float
        Degrees of freedom of Student's distribution, which the noise has.

    Examples
    --------
    >>> round(reach(0.95, 1.0, [], 1e6), 3)
    1.96
    >>> round(reach(0.95, 1.0, [2**0.5], 1e6), 2)
    1.42
    """
    usual = float(stats.t.ppf(0.5 + level / 2, freedom)) * error
    sizes = np.asarray(amplitudes, dtype=float)
    bounded = float(sizes @ sizes) / 2
    if not np.isfinite(error) or bounded <= LITTLE * error**2:
        return usual
    moved, noise = _places(len(sizes)) @ sizes, np.sqrt(max(error**2 - bounded, LITTLE * error**2))

    def missed(width: float) -> float:
        outside = stats.t.sf((width - moved) / noise, freedom) + stats.t.cdf((-width - moved) / noise, freedom)
        return float(outside.mean()) - (1 - level)

    return float(brentq(missed, 0.0, usual + float(sizes.sum())))


def _places(count: int) -> FloatArray:
    """Cosines (n, count) of places that fill a cube evenly: multiples of the powers of a generalised golden ratio."""
    ratio = float(brentq(lambda x: x ** (count + 1) - x - 1, 1.0, 2.0))
    steps = ratio ** -np.arange(1.0, count + 1)
    return np.asarray(np.cos(2 * np.pi * (np.arange(PLACES)[:, None] + 0.5) * steps))
