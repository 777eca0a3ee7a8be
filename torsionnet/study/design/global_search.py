"""Good beginnings everywhere within bounds: a spread of samples, and a population that evolves from them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

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
BEYOND = 1e30
"""Merit of a design that violates limits, times one more than by how much: behind all that keep them."""
SPREAD = 1e-4
"""Standard deviation of the merits of a converged population, of their mean; the rest is for a local search."""


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
    """Best place (n_p,) after some generations of differential evolution; ``each`` is told their merit.

    A generation is calculated as a whole. Of two designs the one that violates limits less is the better one. Mutants
    start from the best design (R. Storn and K. Price, J. Global Optim. 11 (1997) 341, best/1/bin).
    """
    from scipy.optimize import Bounds, OptimizeResult, differential_evolution

    size = len(problem.parameters)
    crowd = places[: max(FEWEST, PER_PARAMETER * size)]

    def merits(columns: FloatArray) -> Any:
        over, merit = np.array(problem.ranks(problem.at(columns.T))).T
        return np.where(over > 0, BEYOND * (1 + over), merit)

    def told(intermediate_result: OptimizeResult) -> None:
        each(float(intermediate_result.fun))

    found = differential_evolution(
        merits, Bounds(np.zeros(size), np.ones(size)), strategy="best1bin", mutation=SCALE, recombination=CROSSOVER,
        init=crowd, maxiter=generations, tol=SPREAD, atol=0, polish=False, vectorized=True, updating="deferred",
        rng=seed, callback=told,
    )  # fmt: skip
    return np.asarray(found.x)
