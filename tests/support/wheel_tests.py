"""Records of a wheel of 24 teeth with errors of pitch, seen by one or two pickups."""

import numpy as np

from support.turned_wheels import crossing_angles, steady
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.wheel_calibration import WheelTest

RPM, DEGREE = np.pi / 30, np.pi / 180
Z = 24
ORDERS = np.array([0.5, 1.0, 2.0, 3.0, 4.5])
VALUES = np.array([0.1, 0.05j, 0.08, -0.1 + 0.05j, 0.03]) * DEGREE


def teeth(seed=1, count=Z, missing=0):
    errors = 0.05 * DEGREE * np.random.default_rng(seed).standard_normal(count)
    there = np.arange(count) < count - missing
    return np.where(there, errors - errors[there].mean(), 0.0)


def record(positions, speed, *, angle=None, values=VALUES, turns=20, jitter=0.0, seed=0, index=True, **more):
    """Pulses of one steady record, of a second pickup at an angle, and of an index just before tooth 0."""
    random, pickups = np.random.default_rng(seed), []
    for name, at in (("A", 0.0), ("B", angle)):
        if at is not None:
            times = steady(crossing_angles(ORDERS, values, positions, turns, pickup=at, **more), speed)
            pickups.append(PulseChannel(name, times + jitter * random.standard_normal(len(times))))
    marks = 2 * np.pi * np.arange(1, turns) - np.pi / len(positions)
    pulse = PulseChannel("index", steady(marks, speed)) if index else None
    return WheelTest(pickups[0], pickups[1] if len(pickups) > 1 else None, pulse)
