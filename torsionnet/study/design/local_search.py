"""The best design near one: least squares for targets, programming for objectives and limits."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import least_squares, minimize

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.errors import SolveError
from torsionnet.study.design.bounded_rows import BoundedPoints, BoundedRows, finite
from torsionnet.study.design.design_problem import DesignProblem

MOST, PEAK_STEPS = 200, 60
"""Steps of a search, and of one whose points of peaks are chosen anew after it."""
ROUNDS, PEAK_ROUNDS = 12, 40
"""Rounds in which new points of curves come in, and of those over frequency, which have any number of points."""
FINEST = 1e-14
"""Change of the objective, of itself, at which programming stops."""


def programmed(problem: DesignProblem, place: FloatArray) -> FloatArray:
    """The best place that is found from one."""
    best, best_rank = place, problem.ranks(problem.at(place))[0]
    try:
        chosen = BoundedPoints.highest(problem, place).begun(problem, place)
        for _ in range(PEAK_ROUNDS if chosen.peaks else ROUNDS):
            rows = BoundedRows(problem, chosen, place)
            place = _solved(rows, place)
            rank = problem.ranks(problem.at(place))[0]
            if rank < best_rank:
                best, best_rank = place, rank
            highest = BoundedPoints.highest(problem, place)
            if rows.hold(highest, place):
                break
            chosen = chosen.joined(highest)
    except SolveError:  # somewhere a curve has no levels: what was found before stands
        pass
    return best


def _solved(rows: BoundedRows, start: FloatArray) -> FloatArray:
    """The best place as far as the chosen rows go: minimise t, the objective's rows below t, the limits' below 0."""
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

    search: Any = minimize  # its published types know no constraints that are functions
    found = search(
        (lambda x: float(x[-1])) if several else (lambda x: float(rows.sizes(x)[0])),
        np.append(start, sizes.max()) if several else start,
        jac=(lambda x: np.append(np.zeros(len(x) - 1), 1.0)) if several else (lambda x: rows.size_slopes(x)[0]),
        method="SLSQP",
        bounds=[(0.0, 1.0)] * size + [(None, None)] * several,
        constraints={"type": "ineq", "fun": inside, "jac": inside_slopes} if several or rows.is_limited else (),
        options={"ftol": FINEST, "maxiter": PEAK_STEPS if rows.chosen.peaks else MOST},
    )
    return np.asarray(np.clip(found.x[:size], 0.0, 1.0))


EXACT = 4 * np.finfo(float).eps
"""Change at which least squares stop: what rounding leaves."""
MOST = 200
"""Steps of a search."""
EDGE = 1e-3
"""Of the unit cube: nearer to a bound than this, a method that keeps inside may have stopped short of it."""


def polished(problem: DesignProblem, place: FloatArray) -> FloatArray:
    """The best place that is found from one, never a worse one."""
    tried = [np.asarray(place, float)]
    if problem.goals.limits or problem.goals.objectives:
        tried.append(programmed(problem, tried[-1]))
    if problem.goals.targets:
        tried.append(_fitted(problem, tried[-1]))
    ranks = problem.ranks(problem.at(np.array(tried)))
    return tried[min(range(len(tried)), key=lambda index: (ranks[index], -index))]


def _fitted(problem: DesignProblem, start: FloatArray) -> FloatArray:
    """Least squares, and from bounds that hold once more by a method that stays exactly at them."""

    def slopes(place: FloatArray) -> FloatArray:
        moved = problem.jacobian(place)
        return np.concatenate([one.scale * moved[one.quantity] for one in problem.goals.targets])

    def residuals(place: FloatArray) -> FloatArray:
        return finite(problem.goals.deviations(problem.at(place))[0])

    place = np.clip(start, 0.0, 1.0)
    for method in ("trf", "dogbox"):
        found = least_squares(
            residuals,
            place,
            slopes,
            bounds=(0.0, 1.0),
            method=method,
            ftol=EXACT,
            xtol=EXACT,
            gtol=EXACT,
            max_nfev=MOST,
        )
        place = np.clip(found.x, 0.0, 1.0)
        if np.all((place > EDGE) & (place < 1 - EDGE)):
            break
    return place
