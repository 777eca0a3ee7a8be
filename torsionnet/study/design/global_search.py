"""Global search of designs within bounds by an even spread of samples, and differential evolution from them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.design.design_problem import DesignProblem

MOST_GENERATIONS = 60
"""Most generations of designs in differential evolution, after which a local search goes on."""
SCALE, CROSSOVER = (0.5, 1.0), 0.7
"""Scale factor of differential evolution, drawn from this range in each generation, and its crossover rate."""
PER_PARAMETER, FEWEST_MEMBERS = 12, 24
"""Designs in a population for each parameter, and fewest designs, as fewer find fewer optima and more take longer."""
START_DISTANCE = 0.05
"""Smallest distance in the unit cube between starts of local searches, as nearer ones mostly find the same optimum."""
VIOLATION_MERIT = 1e30
"""Merit of a design that violates limits, times one plus the violation, worse than of any design that keeps them."""
CONVERGED_SPREAD = 1e-4
"""Standard deviation of a population's merits over their mean at which evolution stops, the rest being local search."""


def initial_places(problem: DesignProblem) -> FloatArray:
    """Points (n, n_p) of the unit cube, the given design and an even spread, the best first."""
    size = len(problem.parameters)
    count = 1 << int(np.ceil(np.log2(max(FEWEST_MEMBERS, PER_PARAMETER * size))))
    spread = scipy.stats.qmc.Sobol(size, scramble=False).random(count)
    places = np.vstack([problem.start, np.clip(spread, 0.5 / count, 1 - 0.5 / count)])
    ranks = problem.ranks(problem.at(places))
    return places[sorted(range(len(places)), key=lambda index: ranks[index])]


def distant_places(places: FloatArray, count: int) -> list[FloatArray]:
    """First ``count`` points of the unit cube that are not near each other, each (n_p,)."""
    chosen: list[FloatArray] = []
    for place in places:
        if all(np.abs(place - other).max() > START_DISTANCE for other in chosen):
            chosen.append(place)
        if len(chosen) == count:
            break
    return chosen


def evolve(
    problem: DesignProblem, places: FloatArray, seed: int, each: Callable[[float], None], generations: int
) -> FloatArray:
    """Best point (n_p,) of the unit cube after some generations of differential evolution.

    ``each`` is called with every best merit.

    A generation is calculated as a whole. Of two designs the one that violates limits less is the better one. Mutants
    start from the best design (R. Storn and K. Price, J. Global Optim. 11 (1997) 341, best/1/bin).
    """
    from scipy.optimize import Bounds, OptimizeResult, differential_evolution

    size = len(problem.parameters)
    crowd = places[: max(FEWEST_MEMBERS, PER_PARAMETER * size)]

    def merits(columns: FloatArray) -> Any:
        over, merit = np.array(problem.ranks(problem.at(columns.T))).T
        return np.where(over > 0, VIOLATION_MERIT * (1 + over), merit)

    def report(intermediate_result: OptimizeResult) -> None:
        each(float(intermediate_result.fun))

    found = differential_evolution(
        merits, Bounds(np.zeros(size), np.ones(size)), strategy="best1bin", mutation=SCALE, recombination=CROSSOVER,
        init=crowd, maxiter=generations, tol=CONVERGED_SPREAD, atol=0, polish=False, vectorized=True,
        updating="deferred", rng=seed, callback=report,
    )  # fmt: skip
    return np.asarray(found.x)
