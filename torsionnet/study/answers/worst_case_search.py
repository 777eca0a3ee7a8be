"""Global search of the largest value of a function in the unit cube, checked against random points."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from torsionnet.base.errors import SolveError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer_case import OfPoints

MOST_WITH_ALL_CORNERS = 10
"""Most parameters with which all corners of the cube are tried, 1024 for ten, as each further one doubles them."""
RANDOM_CORNERS = 1024
"""Number of random corners of the cube that are tried if there are too many for all, as many as ten parameters have."""
POPULATION, GENERATIONS = 10, 150
"""Members for each parameter, and most generations, of the differential evolution that seeks the worst case."""
SLOPE_STEP = 1e-5
"""Step of slopes by differences in the unit cube, and the distance below which two points count as one."""
POLISHED = 6
"""Number of the best points from which slopes are followed, as more find further maxima and take longer."""
AT_BOUND = 1e-6
"""Distance from a bound in the unit cube within which a parameter is said to lie at the bound."""
MOST_ROUNDS = 5
"""Most rounds of the worst-case search in which a random point beats the best found, before it is given up."""
BETTER_BY = 1e-9
"""Share of the range of values by which a random point must be better to count, as less is rounding."""


@dataclass(frozen=True, eq=False)
class Extreme:
    """Largest value of a function that the search found, and its point in the unit cube.

    ``point`` (d,) is in the unit cube, ``tried_at_random`` the number of random points none of which is better,
    ``best_at_random`` the best of them.
    """

    point: FloatArray
    value: float
    evaluations: int
    tried_at_random: int
    best_at_random: float
    at_lower: tuple[int, ...]
    at_upper: tuple[int, ...]


def largest(function: OfPoints, n_parameters: int, *, seed: int, tried: int = 10_000) -> Extreme:
    """Search the largest value of a function in the unit cube, leaving out points without a value (NaN).

    Corners, a differential evolution, and from the best points along slopes and into bounds; then ``tried`` random
    points: where one of them is better the search goes on from there.

    Raises
    ------
    SolveError
        No point has a value, or random points beat the search again and again.
    """
    search = _Search(function, n_parameters, np.random.default_rng(seed))
    search.corners()
    search.evolve()
    for _ in range(MOST_ROUNDS):
        search.polish()
        points = search.numbers.random((tried, n_parameters))
        values = search.values(points)
        best = int(values.argmax())
        if values[best] <= search.best + BETTER_BY * search.range:
            return search.result(tried, float(values[best]))
        search.offer(points, values)
    raise SolveError(f"random points beat the search {MOST_ROUNDS} times; the function is too rough for it")


class _Search:
    """Best points in the unit cube so far, best first, and the methods that find better ones."""

    def __init__(self, function: OfPoints, d: int, numbers: np.random.Generator) -> None:
        self.function, self.d, self.numbers = function, d, numbers
        self.evaluations = 0
        self.points, self.found = np.zeros((0, d)), np.zeros(0)
        self.lowest = np.inf

    @property
    def best(self) -> float:
        return float(self.found[0])

    @property
    def range(self) -> float:
        return max(self.best - self.lowest, abs(self.best) * 1e-6)

    def values(self, points: FloatArray) -> FloatArray:
        values = self.function(points)
        self.evaluations += len(points)
        finite = values[np.isfinite(values)]
        self.lowest = min(self.lowest, float(finite.min(initial=np.inf)))
        return np.where(np.isnan(values), -np.inf, values)

    def offer(self, points: FloatArray, values: FloatArray) -> None:
        """Keep the best of the points given and those found before, each once."""
        points, values = np.concatenate([self.points, points]), np.concatenate([self.found, values])
        order = np.argsort(-values, kind="stable")
        kept: list[int] = []
        for index in order[: 50 * POLISHED]:
            if all(np.abs(points[index] - points[other]).max() > SLOPE_STEP for other in kept):
                kept.append(int(index))
            if len(kept) == POLISHED:
                break
        self.points, self.found = points[kept], values[kept]

    def corners(self) -> None:
        """Try the middle and all corners of the unit cube, or random corners where there are too many."""
        if self.d <= MOST_WITH_ALL_CORNERS:
            points = np.array(list(product((0.0, 1.0), repeat=self.d)))
        else:
            points = self.numbers.integers(0, 2, size=(RANDOM_CORNERS, self.d)).astype(float)
        points = np.concatenate([points, np.full((1, self.d), 0.5)])
        self.offer(points, self.values(points))
        if not np.isfinite(self.best):
            raise SolveError(
                "none of the corners of the tolerances has a value; narrow the tolerances, or try one corner alone"
            )
        if self.d > MOST_WITH_ALL_CORNERS:
            self._into_bounds()

    def evolve(self) -> None:
        from scipy.optimize import Bounds, differential_evolution

        def negative(columns: FloatArray) -> Any:
            values = self.values(columns.T)
            return -np.where(np.isfinite(values), values, self.lowest - self.range)

        found = differential_evolution(
            negative, Bounds(np.zeros(self.d), np.ones(self.d)), vectorized=True, updating="deferred", polish=False,
            rng=self.numbers, popsize=POPULATION, maxiter=GENERATIONS, init="sobol", tol=1e-6,
        )  # fmt: skip
        self.offer(found.population, -found.population_energies)

    def polish(self) -> None:
        from scipy.optimize import minimize

        for point in self.points:
            found = minimize(self._with_slopes, point, jac=True, method="L-BFGS-B", bounds=[(0.0, 1.0)] * self.d)
            self.offer(found.x[None], self.values(found.x[None]))
        self._into_bounds()

    def _with_slopes(self, point: FloatArray) -> tuple[float, FloatArray]:
        """Negative value of the function at a point (d,) of the unit cube, and its slopes (d,) by differences."""
        above, below = np.minimum(point + SLOPE_STEP, 1), np.maximum(point - SLOPE_STEP, 0)
        moved = [np.where(np.eye(self.d, dtype=bool), side, point) for side in (above, below)]
        values = self.values(np.concatenate([point[None], *moved]))
        slopes = np.nan_to_num((values[1 : self.d + 1] - values[self.d + 1 :]) / (above - below))
        return float(-values[0] if np.isfinite(values[0]) else self.range - self.lowest), -slopes

    def _into_bounds(self) -> None:
        """Move parameters of the best point to a bound, one at a time, as long as the value rises."""
        for _ in range(2 * self.d):
            moved = [np.where(np.eye(self.d, dtype=bool), side, self.points[0]) for side in (0.0, 1.0)]
            points = np.concatenate(moved)
            values = self.values(points)
            if values.max() <= self.best:
                return
            self.offer(points, values)

    def result(self, tried: int, best_at_random: float) -> Extreme:
        point = self.points[0]
        lower, upper = np.flatnonzero(point <= AT_BOUND), np.flatnonzero(point >= 1 - AT_BOUND)
        return Extreme(
            point, self.best, self.evaluations, tried, best_at_random, tuple(lower.tolist()), tuple(upper.tolist())
        )
