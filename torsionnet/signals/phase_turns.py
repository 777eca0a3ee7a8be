"""Search for the one angle or time delay that turns calculated orders onto measured ones."""

from __future__ import annotations

import math

import numpy as np

from torsionnet.linear.frequency_response import ComplexArray, FloatArray

LONGEST_DELAY = 0.2
"""Longest time delay in s that is looked for: telemetry and filters of test systems take some 0.1 to 100 ms."""
GRID_STEP = 0.5
"""Step of the search in rad of the fastest turning value; the maximum looked for is some 2 rad wide."""
MOST_POINTS = 400
"""Largest number of values that take part in the search, evenly taken from more: enough for an angle to a tenth of the
interval of one value."""
REFINEMENTS = 3
"""Number of Newton steps from the best point of the grid; each squares the relative error."""


def best_turn(rates: FloatArray, products: ComplexArray, low: float, high: float) -> float:
    """Number p from low to high for which Re sum products exp(-j rates p) is largest, in units of 1/rates.

    Parameters
    ----------
    rates : (n,) array
        Orders for an angle in rad, minus angular frequencies in rad/s for a delay in s.
    products : (n,) complex array
        conj(calculated) measured, weighted.
    low, high : float

    Examples
    --------
    >>> order = np.array([0.5, 3.0, 6.0])
    >>> round(best_turn(order, np.exp(1j * order * 0.3), -6.0, 6.0), 9)
    0.3
    """
    step = -(-len(rates) // MOST_POINTS)
    rates, products = rates[::step], products[::step]
    fastest = float(np.abs(rates).max())
    count = max(2, math.ceil((high - low) * fastest / GRID_STEP))
    grid = np.linspace(low, high, count)
    heights = np.zeros(count)
    for rate, product in zip(rates.tolist(), products.tolist(), strict=True):
        heights += (product * np.exp(-1j * rate * grid)).real
    best = float(grid[heights.argmax()])
    for _ in range(REFINEMENTS):
        # Newton's step: slope sum rates Im(turned) over bend sum rates^2 Re(turned).
        turned = products * np.exp(-1j * rates * best)
        bend = float((rates**2 * turned.real).sum())
        if bend <= 0:
            break
        best += float((rates * turned.imag).sum()) / bend
    return best
