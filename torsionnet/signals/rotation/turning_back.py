"""Standstills after which a shaft may have turned back, which the pulses of one track do not tell."""

from __future__ import annotations

import numpy as np

from torsionnet.core.errors import UsageError
from torsionnet.response.recording import FloatArray

NEAR, FAR = 2, 9
"""Number of pulses from a standstill at which intervals are compared, as their growth there tells it from a change of
speed and from a gap."""
GROWTH, LAST_GROWTH = 1.7, 2.5
"""Least ratios of the intervals near and at a standstill to those far from it. At constant deceleration the former is
1.9."""


def refuse_turning_back(times: FloatArray, name: str) -> None:
    """Refuse pulses of a shaft that stands still in between, as it may turn back there.

    Parameters
    ----------
    times : (n,) array
        Times of the pulses, s.
    name : str
        Channel, for the message.

    Raises
    ------
    UsageError
        With the time of the standstill and what would help.
    """
    steps = np.diff(times)
    if len(steps) < 2 * FAR + 1:
        return
    centre = np.arange(FAR, len(steps) - FAR)
    far = np.maximum(steps[centre - FAR], steps[centre + FAR])
    near = np.minimum(steps[centre - NEAR], steps[centre + NEAR])
    closer = np.minimum(steps[centre - 1], steps[centre + 1])
    found = (near > GROWTH * far) & (closer >= near) & (steps[centre] > LAST_GROWTH * far)
    if found.any():
        place = int(centre[found][steps[centre[found]].argmax()])
        raise UsageError(
            f"{name}: the shaft stands still around {times[place]:.6g} s, pulse {place}: whether it turns on or back, "
            "the pulses of one track do not tell; record a second track a quarter pitch further (second:), or cut the "
            "record there"
        )
