"""Mean angle of rotation of a shaft, without its torsional vibration, from its speed or angle."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.core.errors import UsageError
from torsionnet.modal.spectral_lines import FloatArray

SMOOTHED_REVOLUTIONS = 4.0
"""Revolutions over which the angle is smoothed: two cycles of a four-stroke engine."""
LOCAL_DEGREE = 3
"""Degree of the polynomials that smooth the angle: speed and acceleration may change within their length."""


def mean_rotation(times: FloatArray, *, speed: ArrayLike | None = None, angle: ArrayLike | None = None) -> FloatArray:
    """Mean angle of rotation in rad at times in s, from the speed (rad/s) or the angle (rad) of a shaft, shape (n,).

    Polynomials over four revolutions smooth out torsional vibration and noise.

    Raises
    ------
    UsageError
        Neither speed nor angle is given or both are, or the shaft hardly turns.
    """
    from scipy.integrate import cumulative_simpson
    from scipy.signal import savgol_filter

    if (speed is None) == (angle is None):
        raise UsageError("the frequency of an order needs the speed or the angle of the shaft: give one of them")
    given = np.asarray(speed if angle is None else angle, dtype=np.float64)
    if given.shape != times.shape or not np.isfinite(given).all():
        raise UsageError(f"speed or angle must be a finite number for each of the {len(times)} samples")
    turned = cumulative_simpson(given, x=times, initial=0.0) if angle is None else given
    revolutions = abs(turned[-1] - turned[0]) / (2 * np.pi)
    if revolutions < SMOOTHED_REVOLUTIONS:
        raise UsageError(
            f"the shaft turns by {revolutions:.3g} revolutions only; is its speed in rad/s, its angle in rad?"
        )
    length = 2 * round(SMOOTHED_REVOLUTIONS / revolutions * len(times) / 2) + 1
    if length <= LOCAL_DEGREE + 1:
        return np.asarray(turned, dtype=np.float64)
    return np.asarray(savgol_filter(turned, length, LOCAL_DEGREE), dtype=np.float64)
