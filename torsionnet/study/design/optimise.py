"""Optimisation of a design by a global search, several local searches, and verification by a single model."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import scipy
from numpy.typing import ArrayLike

from torsionnet.base.errors import SolveError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.design.design_goals import TARGET_MET, DesignOptimum
from torsionnet.study.design.design_problem import BoundedPoints, BoundedRows, DesignProblem, Rank, finite

# Global search of designs within bounds by an even spread of samples, and differential evolution from them.

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
    # Sobol points are even in counts that are powers of two.
    count = 1 << int(np.ceil(np.log2(max(FEWEST_MEMBERS, PER_PARAMETER * size))))
    spread = scipy.stats.qmc.Sobol(size, scramble=False).random(count)
    # The first Sobol point is a corner of the cube: half a cell inside it stands for its surroundings.
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
        # Designs that violate limits come behind all others, by how much they do.
        return np.where(over > 0, VIOLATION_MERIT * (1 + over), merit)

    def report(intermediate_result: OptimizeResult) -> None:
        each(float(intermediate_result.fun))

    solution = differential_evolution(
        merits, Bounds(np.zeros(size), np.ones(size)), strategy="best1bin", mutation=SCALE, recombination=CROSSOVER,
        init=crowd, maxiter=generations, tol=CONVERGED_SPREAD, atol=0, polish=False, vectorized=True,
        updating="deferred", rng=seed, callback=report,
    )  # fmt: skip
    return np.asarray(solution.x)


# Local search of the best design, least squares for targets, sequential quadratic programming for objectives.

MOST_STEPS, MOST_PEAK_STEPS = 200, 60
"""Most steps of one local search, and of one after which the points of peaks are chosen anew."""
MOST_LOCAL_ROUNDS, MOST_PEAK_ROUNDS = 12, 40
"""Most rounds of local search with new active points, without and with curves over frequency, which have any number."""
OBJECTIVE_TOLERANCE = 1e-14
"""Relative change of the objective at which quadratic programming stops, a little above rounding."""


def solve_programme(problem: DesignProblem, place: FloatArray) -> FloatArray:
    """Best point (n_p,) of the unit cube by sequential quadratic programming, with active points renewed in rounds."""
    best, best_rank = place, problem.ranks(problem.at(place))[0]
    try:
        chosen = BoundedPoints.highest(problem, place).with_curve_points(problem, place)
        for _ in range(MOST_PEAK_ROUNDS if chosen.peaks else MOST_LOCAL_ROUNDS):
            rows = BoundedRows(problem, chosen, place)
            place = _programme_solution(rows, place)
            rank = problem.ranks(problem.at(place))[0]
            if rank < best_rank:
                best, best_rank = place, rank
            highest = BoundedPoints.highest(problem, place)
            # The active points are right once the highest ones of the solution are among them.
            if rows.include(highest, place):
                break
            chosen = chosen.joined(highest)
    except SolveError:  # somewhere a curve has no levels: what was found before stands
        pass
    return best


def _programme_solution(rows: BoundedRows, start: FloatArray) -> FloatArray:
    """Point (n_p,) that minimises t, with the active rows of the objective below t and those of the limits below 0."""
    # Minimax as a smooth programme: t is minimised, all rows of the objective stay below t; one row needs no t.
    size, sizes = len(start), rows.sizes(start)
    several = len(sizes) > 1

    def inside(x: FloatArray) -> FloatArray:
        kept = -rows.excess(x[:size])
        return np.concatenate([kept, x[-1] - rows.sizes(x[:size])]) if several else kept

    def inside_slopes(x: FloatArray) -> FloatArray:
        kept = -rows.excess_slopes(x[:size])
        if not several:
            return kept
        top = np.column_stack([-rows.size_slopes(x[:size]), np.ones(len(sizes))])
        return np.concatenate([np.column_stack([kept, np.zeros(len(kept))]), top])

    search: Any = scipy.optimize.minimize  # its published types know no constraints that are functions
    solution = search(
        (lambda x: float(x[-1])) if several else (lambda x: float(rows.sizes(x)[0])),
        np.append(start, sizes.max()) if several else start,
        jac=(lambda x: np.append(np.zeros(len(x) - 1), 1.0)) if several else (lambda x: rows.size_slopes(x)[0]),
        method="SLSQP",
        bounds=[(0.0, 1.0)] * size + [(None, None)] * several,
        constraints={"type": "ineq", "fun": inside, "jac": inside_slopes} if several or rows.is_limited else (),
        options={"ftol": OBJECTIVE_TOLERANCE, "maxiter": MOST_PEAK_STEPS if rows.chosen.peaks else MOST_STEPS},
    )
    return np.asarray(np.clip(solution.x[:size], 0.0, 1.0))


LEAST_SQUARES_TOLERANCE = 4 * np.finfo(float).eps
"""Relative change of the parameters or residuals at which least squares stop, which is rounding."""
BOUND_DISTANCE = 1e-3
"""Distance from a bound in the unit cube within which an interior-point method may have stopped short of the bound."""


def polish(problem: DesignProblem, place: FloatArray) -> FloatArray:
    """Best point (n_p,) of the unit cube found by local searches from a point, never a worse one."""
    tried = [np.asarray(place, float)]
    if problem.goals.limits or problem.goals.objectives:
        tried.append(solve_programme(problem, tried[-1]))
    if problem.goals.targets:
        tried.append(_fitted(problem, tried[-1]))
    ranks = problem.ranks(problem.at(np.array(tried)))
    # Of equals the one that was improved last.
    return tried[min(range(len(tried)), key=lambda index: (ranks[index], -index))]


def _fitted(problem: DesignProblem, start: FloatArray) -> FloatArray:
    """Least-squares point (n_p,) for targets, sought once more from bounds by a method that stays exactly at them."""

    def slopes(place: FloatArray) -> FloatArray:
        moved = problem.jacobian(place)
        return np.concatenate([target.scale * moved[target.quantity] for target in problem.goals.targets])

    def residuals(place: FloatArray) -> FloatArray:
        return finite(problem.goals.deviations(problem.at(place))[0])

    place = np.clip(start, 0.0, 1.0)
    for method in ("trf", "dogbox"):
        solution = scipy.optimize.least_squares(
            residuals,
            place,
            slopes,
            bounds=(0.0, 1.0),
            method=method,
            ftol=LEAST_SQUARES_TOLERANCE,
            xtol=LEAST_SQUARES_TOLERANCE,
            gtol=LEAST_SQUARES_TOLERANCE,
            max_nfev=MOST_STEPS,
        )
        place = np.clip(solution.x, 0.0, 1.0)
        # The interior method (trf) stops short of a bound; away from bounds its answer stands.
        if np.all((place > BOUND_DISTANCE) & (place < 1 - BOUND_DISTANCE)):
            break
    return place


EQUAL_MERIT = 1e-6
"""Largest relative difference of two designs' merits that count as equally good, as searches end within less."""
DISTANCES = 1e-2 * 0.25 ** np.arange(9)
"""Distances in the unit cube of the designs tried beside the best one, down to where merits are equal."""
MOST_ROUNDS = 10
"""Most steps to better designs nearby, as a search that still finds better ones then has not converged."""


