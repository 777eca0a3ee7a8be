"""Motion of a piston over the crank angle, and harmonics of gas and inertia torques."""

from __future__ import annotations

import numpy as np

from torsionnet.machinery.excitations.order_excitation import ComplexArray, FloatArray


def piston_rate(angle: FloatArray, ratio: float) -> FloatArray:
    """Piston rate dx/dphi over the crank radius, x from top dead centre, in the shape of ``angle`` (rad).

    ``ratio`` is crank radius over rod length.

    >>> bool(abs(piston_rate(np.array([np.pi / 2]), 0.25)[0] - 1) < 1e-12)
    True
    """
    sine, cosine = np.sin(angle), np.cos(angle)
    return np.asarray(sine * (1 + ratio * cosine / np.sqrt(1 - (ratio * sine) ** 2)))


def piston_curvature(angle: FloatArray, ratio: float) -> FloatArray:
    """Piston curvature d2x/dphi2 over the crank radius, in the shape of ``angle`` (rad)."""
    sine, cosine = np.sin(angle), np.cos(angle)
    root = np.sqrt(1 - (ratio * sine) ** 2)
    # 1 - 2 sin^2 is cos^2 - sin^2; the last term is the change of the rod's own slope.
    return np.asarray(cosine + ratio * (cosine**2 - sine**2) / root + ratio**3 * (sine * cosine) ** 2 / root**3)


def inertia_harmonics(ratio: float, orders: FloatArray, samples: int = 4096) -> ComplexArray:
    """Torque -x' x'' of a reciprocating mass over m r^2 Omega^2, complex, at whole orders, shape (n_orders,).

    0 at others.

    The torque is a sine series. For a short rod, as for r/l = 0.25, orders 1 to 4 are:

    >>> [round(float(value), 6) for value in -inertia_harmonics(0.25, np.arange(1.0, 5.0)).imag]
    [0.063506, -0.50013, -0.192056, -0.016129]
    """
    angle = 2 * np.pi * np.arange(samples) / samples
    return harmonics(-piston_rate(angle, ratio) * piston_curvature(angle, ratio), 1, orders)


def harmonics(samples: FloatArray, revolutions: int, orders: FloatArray) -> ComplexArray:
    """Complex amplitudes at orders, shape (n_orders,), of evenly spaced samples over ``revolutions``.

    0 at orders the cycle does not hold.

    >>> phi = 2 * np.pi * np.arange(8) / 8
    >>> bool(abs(harmonics(3 * np.cos(phi + 0.5), 1, np.array([1.0]))[0] - 3 * np.exp(0.5j)) < 1e-12)
    True
    """
    lines = np.asarray(orders) * revolutions
    whole = np.rint(lines).astype(int)
    found = 2 * np.fft.rfft(samples) / len(samples)
    held = (np.abs(lines - whole) < 1e-9) & (whole < (len(samples) + 1) // 2)
    return np.where(held, found[np.where(held, whole, 0)], 0)
