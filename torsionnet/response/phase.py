"""Phase over frequency as one draws it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from torsionnet.response.frequency_response import FloatArray

HALF_TURN = 180.0
ROUNDING = 1e-12
"""Of the magnitude: an imaginary part below it is what rounding left of none."""


def phase_at_rest(value: complex) -> float:
    """Phase in degrees of a value at 0 Hz, where an imaginary part of rounding is none; nan where it has none.

    >>> phase_at_rest(2 + 1e-66j), phase_at_rest(-2 - 1e-66j), phase_at_rest(1j)
    (0.0, 180.0, 90.0)
    """
    if not math.isfinite(abs(value)):
        return math.nan
    imaginary = value.imag if abs(value.imag) > ROUNDING * abs(value.real) else 0.0
    return math.degrees(math.atan2(imaginary, value.real))


def unwrapped(values: NDArray[np.complex128]) -> FloatArray:
    """Continuous phase in degrees; -180 rather than +180, since a response lags. nan for zero and infinite values.

    >>> unwrapped(np.array([1, -1j, -1, 1j, 1])).tolist()
    [0.0, -90.0, -180.0, -270.0, -360.0]
    """
    phase = np.full(len(values), np.nan)
    good = np.isfinite(values) & (values != 0)
    angles = np.degrees(np.angle(values[good]))
    angles[angles > HALF_TURN - 1e-6] = -HALF_TURN
    if angles.size:
        angles = np.unwrap(angles, period=2 * HALF_TURN)
    phase[good] = angles
    return phase
