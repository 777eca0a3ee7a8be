"""Polynomials of guards between two points of the finer grid: where one falls below zero for the first time.

These functions are plain Python; :mod:`.compiled_march` compiles them where numba is installed.
"""

from __future__ import annotations

from typing import Any

DEGREE = 12
"""Degree of the Taylor polynomials between the points of the finer grid, on which nothing turns by more than 0.25 rad:
what they leave out is below 0.25^13/13! = 2e-18."""
MOST_NEWTON_STEPS = 60
"""Most steps of Newton's method with bisection: bisection alone reaches rounding in 53."""
LAST_STEP = 5e-17
"""Part of a step of the grid by which Newton's method may still move when it ends: a rounding of the finer grid."""

ASTRAY = 1e3
"""Roundings by which a guard that has just come into force may lie below zero: states of motion are the rounded results
of many steps, and of terms larger than those of the guard."""
AT_ONCE = 1e-4
"""Part of a step of the grid after which such a guard lies above zero if it rises."""


def numbers_of(coefficients: Any) -> Any:
    """Coefficients of a polynomial as a list, which loops in Python read quicker than an array."""
    return coefficients.tolist()


def polynomial_at(coefficients: Any, at: float) -> float:
    """Value of a polynomial with ascending coefficients."""
    value = 0.0
    for k in range(DEGREE, -1, -1):
        value = value * at + coefficients[k]
    return value


def slope_at(coefficients: Any, at: float) -> float:
    """Derivative of a polynomial with ascending coefficients."""
    value = 0.0
    for k in range(DEGREE, 0, -1):
        value = value * at + k * coefficients[k]
    return value


def curvature_at(coefficients: Any, at: float) -> float:
    """Second derivative of a polynomial with ascending coefficients."""
    value = 0.0
    for k in range(DEGREE, 1, -1):
        value = value * at + k * (k - 1) * coefficients[k]
    return value


def root_between(coefficients: Any, above: float, below: float) -> float:
    """Place where a polynomial falls below zero, between one where it is positive and a later one where it is not."""
    at = 0.5 * (above + below)
    for _ in range(MOST_NEWTON_STEPS):
        value = polynomial_at(coefficients, at)
        if value > 0:
            above = at
        else:
            below = at
        slope = slope_at(coefficients, at)
        following = at - value / slope if slope != 0 else below
        if abs(following - at) <= LAST_STEP:
            break
        if not above < following < below:
            following = 0.5 * (above + below)
        at = following
    return at


def turning_point(coefficients: Any, first: float, last: float) -> float:
    """Place between two where the derivative of a polynomial changes its sign."""
    rising = slope_at(coefficients, last) > 0
    at = 0.5 * (first + last)
    for _ in range(MOST_NEWTON_STEPS):
        slope = slope_at(coefficients, at)
        if (slope > 0) == rising:
            last = at
        else:
            first = at
        bend = curvature_at(coefficients, at)
        following = at - slope / bend if bend != 0 else last
        if abs(following - at) <= LAST_STEP:
            break
        if not first < following < last:
            following = 0.5 * (first + last)
        at = following
    return at


def first_root(coefficients: Any, length: float, rounding: float) -> float:
    """First place from 0 to ``length`` where a guard falls below zero by more than rounding, or -1.

    One that begins a little below zero and rises above it at once, as a slip that has just begun, has not fallen.
    """
    begin, start = 0.0, coefficients[0]
    if start < -rounding:
        begin, below = AT_ONCE, start
        start = polynomial_at(coefficients, begin)
        if below < -ASTRAY * rounding or start <= 0:
            return 0.0
        if begin >= length:
            return -1.0
    end = polynomial_at(coefficients, length)
    rising, rises = slope_at(coefficients, begin) > 0, slope_at(coefficients, length) > 0
    above, below = begin, length
    if end >= -rounding:
        if rising or not rises:
            return -1.0
        below = turning_point(coefficients, begin, length)
        if polynomial_at(coefficients, below) >= -rounding:
            return -1.0
    if start <= rounding:
        if not rising or rises:
            return begin
        above = turning_point(coefficients, begin, below)
        if polynomial_at(coefficients, above) <= 0:
            return above
    return root_between(coefficients, above, below)
