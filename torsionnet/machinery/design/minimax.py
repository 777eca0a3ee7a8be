"""Search for parameter values within bounds for which the largest vibration level is smallest.

Parameter values within bounds for which the largest level is smallest.

Levels at some points become constraints, log level <= t with t to be made small, which sequential quadratic programming
solves; the maxima of the curve for its answer are new points, until none is higher than t.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.design.levels import Levels

CONSTRAINT_ROUNDS, PROGRAMMING_STEPS = 40, 60
"""Most rounds that add constraint points in a minimax search, and most steps of quadratic programming in each, which
bound its time."""
SAMPLED_STARTS, SEARCHED_STARTS = 16, 2
"""Number of sampled starts of a minimax search, doubled for each parameter after the first, and how many of the best
are searched."""
FIRST_CONSTRAINTS = 40
"""Number of points of the range that are constraints of a minimax search from the beginning, as fewer cost more
rounds."""
WIDE_BOUNDS_RATIO = 3.0
"""Ratio of upper to lower bound above which a parameter is searched in equal factors and not in equal steps."""
SMALLEST_LEVEL = 1e-300
"""Level added before logarithms are taken, near the smallest double, so that a level of zero has one."""
GRADIENT_PRECISION, TOLERANCE_POWER = 1e-8, 1.3
"""Relative precision of levels up to which gradients are used, and power of it at which quadratic programming stops, as
less is rounding."""


@dataclass(frozen=True, eq=False)
class Box:
    """Bounds (n_p,) of the parameters in SI units, mapped to the unit cube in which the search runs.

    >>> Box(np.array([1.0, -1.0]), np.array([100.0, 1.0])).inside(np.array([0.5, 0.25])).tolist()
    [10.0, -0.5]
    """

    lower: FloatArray
    upper: FloatArray

    @property
    def _by_factors(self) -> NDArray[np.bool_]:
        return np.asarray((self.lower > 0) & (self.upper > WIDE_BOUNDS_RATIO * self.lower))

    def inside(self, place: FloatArray) -> FloatArray:
        """Parameter values (n_p,) in SI units at a place (n_p,) in the unit cube."""
        with np.errstate(divide="ignore", invalid="ignore"):
            factors = self.lower * (self.upper / self.lower) ** place
        values = np.where(self._by_factors, factors, self.lower + place * (self.upper - self.lower))
        return np.clip(values, self.lower, self.upper)

    def place(self, values: FloatArray) -> FloatArray:
        """Place (n_p,) in the unit cube of parameter values, or of the nearest ones within the bounds."""
        clipped = np.clip(values, self.lower, self.upper)
        with np.errstate(divide="ignore", invalid="ignore"):
            factors = np.log(clipped / self.lower) / np.log(self.upper / self.lower)
        return np.where(self._by_factors, factors, (clipped - self.lower) / (self.upper - self.lower))

    def rates(self, place: FloatArray) -> FloatArray:
        """Derivatives (n_p,) of the parameters, in SI units, to their places in the unit cube from 0 to 1."""
        with np.errstate(divide="ignore", invalid="ignore"):
            # v = lower (upper/lower)^x: dv/dx = v ln(upper/lower).
            factors = self.inside(place) * np.log(self.upper / self.lower)
        return np.where(self._by_factors, factors, self.upper - self.lower)


def smallest_maximum(levels: Levels, box: Box, start: FloatArray) -> FloatArray:
    """Parameter values (n_p,) in SI units for which the largest vibration level is smallest.

    The search starts from ``start`` and from samples of the box.
    """
    if len(start) == 1 and levels.precision > GRADIENT_PRECISION:
        return _along_one(levels, box, start)
    places = [
        box.place(start),
        *scipy.stats.qmc.Sobol(len(start), scramble=False).random(SAMPLED_STARTS * 2 ** (len(start) - 1)),
    ]
    # The largest level has several minima over the box: starts are sampled roughly, and only the best are searched
    # from.
    rough = [largest(levels, box.inside(place), refined=False) for place in places]
    optima = [search_from(levels, box, places[index]) for index in np.argsort(rough, kind="stable")[:SEARCHED_STARTS]]
    return box.inside(min(optima, key=lambda place: largest(levels, box.inside(place))))


def _along_one(levels: Levels, box: Box, start: FloatArray) -> FloatArray:
    """Value (1,) of a single parameter for which the largest level is smallest, found without slopes.

    The search goes by samples and parabolas.
    """
    places = np.union1d(np.linspace(0, 1, SAMPLED_STARTS + 1), box.place(start))

    def level(place: float) -> float:
        return largest(levels, box.inside(np.array([place])), refined=False)

    # Slopes by differences are too coarse to follow: samples bracket the minimum, parabolas refine it.
    rough = [level(place) for place in places]
    at = int(np.argmin(rough))
    ends = places[max(at - 1, 0)], places[min(at + 1, len(places) - 1)]
    search: Any = scipy.optimize.minimize_scalar
    optimum = search(level, bounds=ends, method="bounded", options={"xatol": 0.1 * np.sqrt(levels.precision)})
    best = optimum.x if optimum.fun < rough[at] else places[at]
    return box.inside(np.array([float(best)]))


def largest(levels: Levels, values: FloatArray, *, refined: bool = True) -> float:
    """Largest vibration level, in its unit, over all frequencies or speeds for these parameter values (n_p,)."""
    points = levels.maxima(values)[:1] if refined else levels.grid(values)
    return float(levels.sizes_at(values, points).max())


def search_from(levels: Levels, box: Box, place: FloatArray) -> FloatArray:
    """Best place (n_p,) in the unit cube that the minimax search reaches from a starting place.

    Maxima of every step become constraints of the next.
    """
    grid = levels.grid(box.inside(place))
    points = grid[:: max(len(grid) // FIRST_CONSTRAINTS, 1)]
    best, least = place, np.inf
    for _ in range(CONSTRAINT_ROUNDS):
        maxima = levels.maxima(box.inside(place))
        level = float(np.log(levels.sizes_at(box.inside(place), maxima[:1])[0] + SMALLEST_LEVEL))
        if level < least:
            best, least = place, level
        # Exchange of constraints: maxima of this curve are held down in the next step, too.
        points = np.union1d(points, maxima)
        place, bound = _lowest_highest_level(levels, box, points, place)
        top = float(np.log(largest(levels, box.inside(place)) + SMALLEST_LEVEL))
        if top < least:
            best, least = place, top
        # bound is the least maximum over the constraints alone: a curve nowhere higher is the minimax.
        if top <= bound + levels.precision:
            break
    return best


def _lowest_highest_level(levels: Levels, box: Box, points: FloatArray, start: FloatArray) -> tuple[FloatArray, float]:
    """Place (n_p,) in the unit cube where the largest level at ``points`` is smallest, and that level's logarithm."""

    def logs(x: FloatArray) -> FloatArray:
        return np.log(levels.sizes_at(box.inside(x[:-1]), points) + SMALLEST_LEVEL)

    def slopes(x: FloatArray) -> FloatArray:
        values = box.inside(x[:-1])
        by_value = levels.slopes(values, points) / (levels.sizes_at(values, points) + SMALLEST_LEVEL)[:, None]
        return np.column_stack([-by_value * box.rates(x[:-1]), np.ones(len(points))])

    search: Any = scipy.optimize.minimize  # its published types know no constraints that are functions
    # The smallest z with z >= ln level_i(x) for all points i, in the variables (x, z): smooth where the maximum is
    # not.
    optimum = search(
        lambda x: float(x[-1]),
        np.append(start, logs(np.append(start, 0.0)).max()),
        jac=lambda x: np.append(np.zeros(len(x) - 1), 1.0),
        method="SLSQP",
        bounds=[*((0.0, 1.0) for _ in start), (None, None)],
        constraints={"type": "ineq", "fun": lambda x: x[-1] - logs(x), "jac": slopes},
        options={"ftol": levels.precision**TOLERANCE_POWER, "maxiter": PROGRAMMING_STEPS},
    )
    place = np.clip(optimum.x[:-1], 0.0, 1.0)
    return place, float(logs(np.append(place, 0.0)).max())
