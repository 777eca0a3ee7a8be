"""The smallest objective near a design, limits kept, by sequential quadratic programming.

Of curves, the points that are highest at an answer are points of the next question, until no new ones appear.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from torsionnet.assembly.rows import FloatArray
from torsionnet.solve.peaks import inner_maxima
from torsionnet.study.optimum.design_goals import Found
from torsionnet.study.optimum.design_problem import LARGE, DesignProblem

MOST = 200
"""Steps of a search."""
ROUNDS = 12
"""Rounds in which new points of curves come in."""
FINEST = 1e-14
"""Change of the objective, of itself, at which programming stops."""


def finite(values: FloatArray) -> FloatArray:
    """With a large number in place of what a design does not have."""
    return np.where(np.isfinite(values), values, LARGE)


def programmed(problem: DesignProblem, place: FloatArray) -> FloatArray:
    """Points of curves that are highest at an answer are points of the next question."""
    best, best_rank = place, problem.ranks(problem.at(place))[0]
    chosen = _highest(problem, place)
    for _ in range(ROUNDS):
        place = _solved(problem, place, chosen)
        rank = problem.ranks(problem.at(place))[0]
        if rank < best_rank:
            best, best_rank = place, rank
        more = tuple(old | new for old, new in zip(chosen, _highest(problem, place), strict=True))
        if all(np.array_equal(old, new) for old, new in zip(chosen, more, strict=True)):
            break
        chosen = (more[0], more[1])
    return best


def _highest(problem: DesignProblem, place: FloatArray) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which columns of the objective and which limits may hold: their local maxima, and ends."""
    found = problem.at(place)
    sizes = _objective(problem, found)[0], problem.goals.excess(found)[0]
    return _maxima(sizes[0]), _maxima(sizes[1])


def _maxima(values: FloatArray) -> NDArray[np.bool_]:
    chosen = np.zeros(len(values), dtype=bool)
    if len(values):
        chosen[[0, -1]] = True
        chosen[inner_maxima(finite(values))] = True
    return chosen


def _objective(problem: DesignProblem, found: Found) -> FloatArray:
    """Columns (n, n_columns) of which the largest is made small."""
    goals = problem.goals
    return goals.objectives[0].columns(found) if goals.objectives else goals.merit(found)[:, None]


def _objective_slopes(problem: DesignProblem, found: Found, moved: Found) -> FloatArray:
    goals = problem.goals
    if goals.objectives:
        return goals.objectives[0].sign * np.concatenate([moved[name] for name in goals.objectives[0].quantities])
    deviations = goals.deviations(found)[0]
    slopes = np.concatenate([one.scale * moved[one.quantity] for one in goals.targets])
    return np.asarray(2 * deviations[None, :] @ slopes)


def _solved(
    problem: DesignProblem, start: FloatArray, chosen: tuple[NDArray[np.bool_], NDArray[np.bool_]]
) -> FloatArray:
    """The best place as far as the chosen columns and limits go: minimise t, columns below t, limits kept."""
    columns, limits = chosen
    known: dict[bytes, Found] = {}
    moved: dict[bytes, Found] = {}

    def found_at(place: FloatArray) -> Found:
        key = place.tobytes()
        if key not in known:
            known[key] = problem.at(place)
        return known[key]

    def moved_at(place: FloatArray) -> Found:
        key = place.tobytes()
        if key not in moved:
            moved[key] = problem.jacobian(place)
        return moved[key]

    first = _objective(problem, found_at(start))[0]
    scale = float(np.abs(finite(first)).max()) or 1.0

    def sizes(place: FloatArray) -> FloatArray:
        return finite(_objective(problem, found_at(place))[0, columns] / scale)

    def size_slopes(place: FloatArray) -> FloatArray:
        return np.asarray(_objective_slopes(problem, found_at(place), moved_at(place))[columns] / scale)

    def inside(x: FloatArray) -> FloatArray:
        place = x[: len(start)]
        kept = -finite(problem.goals.excess(found_at(place))[0, limits])
        return np.concatenate([kept, x[-1] - sizes(place)]) if several else kept

    def inside_slopes(x: FloatArray) -> FloatArray:
        place = x[: len(start)]
        kept = -problem.goals.excess_slopes(moved_at(place))[limits]
        if not several:
            return kept
        top = np.column_stack([-size_slopes(place), np.ones(int(columns.sum()))])
        return np.concatenate([np.column_stack([kept, np.zeros(len(kept))]), top])

    several = int(columns.sum()) > 1
    search: Any = minimize  # its published types know no constraints that are functions
    found = search(
        (lambda x: float(x[-1])) if several else (lambda x: float(sizes(x)[0])),
        np.append(start, sizes(start).max()) if several else start,
        jac=(lambda x: np.append(np.zeros(len(x) - 1), 1.0)) if several else (lambda x: size_slopes(x)[0]),
        method="SLSQP",
        bounds=[(0.0, 1.0)] * len(start) + [(None, None)] * several,
        constraints={"type": "ineq", "fun": inside, "jac": inside_slopes} if several or limits.any() else (),
        options={"ftol": FINEST, "maxiter": MOST},
    )
    return np.asarray(np.clip(found.x[: len(start)], 0.0, 1.0))
