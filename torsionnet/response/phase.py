"""Phase over frequency as one draws it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from torsionnet.response.frequency_response import FloatArray

HALF_TURN = 180.0


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
