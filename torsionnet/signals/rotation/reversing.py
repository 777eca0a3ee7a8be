"""Rotation of a shaft that turns back, through the pulses of an encoder with two tracks."""

from __future__ import annotations

from typing import Any

import numpy as np

from torsionnet.signals.recording import FloatArray

REVERSING_BAND = 1 / 3
"""Share of half the pulses of a turn up to which cubic splines read orders within 0.2 %."""
END_PULSES = 4
"""Number of pulses from either end on which the spline depends on what comes beyond it."""
SPLINE_DEGREE = 3
"""Degree of the splines, which follow constant acceleration through a standstill."""


class ReversingRotation:
    """Rotation of a shaft over time in encoder steps by cubic splines over time, as it has no course to be even over.

    Parameters
    ----------
    times : (n,) array
        Times of the pulses, s.
    places : (n,) array
        Steps at which they stand, from 0.
    """

    kept_band = REVERSING_BAND
    end_pulses = END_PULSES

    def __init__(self, times: FloatArray, places: FloatArray) -> None:
        from scipy.interpolate import make_interp_spline

        self.mean_rotation: Any = make_interp_spline(times, places, k=min(SPLINE_DEGREE, len(times) - 1))

    def at(self, times: FloatArray) -> FloatArray:
        """Rotation in encoder steps since the first pulse at times in s between first and last pulse, shape (n,)."""
        return np.asarray(self.mean_rotation(times), dtype=float)

    def rate(self, times: FloatArray) -> FloatArray:
        """Speed in encoder steps a second at times in s between first and last pulse, shape (n,)."""
        return np.asarray(self.mean_rotation(times, 1), dtype=float)
