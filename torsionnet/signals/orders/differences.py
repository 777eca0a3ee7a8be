"""Differences of measured and calculated orders, as intervals let expect them or as one turn or delay explains them."""

from __future__ import annotations

import math

import numpy as np
import scipy

from torsionnet.linear.frequency_response import ComplexArray, FloatArray

# Whether differences between measured and calculated orders are no larger than their intervals let one expect.

NORMAL_95 = 1.959963984540054
"""Half width of the 95 % interval of a normal variable, in standard deviations."""
PROBABILITY = 0.95
"""Probability with which a true model is said to agree."""
NORMAL_FROM = 10.0
"""Ratio of an amplitude to its standard deviation from which the amplitude counts as normal: the error is 0.005 of a
deviation."""
SAFE_PROBABILITY = 1e-12
"""Probability nearer to 0 or 1 than which a normal score is not taken from it: the digits of the probability end."""


def complex_scores(measured: ComplexArray, calculated: ComplexArray, half_widths: FloatArray) -> ComplexArray:
    """Differences of complex amplitudes over the standard deviation of a part, without unit, shape (n,)."""
    return np.asarray((measured - calculated) * NORMAL_95 / half_widths)


def amplitude_scores(measured: FloatArray, calculated: FloatArray, half_widths: FloatArray) -> FloatArray:
    """Normal scores of measured amplitudes whose true values are the calculated ones, without unit, shape (n,).

    The amplitude of a complex value with normal errors in both parts follows the Rice distribution: near zero it is
    not normal and too large in the mean.

    Examples
    --------
    >>> amplitude_scores(np.array([12.0]), np.array([10.0]), np.array([1.96])).round(2).tolist()
    [1.95]
    """
    sigma = half_widths / NORMAL_95
    size, true = measured / sigma, calculated / sigma
    # An amplitude with noise in both parts follows Rice's law, of mean true + 1/(2 true) where it is large.
    scores = size - true - 0.5 / np.maximum(true, 1.0)
    near = (true < NORMAL_FROM) & (size < 2 * NORMAL_FROM)
    if near.any():
        # Near 0 exactly: its square is noncentral chi squared with 2 degrees of freedom.
        below = scipy.special.chndtr(size[near] ** 2, 2, true[near] ** 2)
        inside = (below > SAFE_PROBABILITY) & (below < 1 - SAFE_PROBABILITY)
        scores[near] = np.where(inside, scipy.special.ndtri(np.clip(below, SAFE_PROBABILITY, 1.0)), scores[near])
    return np.asarray(scores)


def independent_points(scores: ComplexArray | FloatArray) -> float:
    """Number of independent ones among scores in a row, from the correlation of neighbours, at least 1.

    Values of a tracker overlap in time. The sum of squares of a first-order autoregressive row with correlation r
    scatters as that of n (1 - r^2)/(1 + r^2) independent values.

    Examples
    --------
    >>> round(independent_points(np.array([1.0, 1, 1, 1, 1, -1, -1, -1, -1, -1])), 1)
    3.4
    """
    total = float((np.abs(scores) ** 2).sum())
    if len(scores) < 2 or not total:
        return float(max(len(scores), 1))
    near = float((scores[1:] * np.conj(scores[:-1])).real.sum()) / total
    # Squares of scores correlate by rho^2 from one to the next, and are worth that many independent ones.
    return max(1.0, len(scores) * (1 - near**2) / (1 + near**2))


def consistent(scores: ComplexArray | FloatArray, fitted: int = 0) -> bool:
    """Whether scores are as small as those of a true model in 95 of 100 tests, after ``fitted`` numbers were fitted.

    The mean square of all values is compared with the quantile of chi-square, with as many degrees of freedom as
    there are independent points (two for complex values).

    Examples
    --------
    >>> consistent(np.array([0.5, -1.0, 1.2])), consistent(np.array([2.5, -3.0, 2.2]))
    (True, False)
    """
    per_point = 2 if np.iscomplexobj(scores) else 1
    # Sum of squares over its degrees of freedom against chi-square: only independent points count.
    degrees = max(1.0, per_point * independent_points(scores) - fitted)
    left = max(1.0, per_point * len(scores) - fitted)
    mean = float((np.abs(scores) ** 2).sum()) / left
    return bool(mean <= scipy.special.chdtri(degrees, 1 - PROBABILITY) / degrees)


# Search for the one angle or time delay that turns calculated orders onto measured ones.

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
