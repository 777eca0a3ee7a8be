"""Times of the pulses of a toothed wheel with errors of pitch on a vibrating shaft, from the closed form of its angle.

Nothing here is the package's: the shaft turns by theta(phi) = phi + sum_o Re X_o exp(j o phi) over its mean rotation
phi = Omega t; Newton's method finds where theta reaches each tooth.
"""

from __future__ import annotations

import numpy as np


def crossing_times(orders, values, speed, positions, turns, *, pickup=0.0, missing=0, start=0.0):
    """Times at which each tooth passes a pickup at an angle behind the first, s."""
    teeth = len(positions)
    numbers = np.arange(round(turns * teeth))
    numbers = numbers[numbers % teeth < teeth - missing]
    wanted = 2 * np.pi * numbers / teeth + np.asarray(positions)[numbers % teeth] + pickup + start
    phi = wanted.copy()
    orders, values = np.asarray(orders, dtype=float), np.asarray(values)
    for _ in range(60):
        turning = np.exp(1j * np.outer(phi, orders)) * values
        angle = phi + turning.sum(axis=1).real
        rate = 1 + (1j * orders * turning).sum(axis=1).real
        step = (angle - wanted) / rate
        phi -= step
        if np.abs(step).max() < 1e-14 * np.abs(phi).max() + 1e-15:
            break
    return phi / speed


def position_amplitude(positions, order):
    """Complex peak amplitude of the errors of position at a whole order, as a sum over the teeth."""
    teeth = len(positions)
    turning = np.exp(-2j * np.pi * order * np.arange(teeth) / teeth)
    return (1 if order in (0, teeth / 2) else 2) * (positions * turning).sum() / teeth