def as_good(problem: DesignProblem, rank: Rank, best: Rank) -> bool:
    """Whether a design is as good as the best one within the tolerance of a search."""
    if rank[0] > best[0] * (1 + EQUAL_MERIT):
        return False
    # Squared deviations are 0 at best, where a relative tolerance means nothing.
    if problem.goals.targets:
        return rank[1] <= max(TARGET_MET**2, best[1] * (1 + EQUAL_MERIT))
    return rank[1] - best[1] <= EQUAL_MERIT * abs(best[1])


def check_neighbours(problem: DesignProblem, place: FloatArray, seed: int) -> tuple[FloatArray, bool]:
    """Best point of the unit cube among ``place`` and its neighbours, and whether no neighbour of that is better.

    Designs are tried at several distances along every parameter and in as many directions between them, and one more
    search begins beside the place.
    """
    draw = np.random.default_rng(seed)
    rank = problem.ranks(problem.at(place))[0]
    for _ in range(MOST_ROUNDS):
        other, beside = _best_beside(problem, place, draw)
        if beside >= rank:
            return place, True
        # A gain within the tolerance is a finer end of the search, not another design.
        enough = as_good(problem, rank, beside)
        place, rank = other, beside
        if enough:
            return place, True
    return place, False


def _best_beside(problem: DesignProblem, place: FloatArray, draw: np.random.Generator) -> tuple[FloatArray, Rank]:
    size = len(place)
    between = draw.standard_normal((size, size))
    # A minimax has kinks, from which a descent may lead between the axes only.
    ways = np.concatenate([np.eye(size), between / np.linalg.norm(between, axis=1, keepdims=True)])
    beside = np.clip(place + DISTANCES[:, None, None] * np.concatenate([ways, -ways]), 0.0, 1.0)
    ranks = problem.ranks(problem.at(beside.reshape(-1, size)))
    # The first 4 n_p designs are those at the largest distance; one more search begins at the best of them.
    farthest = min(range(4 * size), key=ranks.__getitem__)
    nearest = min(range(len(ranks)), key=ranks.__getitem__)
    tried = np.array([beside.reshape(-1, size)[nearest], polish(problem, beside[0, farthest])])
    polished = problem.ranks(problem.at(tried))
    best = min(range(2), key=polished.__getitem__)
    return tried[best], polished[best]


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
    >>> optimum = optimise(DesignProblem((k,), DesignGoals((DesignTarget("f", 5.0),)), frequency))
    >>> round(optimum.values["k"] / (2 * (10 * np.pi) ** 2), 9)
    1.0
    """
    problem.goals.require_merit()
    history: list[tuple[float, float]] = []

    def note(merit: float) -> None:
        history.append((float(problem.evaluations), min([merit, *(merit_before for _, merit_before in history[-1:])])))

    ordered = initial_places(problem)
    first = problem.ranks(problem.at(ordered[:1]))[0]
    if not np.isfinite(first).all():
        raise SolveError("no design within the bounds has all the quantities that are asked for", kind="no-solution")
    note(first[1])
    # An objective is sought by a population first; targets get one only where local searches miss them.
    if problem.goals.objectives:
        begin = [evolve(problem, ordered, seed, note, generations), *distant_places(ordered, BESIDE)]
    else:
        begin = distant_places(ordered, BEGINNINGS)
    polished = _each_polished(problem, begin)
    if problem.goals.targets and polished[0][0] > (0.0, TARGET_MET**2):
        polished = sorted(
            [*polished, *_each_polished(problem, [evolve(problem, ordered, seed, note, generations)])], key=_by_rank
        )
    rank, best = polished[0]
    equal = [place for other, place in polished if as_good(problem, other, rank)]
    # Two searches that end equally good confirm each other.
    settled = len(equal) > 1
    if not settled:
        best, settled = check_neighbours(problem, best, seed)
        rank, equal = problem.ranks(problem.at(best))[0], [best]
    different = different_places(equal, DIFFERENT_DESIGNS)
    # Of equally good designs the one that changes least.
    best = min(different, key=lambda place: float(np.linalg.norm(place - problem.start)))
    note(rank[1])
    others = [place for place in different if place is not best]
    return _result(problem, best, others, history, single, title, settled=settled)


def _by_rank(polished: tuple[Rank, FloatArray]) -> Rank:
    return polished[0]


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
        tuple(replace(parameter, value=values[parameter.name]) for parameter in problem.parameters),
        problem.goals,
        {name: before[0] for name, before in given.items()},
        {name: row[0] for name, row in after.items()},
        {name: np.atleast_1d(np.asarray(alone[name], float)) for name in problem.goals.quantities if name in alone},
        problem.ranks(after)[0][0],
        tuple(problem.values(other) for other in others),
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
    # A parameter at a bound is not free.
    inside = (best > DIFFERENT_DESIGNS) & (best < 1 - DIFFERENT_DESIGNS)
    moved = problem.jacobian(best)
    slopes = np.concatenate([target.scale * moved[target.quantity] for target in problem.goals.targets])[:, inside]
    if np.abs(problem.goals.deviations(problem.at(best))).max() > TARGET_MET:
        lengths = np.linalg.norm(slopes, axis=0)
        return int(np.sum(lengths <= FREE_DIRECTION * lengths.max(initial=0.0)))
    # Each vanishing singular value is a combination of parameters that changes no target.
    sizes = np.linalg.svd(slopes, compute_uv=False) if slopes.size else np.zeros(0)
    return int(inside.sum() - np.sum(sizes > FREE_DIRECTION * max(float(sizes.max(initial=0.0)), FREE_DIRECTION)))
