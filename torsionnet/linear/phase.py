"""Phase of frequency responses in degrees, continuous over frequency."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.frequency_response import FloatArray

HALF_TURN = 180.0
"""Half a turn in degrees."""
NEGLIGIBLE_IMAGINARY_PART = 1e-12
"""Share of the real part of a response at 0 Hz below which its imaginary part is rounding."""


def phase_at_zero_frequency(value: complex) -> float:
    """Phase in degrees of a response at 0 Hz, without imaginary parts by rounding; nan if it is not finite.

    >>> phase_at_zero_frequency(2 + 1e-66j), phase_at_zero_frequency(-2 - 1e-66j), phase_at_zero_frequency(1j)
    (0.0, 180.0, 90.0)
    """
    if not math.isfinite(abs(value)):
        return math.nan
    imaginary = value.imag if abs(value.imag) > NEGLIGIBLE_IMAGINARY_PART * abs(value.real) else 0.0
    return math.degrees(math.atan2(imaginary, value.real))


def unwrapped_phase(values: NDArray[np.complex128]) -> FloatArray:
    """Continuous (unwrapped) phase of a response in degrees, shape (n_f,), -180 rather than +180.

    It is nan for zero and infinite values.

    >>> unwrapped_phase(np.array([1, -1j, -1, 1j, 1])).tolist()
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
