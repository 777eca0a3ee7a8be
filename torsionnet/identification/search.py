"""The search for a local optimum, with or without a robust loss."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.errors import SolveError
from torsionnet.identification.fit_problem import FitProblem

TOLERANCE = 1e-12
MOST_CALLS = 500
RANGE = 1e9
"""A positive value is looked for within this factor about its start, where its bounds do not say otherwise."""
TUNING = {"soft_l1": 1.345, "huber": 1.345, "cauchy": 2.385}
"""Standard deviations at which a loss begins to give way: for normal noise it then is 95 % efficient (Huber 1981)."""
NORMAL = 1.4826
"""Standard deviation of a normal number over the median of its absolute values."""
ROUNDS, SETTLED = 30, 1e-4


@dataclass(frozen=True)
class LeastSquaresSolution:
    """Where a search ended; ``scale`` is the standard deviation of the residuals that a robust loss went by."""

    x: FloatArray
    cost: float
    converged: bool
    message: str
    scale: float = 1.0


def solved(problem: FitProblem, start: FloatArray, loss: str) -> LeastSquaresSolution:
    """A local optimum; one that cannot be calculated has an infinite cost.

    A robust loss needs to know how large residuals are that are not outliers. That is the median of their absolute
    values, found anew until it stays.
    """
    if loss == "linear":
        return _local(problem, start, loss, 1.0)
    found = _local(problem, start, "linear", 1.0)
    scale = typical(problem, found.x)
    for _ in range(ROUNDS):
        if not np.isfinite(found.cost) or scale == 0:
            break
        found = _local(problem, found.x, loss, TUNING[loss] * scale)
        before, scale = scale, typical(problem, found.x)
        if abs(scale / before - 1) < SETTLED:
            break
    return replace(found, scale=scale)


def typical(problem: FitProblem, x: FloatArray) -> float:
    """Standard deviation of the residuals that are not outliers."""
    return NORMAL * float(np.median(np.abs(problem.residuals(x))))


def _local(problem: FitProblem, start: FloatArray, loss: str, scale: float) -> LeastSquaresSolution:
    lower, upper = search_bounds(problem)
    chosen: Any = loss
    try:
        found = least_squares(
            problem.residuals,
            np.clip(start, lower, upper),
            jac=problem.jacobian,
            bounds=(lower, upper),
            x_scale=steps(problem, problem.start),
            loss=chosen,
            f_scale=scale,
            xtol=TOLERANCE,
            ftol=TOLERANCE,
            gtol=TOLERANCE,
            max_nfev=MOST_CALLS,
        )
    except SolveError as error:
        return LeastSquaresSolution(start, np.inf, converged=False, message=str(error))
    except (ValueError, np.linalg.LinAlgError):
        where = ", ".join(f"{name} = {x:.3g}" for name, x in zip(problem.names, start, strict=True))
        return LeastSquaresSolution(start, np.inf, converged=False, message=f"numbers beyond all range from {where}")
    return LeastSquaresSolution(
        np.asarray(found.x), float(found.cost), converged=bool(found.success), message=str(found.message)
    )


def cannot_be_negative(problem: FitProblem) -> NDArray[np.bool_]:
    """Of each value; one that begins at 0 has no size to go by and does not count."""
    return np.asarray((problem.start > 0) & (problem.lower >= 0))


def search_bounds(problem: FitProblem) -> tuple[FloatArray, FloatArray]:
    """Lower and upper (n,): on the way to zero or infinity numbers leave the range in which anything is calculated."""
    positive = cannot_be_negative(problem)
    lower = np.where(positive, np.maximum(problem.lower, problem.start / RANGE), problem.lower)
    upper = np.where(positive, np.minimum(problem.upper, problem.start * RANGE), problem.upper)
    return lower, upper


def steps(problem: FitProblem, start: FloatArray) -> FloatArray:
    """In proportion to the values, and those of a delay to a tenth of the shortest period."""
    top = max(float(block.frequencies[-1]) for block in problem.blocks)
    extra = [0.1 / top if name.startswith("delay[") else 1.0 for name in problem.names]
    return np.where(np.abs(start) > 0, np.abs(start), np.array(extra))


def variance(residuals: FloatArray, parameters: int, loss: str, scale: float) -> float:
    """Of a residual, as it makes itself felt in the values found (Huber 1981, Robust Statistics, section 7.6)."""
    free = max(len(residuals) - parameters, 1)
    if loss == "linear" or scale == 0:
        return float(residuals @ residuals) / free
    weight, slope = _influence(loss, residuals, scale)
    return float(np.sum((weight * residuals) ** 2)) / free / float(np.mean(slope)) ** 2


def weights(residuals: FloatArray, loss: str, scale: float) -> FloatArray:
    """What a robust loss leaves of each residual, as a share."""
    return np.ones(len(residuals)) if loss == "linear" or scale == 0 else _influence(loss, residuals, scale)[0]


def _influence(loss: str, residuals: FloatArray, scale: float) -> tuple[FloatArray, FloatArray]:
    """Weight of residuals, and derivative of weight times residual."""
    squared = (residuals / (TUNING[loss] * scale)) ** 2
    if loss == "huber":
        inside = squared <= 1
        return np.where(inside, 1.0, 1 / np.sqrt(np.maximum(squared, 1.0))), inside.astype(float)
    if loss == "soft_l1":
        return (1 + squared) ** -0.5, (1 + squared) ** -1.5
    return 1 / (1 + squared), (1 - squared) / (1 + squared) ** 2
