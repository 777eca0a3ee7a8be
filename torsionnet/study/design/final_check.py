"""Whether a design that only one search came to is the best nearby: what lies beside it is tried."""

from __future__ import annotations

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.design.design_optimum import REACHED
from torsionnet.study.design.design_problem import DesignProblem, Rank
from torsionnet.study.design.local_search import polished

EQUAL = 1e-6
"""Relative difference of merits that are equally good."""
DISTANCES = 1e-2 * 0.25 ** np.arange(9)
"""Of the unit cube: of designs beside the best, down to where merits are equal."""
ROUNDS = 10
"""Of steps to better designs, after which a search that still finds some has not settled."""


def as_good(problem: DesignProblem, one: Rank, best: Rank) -> bool:
    """Whether a design is as good as the best one, but for rounding and what a search leaves."""
    if one[0] > best[0] * (1 + EQUAL):
        return False
    if problem.goals.targets:
        return one[1] <= max(REACHED**2, best[1] * (1 + EQUAL))
    return one[1] - best[1] <= EQUAL * abs(best[1])


def checked(problem: DesignProblem, place: FloatArray, seed: int) -> tuple[FloatArray, bool]:
    """The best design beside ``place``, which it is itself as a rule, and whether no other there is better.

    Designs are tried at several distances along every parameter and in as many directions between them, and one more
    search begins beside the place.
    """
    draw = np.random.default_rng(seed)
    rank = problem.ranks(problem.at(place))[0]
    for _ in range(ROUNDS):
        other, found = _best_beside(problem, place, draw)
        if found >= rank:
            return place, True
        enough = as_good(problem, rank, found)
        place, rank = other, found
        if enough:
            return place, True
    return place, False


def _best_beside(problem: DesignProblem, place: FloatArray, draw: np.random.Generator) -> tuple[FloatArray, Rank]:
    size = len(place)
    between = draw.standard_normal((size, size))
    ways = np.concatenate([np.eye(size), between / np.linalg.norm(between, axis=1, keepdims=True)])
    beside = np.clip(place + DISTANCES[:, None, None] * np.concatenate([ways, -ways]), 0.0, 1.0)
    ranks = problem.ranks(problem.at(beside.reshape(-1, size)))
    farthest = min(range(4 * size), key=ranks.__getitem__)
    nearest = min(range(len(ranks)), key=ranks.__getitem__)
    tried = np.array([beside.reshape(-1, size)[nearest], polished(problem, beside[0, farthest])])
    found = problem.ranks(problem.at(tried))
    best = min(range(2), key=found.__getitem__)
    return tried[best], found[best]
