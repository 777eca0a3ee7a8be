"""A communication step that resolves what a drivetrain can do."""

from __future__ import annotations

import math

from torsionnet.drivetrain import Drivetrain

PER_PERIOD = 50
"""Steps per period of the highest mode: inputs that run on in straight lines are then 0.8 % off at its frequency."""
BAND = 1000.0
"""Hz beyond which modes do not count: what excites a drivetrain lies below."""


def suggested_step(drivetrain: Drivetrain) -> float:
    """Communication step in s, of the form 1, 2 or 5 times a power of ten.

    Examples
    --------
    >>> import torsionnet as tn
    >>> suggested_step(tn.load("dmf_rig"))
    0.0002
    """
    frequencies = drivetrain.modes().natural_frequencies
    highest = max((float(f) for f in frequencies if math.isfinite(f) and 0 < f <= BAND), default=0.0)
    if any(f > BAND for f in frequencies):
        highest = BAND
    longest = 1 / (PER_PERIOD * (highest or 1.0))
    power = math.floor(math.log10(longest))
    return next(float(f"{digit}e{power}") for digit in (5, 2, 1) if digit * 10.0**power <= longest * (1 + 1e-9))
