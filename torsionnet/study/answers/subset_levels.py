"""The levels of a subset simulation, found by one run of it, and the chains that walk within them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.answers.point_functions import OfPoints

LEVEL = 0.1
"""Share of the variants of a level that begin the chains of the next."""
LENGTH = 10
"""Of a chain."""
MOST_LEVELS = 30
FIRST_SPREAD = 0.6
ACCEPTED = 0.44
"""Share of moves that should be accepted."""


@dataclass(frozen=True, eq=False)
class SubsetLevels:
    """What a first run found.

    Attributes
    ----------
    bounds, spreads : tuple of float
        Margin below which each subset is, and how far chains move in it; the last bound is 0 where failures were met.
    failures : (m, d) array
        Points that failed, distributed about as failures are.
    on_the_way : tuple of arrays
        Points (m, d) that were the first of each further subset.
    probability : float
        A rough estimate.
    evaluations : int
    """

    bounds: tuple[float, ...]
    spreads: tuple[float, ...]
    failures: FloatArray
    on_the_way: tuple[FloatArray, ...]
    probability: float
    evaluations: int


def subset_levels(margin: OfPoints, count: int, d: int, numbers: np.random.Generator) -> SubsetLevels:
    """Levels such that about a tenth of the ``count`` variants of each is in the next."""
    points = numbers.standard_normal((1, count, d))
    values = margins_of(margin, points)
    bounds: list[float] = []
    spreads: list[float] = []
    on_the_way: list[FloatArray] = []
    used, spread = count, FIRST_SPREAD
    while len(bounds) < MOST_LEVELS:
        order = np.argsort(values[0], kind="stable")[: round(LEVEL * count)]
        bound = max(0.0, float(values[0, order[-1]]))
        if bound > 0 and values.max() <= bound:
            break
        bounds.append(bound)
        spreads.append(spread)
        if bound == 0:
            break
        on_the_way.append(points[0, order])
        chains = Chains(margin, points[:, order], values[:, order], bound, numbers)
        points, values = chains.walked(spread, adapt=True)
        spreads[-1] = spread = chains.spread
        used += count - len(order)
    failed = values[0] <= 0
    probability = LEVEL ** (len(bounds) - 1) * float(failed.mean()) if bounds else 0.0
    return SubsetLevels(tuple(bounds), tuple(spreads), points[0][failed], tuple(on_the_way), probability, used)


def margins_of(margin: OfPoints, points: FloatArray) -> FloatArray:
    """Margins of points (..., d); what has no value has failed."""
    values = margin(points.reshape(-1, points.shape[-1])).reshape(points.shape[:-1])
    return np.where(np.isnan(values), -np.inf, values)


@dataclass(eq=False)
class Chains:
    """Markov chains from points (runs, chains, d) with margins (runs, chains), all of them within ``bound``."""

    margin: OfPoints
    points: FloatArray
    values: FloatArray
    bound: float
    numbers: np.random.Generator
    spread: float = FIRST_SPREAD

    def walked(self, spread: float, *, adapt: bool = False) -> tuple[FloatArray, FloatArray]:
        """All points of all chains and their margins, those at which they begin included."""
        points, values, self.spread = self.points, self.values, spread
        all_points, all_values = [points], [values]
        for _ in range(LENGTH - 1):
            moves = self.numbers.standard_normal(points.shape)
            tried = np.sqrt(1 - self.spread**2) * points + self.spread * moves
            reached = margins_of(self.margin, tried)
            inside = reached <= self.bound
            points = np.where(inside[:, :, None], tried, points)
            values = np.where(inside, reached, values)
            all_points.append(points)
            all_values.append(values)
            if adapt:
                self.spread = float(np.clip(self.spread * np.exp(inside.mean() - ACCEPTED), 0.02, 0.999))
        return np.concatenate(all_points, axis=1), np.concatenate(all_values, axis=1)
