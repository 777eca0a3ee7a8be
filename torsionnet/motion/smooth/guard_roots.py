"""First event within a step of a Runge-Kutta method: where a guard falls below zero, also between two points."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
import scipy
from numpy.polynomial import chebyshev

from torsionnet.linear.assembly.rows import FloatArray

NODES = 13
"""Number of Chebyshev points in a step, on which a polynomial of degree 12 is exact: dense output has degree 7."""
GUARD_ROUNDING = 1e-12
"""Share of the sizes of its terms up to which a guard counts as zero."""


@lru_cache(maxsize=1)
def nodes() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Places (NODES,) from 0 to 1, weights of Clenshaw and Curtis over them, and the matrix to Chebyshev coefficients.

    >>> places, weights, _ = nodes()
    >>> round(float(weights @ places**9), 15)
    0.1
    """
    x = -np.cos(np.pi * np.arange(NODES) / (NODES - 1))
    matrix = np.linalg.inv(chebyshev.chebvander(x, NODES - 1))
    integrals = np.array([2 / (1 - k**2) if k % 2 == 0 else 0.0 for k in range(NODES)])
    return (x + 1) / 2, np.asarray(integrals @ matrix / 2), np.asarray(matrix)


def first_event(values: FloatArray, sizes: FloatArray, guard_at: Callable[[int, float], float]) -> tuple[float, int]:
    """Place from 0 to 1 in a step of the first event, and the number of its guard; (-1, -1) without one.

    Parameters
    ----------
    values : (n_g, NODES) array
        Guards at the nodes.
    sizes : (n_g,) array
        Sizes of the terms of each guard.
    guard_at : callable
        Value of a guard at a place in the step.
    """
    found, which = -1.0, -1
    swing = np.abs(np.diff(values, axis=1)).max(axis=1)
    for guard in np.flatnonzero(values.min(axis=1) <= swing + GUARD_ROUNDING * sizes).tolist():
        place = _first_root(values[guard], GUARD_ROUNDING * float(sizes[guard]), guard, guard_at)
        if place >= 0 and (which < 0 or place < found):
            found, which = place, guard
    return found, which


def _first_root(values: FloatArray, rounding: float, guard: int, guard_at: Callable[[int, float], float]) -> float:
    if values[0] < -rounding:
        return 0.0
    series = nodes()[2] @ values
    turning = chebyshev.chebroots(chebyshev.chebder(series)) if np.abs(series[2:]).max() > 0 else np.zeros(0)
    inside = sorted(float(one.real + 1) / 2 for one in np.atleast_1d(turning) if _is_inside(one))
    last, positive = 0.0, values[0] > rounding
    for place in (*inside, 1.0):
        value = float(values[-1]) if place == 1.0 else float(chebyshev.chebval(2 * place - 1, series))
        if value < -rounding:
            if not positive:
                return last
            return _refined(guard, last, place, guard_at)
        if value > rounding:
            last, positive = place, True
    return -1.0


def _is_inside(root: complex) -> bool:
    return abs(root.imag) < 1e-6 and -1 < root.real < 1


def _refined(guard: int, above: float, below: float, guard_at: Callable[[int, float], float]) -> float:
    """Place between one where a guard is positive and one where it is not."""
    if guard_at(guard, above) <= 0:
        return above
    if guard_at(guard, below) > 0:
        return below
    return float(scipy.optimize.brentq(lambda place: guard_at(guard, place), above, below, xtol=1e-16, rtol=1e-15))
