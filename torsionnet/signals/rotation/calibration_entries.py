"""Angles that a calibration of a wheel takes, with their units, for the command line and files."""

import math

from torsionnet.base.entries.scalars import Value

PICKUP_ANGLE = Value(
    "angle from the first to the second pickup in the sense of rotation", "angle", exclusive=True, below=2 * math.pi
)
ZERO_ANGLE = Value("angle of the reference shaft at tooth 0", "angle", lower=None)
TICK = Value("time of one count of the counter", "time", exclusive=True)
