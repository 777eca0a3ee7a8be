"""Local search of the best design, least squares for targets, sequential quadratic programming for objectives."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy

from torsionnet.base.errors import SolveError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.design.bounded_rows import BoundedPoints, BoundedRows, finite
from torsionnet.study.design.design_problem import DesignProblem

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
            place = _solved(rows, place)
            rank = problem.ranks(problem.at(place))[0]
            if rank < best_rank:
                best, best_rank = place, rank
            highest = BoundedPoints.highest(problem, place)
            if rows.include(highest, place):
                break
            chosen = chosen.joined(highest)
    except SolveError:  # somewhere a curve has no levels: what was found before stands
        pass
    return best


def _solved(rows: BoundedRows, start: FloatArray) -> FloatArray:
    """Point (n_p,) that minimises t, with the active rows of the objective below t and those of the limits below 0."""
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
    found = search(
        (lambda x: float(x[-1])) if several else (lambda x: float(rows.sizes(x)[0])),
        np.append(start, sizes.max()) if several else start,
        jac=(lambda x: np.append(np.zeros(len(x) - 1), 1.0)) if several else (lambda x: rows.size_slopes(x)[0]),
        method="SLSQP",
        bounds=[(0.0, 1.0)] * size + [(None, None)] * several,
        constraints={"type": "ineq", "fun": inside, "jac": inside_slopes} if several or rows.is_limited else (),
        options={"ftol": OBJECTIVE_TOLERANCE, "maxiter": MOST_PEAK_STEPS if rows.chosen.peaks else MOST_STEPS},
    )
    return np.asarray(np.clip(found.x[:size], 0.0, 1.0))


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
    return tried[min(range(len(tried)), key=lambda index: (ranks[index], -index))]


def _fitted(problem: DesignProblem, start: FloatArray) -> FloatArray:
    """Least-squares point (n_p,) for targets, sought once more from bounds by a method that stays exactly at them."""

    def slopes(place: FloatArray) -> FloatArray:
        moved = problem.jacobian(place)
        return np.concatenate([one.scale * moved[one.quantity] for one in problem.goals.targets])

    def residuals(place: FloatArray) -> FloatArray:
        return finite(problem.goals.deviations(problem.at(place))[0])

    place = np.clip(start, 0.0, 1.0)
    for method in ("trf", "dogbox"):
        found = scipy.optimize.least_squares(
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
        place = np.clip(found.x, 0.0, 1.0)
        if np.all((place > BOUND_DISTANCE) & (place < 1 - BOUND_DISTANCE)):
            break
    return place
