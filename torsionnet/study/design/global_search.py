"""Good beginnings everywhere within bounds: a spread of samples, and a population that evolves from them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.stats import qmc

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.design.design_problem import DesignProblem

GENERATIONS = 60
"""At most, of a population."""
SCALE, CROSSOVER = (0.5, 1.0), 0.7
"""Range of the factor of differences, drawn for each generation, and share of coordinates that a mutant brings."""
PER_PARAMETER, FEWEST = 12, 24
"""Members of a population."""
APART = 0.05
"""Of the unit cube: beginnings that are nearer to a better one are left out."""
SPREAD = 1e-3
"""Relative spread of a population that has converged; what is left is for a local search."""


def samples(problem: DesignProblem) -> FloatArray:
    """The start and an even spread (n, n_p), the best first."""
    size = len(problem.parameters)
    count = 1 << int(np.ceil(np.log2(max(FEWEST, PER_PARAMETER * size))))
    spread = qmc.Sobol(size, scramble=False).random(count)
    places = np.vstack([problem.start, np.clip(spread, 0.5 / count, 1 - 0.5 / count)])
    ranks = problem.ranks(problem.at(places))
    return places[sorted(range(len(places)), key=lambda index: ranks[index])]


def apart(places: FloatArray, count: int) -> list[FloatArray]:
    """So many of the first that are not near each other."""
    chosen: list[FloatArray] = []
    for place in places:
        if all(np.abs(place - other).max() > APART for other in chosen):
            chosen.append(place)
        if len(chosen) == count:
            break
    return chosen


def evolved(
    problem: DesignProblem, places: FloatArray, seed: int, each: Callable[[float], None], generations: int
) -> FloatArray:
    """The best place after some generations of differential evolution; ``each`` is told their merit.

    A generation is calculated as a whole. Of two designs the one that violates limits less is the better one. Mutants
    start from the best design (R. Storn and K. Price, J. Global Optim. 11 (1997) 341, best/1/bin).
    """
    size, draw = len(problem.parameters), np.random.default_rng(seed)
    crowd = places[: max(FEWEST, PER_PARAMETER * size)].copy()
    count, rank = len(crowd), np.array(problem.ranks(problem.at(crowd)))
    for _ in range(generations):
        best = int(np.lexsort(rank.T[::-1])[0])
        each(float(rank[best, 1]))
        spread = np.ptp(rank, axis=0)
        if spread[0] == 0 and spread[1] <= SPREAD * abs(rank[best, 1]):
            break
        first, second = ((np.arange(count) + draw.integers(1, count, count)) % count for _ in range(2))
        mutants = crowd[best] + draw.uniform(*SCALE) * (crowd[first] - crowd[second])
        outside = (mutants < 0) | (mutants > 1)
        mutants = np.where(outside, draw.random(mutants.shape), mutants)
        kept = draw.random(mutants.shape) >= CROSSOVER
        kept[np.arange(count), draw.integers(0, size, count)] = False
        mutants = np.where(kept, crowd, mutants)
        found = np.array(problem.ranks(problem.at(mutants)))
        better = (found[:, 0] < rank[:, 0]) | ((found[:, 0] == rank[:, 0]) & (found[:, 1] <= rank[:, 1]))
        crowd[better], rank[better] = mutants[better], found[better]
    return np.asarray(crowd[int(np.lexsort(rank.T[::-1])[0])])
