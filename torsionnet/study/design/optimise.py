"""Optimisation of a design by a global search, several local searches, and verification by a single model."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import SolveError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.design.design_optimum import TARGET_MET, DesignOptimum
from torsionnet.study.design.design_problem import DesignProblem, Rank
from torsionnet.study.design.global_search import MOST_GENERATIONS, distant_places, evolve, initial_places
from torsionnet.study.design.local_search import polish

EQUAL_MERIT = 1e-6
"""Largest relative difference of two designs' merits that count as equally good, as searches end within less."""
DISTANCES = 1e-2 * 0.25 ** np.arange(9)
"""Distances in the unit cube of the designs tried beside the best one, down to where merits are equal."""
MOST_ROUNDS = 10
"""Most steps to better designs nearby, as a search that still finds better ones then has not converged."""


def as_good(problem: DesignProblem, one: Rank, best: Rank) -> bool:
    """Whether a design is as good as the best one within the tolerance of a search."""
    if one[0] > best[0] * (1 + EQUAL_MERIT):
        return False
    if problem.goals.targets:
        return one[1] <= max(TARGET_MET**2, best[1] * (1 + EQUAL_MERIT))
    return one[1] - best[1] <= EQUAL_MERIT * abs(best[1])


def check_neighbours(problem: DesignProblem, place: FloatArray, seed: int) -> tuple[FloatArray, bool]:
    """Best point of the unit cube among ``place`` and its neighbours, and whether no neighbour of that is better.

    Designs are tried at several distances along every parameter and in as many directions between them, and one more
    search begins beside the place.
    """
    draw = np.random.default_rng(seed)
    rank = problem.ranks(problem.at(place))[0]
    for _ in range(MOST_ROUNDS):
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
    tried = np.array([beside.reshape(-1, size)[nearest], polish(problem, beside[0, farthest])])
    found = problem.ranks(problem.at(tried))
    best = min(range(2), key=found.__getitem__)
    return tried[best], found[best]


BEGINNINGS, BESIDE = 5, 2
"""Number of starts of local searches for targets, and of those for an objective beside the best of a population."""
DIFFERENT_DESIGNS = 1e-3
"""Distance in the unit cube above which two designs count as different, as searches for one end closer together."""
FREE_DIRECTION = 1e-9
"""Singular value relative to the largest one below which a direction of parameters does not change the targets."""

Single = Callable[[Mapping[str, float]], Mapping[str, ArrayLike]]
"""Function from the value in SI of every parameter to the quantities of this design by a single model."""


def optimise(
    problem: DesignProblem,
    *,
    single: Single | None = None,
    seed: int = 0,
    generations: int = MOST_GENERATIONS,
    title: str = "",
) -> DesignOptimum:
    """Find the best design of a problem with targets or one objective, and verify it.

    Parameters
    ----------
    problem : DesignProblem
    single : callable, optional
        Recomputes the optimum by a single model.
    seed : int
        Seed of the population; the same seed gives the same answer.
    generations : int
        Most generations of the population.
    title : str

    Raises
    ------
    SolveError
        No design within the bounds has the quantities asked for.
    UsageError
        An unknown quantity.

    Examples
    --------
    >>> from torsionnet.machinery.design.damper_optimum import DesignParameter
    >>> from torsionnet.study.design.design_goals import DesignGoals, DesignTarget
    >>> k = DesignParameter("k", "N*m/rad", 1e3, 1e2, 1e4, 1e3)
    >>> frequency = lambda values: {"f": np.sqrt(values["k"] / 2.0) / (2 * np.pi)}
    >>> found = optimise(DesignProblem((k,), DesignGoals((DesignTarget("f", 5.0),)), frequency))
    >>> round(found.values["k"] / (2 * (10 * np.pi) ** 2), 9)
    1.0
    """
    problem.goals.require_merit()
    history: list[tuple[float, float]] = []

    def note(merit: float) -> None:
        history.append((float(problem.evaluations), min([merit, *(one for _, one in history[-1:])])))

    ordered = initial_places(problem)
    first = problem.ranks(problem.at(ordered[:1]))[0]
    if not np.isfinite(first).all():
        raise SolveError("no design within the bounds has all the quantities that are asked for")
    note(first[1])
    if problem.goals.objectives:
        begin = [evolve(problem, ordered, seed, note, generations), *distant_places(ordered, BESIDE)]
    else:
        begin = distant_places(ordered, BEGINNINGS)
    found = _each_polished(problem, begin)
    if problem.goals.targets and found[0][0] > (0.0, TARGET_MET**2):
        found = sorted(
            [*found, *_each_polished(problem, [evolve(problem, ordered, seed, note, generations)])], key=_by_rank
        )
    rank, best = found[0]
    equal = [place for other, place in found if as_good(problem, other, rank)]
    settled = len(equal) > 1
    if not settled:
        best, settled = check_neighbours(problem, best, seed)
        rank, equal = problem.ranks(problem.at(best))[0], [best]
    different = different_places(equal, DIFFERENT_DESIGNS)
    best = min(different, key=lambda place: float(np.linalg.norm(place - problem.start)))
    note(rank[1])
    others = [one for one in different if one is not best]
    return _result(problem, best, others, history, single, title, settled=settled)


