"""Pulses of toothed wheels whose motion is known, by bisection on an analytic sum; nothing of the package is used."""

import numpy as np


def pulse_times(angle, places, last, steps=60):
    """Times at which the rising function ``angle`` of time takes the values ``places``, by bisection to rounding."""
    low, high = np.zeros(len(places)), np.full(len(places), float(last))
    assert angle(high[-1:])[0] > places[-1]
    for _ in range(steps):
        middle = (low + high) / 2
        above = angle(middle) > places
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return (low + high) / 2


def shaft(speed, orders=(), acceleration=0.0):
    """Angle in rad over time in s: mean rotation and {order: complex peak amplitude}, of the mean rotation."""

    def mean(t):
        return speed * t + acceleration * t**2 / 2

    def angle(t):
        phi = mean(t)
        return phi + sum((x * np.exp(1j * o * phi)).real for o, x in dict(orders).items())

    return mean, angle


def order_of(values, phi, order):
    """Complex peak amplitude of an order over the mean angle, by least squares beside a constant and a drift."""
    columns = np.column_stack([np.cos(order * phi), -np.sin(order * phi), np.ones_like(phi), phi])
    a, b = np.linalg.lstsq(columns, values, rcond=None)[0][:2]
    return a + 1j * b
