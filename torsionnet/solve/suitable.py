"""A range of frequencies that shows every vibration."""

from __future__ import annotations

import math
from collections.abc import Iterable

from torsionnet.response import Modes

BELOW, ABOVE = 10.0, 2.0
WITHOUT_MODES = (0.1, 100.0)


def suitable_range(modes: Iterable[Modes]) -> tuple[float, float]:
    """Hz: from a tenth of the lowest to twice the highest vibration of all drivetrains, on round numbers."""
    found = [value for one in modes for value in one.damped_frequencies if value > 0]
    if not found:
        return WITHOUT_MODES
    return rounded(float(min(found)) / BELOW, up=False), rounded(float(max(found)) * ABOVE, up=True)


def rounded(value: float, *, up: bool) -> float:
    """The next 1, 2 or 5 times a power of ten.

    >>> rounded(0.71, up=False), rounded(162, up=True)
    (0.5, 200.0)
    """
    decade = 10.0 ** math.floor(math.log10(value))
    steps = [factor * decade for factor in (1, 2, 5, 10)]
    return (
        next(step for step in steps if step >= value) if up else next(step for step in reversed(steps) if step <= value)
    )