def _by_rank(found: tuple[Rank, FloatArray]) -> Rank:
    return found[0]


def _each_polished(problem: DesignProblem, places: list[FloatArray]) -> list[tuple[Rank, FloatArray]]:
    polished_places = np.array([polish(problem, place) for place in places])
    ranks = problem.ranks(problem.at(polished_places))
    return sorted(zip(ranks, polished_places, strict=True), key=_by_rank)


def different_places(places: list[FloatArray], distance: float) -> list[FloatArray]:
    """Points of the unit cube, each (n_p,), that are not within ``distance`` of an earlier one."""
    kept: list[FloatArray] = []
    for place in places:
        if all(np.abs(place - other).max() > distance for other in kept):
            kept.append(place)
    return kept


def _result(
    problem: DesignProblem,
    best: FloatArray,
    others: list[FloatArray],
    history: list[tuple[float, float]],
    single: Single | None,
    title: str,
    *,
    settled: bool,
) -> DesignOptimum:
    given = problem.at(problem.start)
    after = problem.at(best)
    values = problem.values(best)
    alone = {} if single is None else single(values)
    return DesignOptimum(
        tuple(replace(one, value=values[one.name]) for one in problem.parameters),
        problem.goals,
        {name: one[0] for name, one in given.items()},
        {name: one[0] for name, one in after.items()},
        {name: np.atleast_1d(np.asarray(alone[name], float)) for name in problem.goals.quantities if name in alone},
        problem.ranks(after)[0][0],
        tuple(problem.values(one) for one in others),
        _free_directions(problem, best),
        np.array(history),
        settled,
        title,
    )


def _free_directions(problem: DesignProblem, best: FloatArray) -> int:
    """Number of directions in the space of the parameters, inside their bounds, that change no target.

    At targets that are missed only parameters without effect on any of them count: the nearest design lies where
    slopes cancel, which says nothing about other designs.
    """
    if not problem.goals.targets:
        return 0
    inside = (best > DIFFERENT_DESIGNS) & (best < 1 - DIFFERENT_DESIGNS)
    moved = problem.jacobian(best)
    slopes = np.concatenate([one.scale * moved[one.quantity] for one in problem.goals.targets])[:, inside]
    if np.abs(problem.goals.deviations(problem.at(best))).max() > TARGET_MET:
        lengths = np.linalg.norm(slopes, axis=0)
        return int(np.sum(lengths <= FREE_DIRECTION * lengths.max(initial=0.0)))
    sizes = np.linalg.svd(slopes, compute_uv=False) if slopes.size else np.zeros(0)
    return int(inside.sum() - np.sum(sizes > FREE_DIRECTION * max(float(sizes.max(initial=0.0)), FREE_DIRECTION)))
