"""Standstills after which a shaft may have turned back, which the pulses of one track do not tell."""

from __future__ import annotations

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.signals.recording import FloatArray

NEAR, FAR = 2, 9
"""Number of pulses from a standstill at which intervals are compared, as their growth there tells it from a change of
speed and from a gap."""
GROWTH, LAST_GROWTH = 1.7, 2.5
"""Least ratios of the intervals near and at a standstill to those far from it. At constant deceleration the former is
1.9."""
INTERVALS_TOGETHER = 2**17
"""Number of intervals that are compared together, which limits the memory."""


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
    longest, place = 0.0, -1
    for begin in range(0, len(times) - 2 * FAR - 1, INTERVALS_TOGETHER):
        steps = np.diff(times[begin : begin + INTERVALS_TOGETHER + 2 * FAR + 1])
        here = steps[FAR:-FAR]
        far = np.maximum(steps[: -2 * FAR], steps[2 * FAR :])
        near = np.minimum(steps[FAR - NEAR : -FAR - NEAR], steps[FAR + NEAR : len(steps) - FAR + NEAR])
        closer = np.minimum(steps[FAR - 1 : -FAR - 1], steps[FAR + 1 : len(steps) - FAR + 1])
        found = (near > GROWTH * far) & (closer >= near) & (here > LAST_GROWTH * far)
        if found.any() and here[found].max() > longest:
            at = np.flatnonzero(found)[here[found].argmax()]
            longest, place = float(here[at]), begin + FAR + int(at)
    if place >= 0:
        raise UsageError(
            f"{name}: the shaft stands still around {times[place]:.6g} s, pulse {place}: whether it turns on or back, "
            "the pulses of one track do not tell; record a second track a quarter pitch further (second:), or cut the "
            "record there"
        )
