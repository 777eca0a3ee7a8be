"""Times of the pulses of a toothed wheel with errors of pitch on a vibrating shaft, from the closed form of its angle.

Nothing here is the package's: the shaft turns by theta(phi) = phi + sum_o Re X_o exp(j o phi) over its mean rotation
phi; Newton's method finds where theta reaches each tooth. The tracker is least squares over the same closed form.
"""

from __future__ import annotations

import numpy as np


def crossing_angles(orders, values, positions, turns, *, pickup=0.0, missing=0, first=0):
    """Mean rotation in rad at which each tooth passes a pickup at an angle behind the first."""
    teeth = len(positions)
    numbers = first + np.arange(round(turns * teeth))
    numbers = numbers[numbers % teeth < teeth - missing]
    wanted = 2 * np.pi * numbers / teeth + np.asarray(positions)[numbers % teeth] + pickup
    phi = wanted.copy()
    orders, values = np.asarray(orders, dtype=float), np.asarray(values)
    for _ in range(60):
        turning = np.exp(1j * np.outer(phi, orders)) * values
        step = (phi + turning.sum(axis=1).real - wanted) / (1 + (1j * orders * turning).sum(axis=1).real)
        phi -= step
        if np.abs(step).max() < 1e-13:
            break
    return phi


def steady(phi, speed):
    """Times in s of a mean rotation in rad at constant speed in rad/s."""
    return phi / speed


def run_up(phi, speed, acceleration):
    """Times in s of a mean rotation in rad that begins at a speed in rad/s and rises evenly, rad/s^2."""
    return (np.sqrt(speed**2 + 2 * acceleration * phi) - speed) / acceleration


def position_amplitude(positions, order):
    """Complex peak amplitude of the errors of position at a whole order, as a sum over the teeth."""
    teeth = len(positions)
    turning = np.exp(-2j * np.pi * order * np.arange(teeth) / teeth)
    return (1 if order in (0, teeth / 2) else 2) * (positions * turning).sum() / teeth


def tracked(times, positions, orders):
    """Complex peak amplitudes of orders of a steady record that begins at tooth 0, teeth at these positions beyond
    their places."""
    teeth = len(positions)
    numbers = np.arange(len(times))
    angle = 2 * np.pi * numbers / teeth + np.asarray(positions)[numbers % teeth]
    time = times - times.mean()
    phi = np.polyval(np.polyfit(time, angle, 1), time)
    for _ in range(6):
        terms = np.column_stack(
            [np.ones_like(time), time, np.cos(np.outer(phi, orders)), np.sin(np.outer(phi, orders))]
        )
        coefficients = np.linalg.lstsq(terms, angle, rcond=None)[0]
        phi = terms[:, :2] @ coefficients[:2]
    return coefficients[2 : 2 + len(orders)] - 1j * coefficients[2 + len(orders) :]
