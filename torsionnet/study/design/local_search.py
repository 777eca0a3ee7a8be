"""The best design near one: least squares for targets, programming for objectives and limits."""

from __future__ import annotations

import numpy as np
from scipy.optimize import least_squares

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.design.bounded_points import finite
from torsionnet.study.design.constrained_search import programmed
from torsionnet.study.design.design_problem import DesignProblem

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
