"""Half width of a confidence interval for a value with errors by noise and by the steps of sensors.

The error of a fitted value by sensor steps depends on the position within a step that the rig rests at. It is bounded:
an error that varies as a sine with the position reaches 1.4 standard deviations, where noise has 1.96 at 95 %. The
interval for both errors together follows from the distribution of the noise, averaged over the rest positions.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from torsionnet.linear.assembly.rows import FloatArray

POSITION_COMBINATIONS = 1024
"""Number of combinations of rest positions of several tests, spread evenly, over which errors by sensor steps are
averaged."""
NEGLIGIBLE_VARIANCE_SHARE = 1e-3
"""Share of a value's variance up to which errors by sensor steps count as noise, and which noise keeps at least."""


def interval_half_width(level: float, error: float, steps: Sequence[Sequence[float]], freedom: float) -> float:
    """Half the width of the confidence interval of a fitted value, in the unit of ``error``.

    Parameters
    ----------
    level : float
    error : float
        Standard error of the value, steps included.
    steps : sequence of sequences of float
        Error of the value at each rest position, all equally likely; several tests are independent.
    freedom : float
        Degrees of freedom of Student's distribution of the noise.

    Examples
    --------
    >>> round(interval_half_width(0.95, 1.0, [], 1e6), 3)
    1.96
    >>> cosine = 2**0.5 * np.cos(2 * np.pi * (np.arange(64) + 0.5) / 64)
    >>> round(interval_half_width(0.95, 1.0, [cosine.tolist()], 1e6), 1)
    1.4
    """
    usual = float(scipy.stats.t.ppf(0.5 + level / 2, freedom)) * error
    known = sum(float(np.mean(np.square(one))) for one in steps)
    if not np.isfinite(error) or known <= NEGLIGIBLE_VARIANCE_SHARE * error**2:
        return usual
    moved, noise = _combined(steps), np.sqrt(max(error**2 - known, NEGLIGIBLE_VARIANCE_SHARE * error**2))

    def missed(width: float) -> float:
        outside = scipy.stats.t.sf((width - moved) / noise, freedom) + scipy.stats.t.cdf(
            (-width - moved) / noise, freedom
        )
        return float(outside.mean()) - (1 - level)

    return float(scipy.optimize.brentq(missed, 0.0, usual + float(np.abs(moved).max())))


def _combined(steps: Sequence[Sequence[float]]) -> FloatArray:
    """Errors of a value by the sensor steps of all tests, one for each combination of rest positions, shape (1024,).

    The sets fill a cube evenly (generalised golden ratio).
    """
    ratio = float(scipy.optimize.brentq(lambda x: x ** (len(steps) + 1) - x - 1, 1.0, 2.0))
    places = (np.arange(POSITION_COMBINATIONS)[:, None] + 0.5) * ratio ** -np.arange(1.0, len(steps) + 1) % 1.0
    return np.asarray(
        np.sum([np.asarray(one)[(places[:, i] * len(one)).astype(int)] for i, one in enumerate(steps)], axis=0)
    )
