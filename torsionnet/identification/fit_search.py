"""Search for a local optimum of a least-squares fit of parameters, with or without a robust loss."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from torsionnet.base.errors import SolveError
from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.residuals.stepped_block import SteppedBlock
from torsionnet.linear.assembly.rows import FloatArray

CONVERGENCE_TOLERANCE = 1e-12
"""Relative change of cost, values and gradient at which the search of a fit ends, near rounding, as derivatives are
exact."""
MOST_EVALUATIONS = 500
"""Number of evaluations of the residuals after which the search of a fit stops and counts as not converged."""
SEARCH_RANGE_FACTOR = 1e9
"""Factor about its start value within which a positive value is searched if its bounds are wider, so that numbers do
not overflow."""
LOSS_TUNING = {"soft_l1": 1.345, "huber": 1.345, "cauchy": 2.385}
"""Residual in standard deviations at which each robust loss begins to give way, so that it is 95 % efficient for normal
noise (Huber 1981)."""
DEVIATION_PER_MEDIAN = 1.4826
"""Standard deviation of normally distributed residuals over the median of their absolute values."""
SCALE_ROUNDS, SETTLED_SCALE_CHANGE = 30, 1e-4
"""Most repetitions of a robust fit, so that it ends, and the relative change of its residual scale at which it has
settled."""


EQUATION_ROUNDS = 4
"""Times that equations of motion are weighed by their deviations, which depend on the values found."""


@dataclass(frozen=True)
class LeastSquaresSolution:
    """Optimum found by a search of a fit, with values, cost, convergence and the ``scale`` of a robust loss."""

    x: FloatArray
    cost: float
    converged: bool
    message: str
    scale: float = 1.0


def local_optimum(
    problem: FitProblem, start: FloatArray, loss: str, tolerance: float = CONVERGENCE_TOLERANCE
) -> LeastSquaresSolution:
    """Local optimum of a fit problem found from start values; its cost is infinite if it cannot be calculated.

    A robust loss needs the size of residuals that are not outliers: the median of their absolute values, calculated
    again until it settles. The search ends where cost, values or gradient change by less than ``tolerance``.
    """
    start = start_by_equations(problem, start)
    if loss == "linear":
        return _local(problem, start, loss, 1.0, tolerance)
    optimum = _local(problem, start, "linear", 1.0, tolerance)
    scale = residual_scale(problem, optimum.x)
    # The loss needs the scale of the residuals, and these depend on the loss: by turns until the scale settles.
    for _ in range(SCALE_ROUNDS):
        if not np.isfinite(optimum.cost) or scale == 0:
            break
        optimum = _local(problem, optimum.x, loss, LOSS_TUNING[loss] * scale, tolerance)
        before, scale = scale, residual_scale(problem, optimum.x)
        if abs(scale / before - 1) < SETTLED_SCALE_CHANGE:
            break
    return replace(optimum, scale=scale)


def start_by_equations(problem: FitProblem, start: FloatArray) -> FloatArray:
    """Start values (n,) at which the equations of motion hold best at the motions measured; as given for linear models.

    Motions of a model far off lie on other branches than those of the test, or there are none; equations are smooth.
    """
    if not any(isinstance(block, SteppedBlock) for block in problem.blocks):
        return start
    lower, upper = search_bounds(problem)
    values, steps = np.clip(start, lower, upper), typical_steps(problem, problem.start)
    try:
        with np.errstate(all="ignore"):  # overflow is checked by the cost
            for _ in range(EQUATION_ROUNDS):
                # Deviations are those at the last values, else a model that answers little would fit best.
                missed = partial(_missed_equations, problem, sizes=_equations(problem, values)[1])
                solved = scipy.optimize.least_squares(missed, values, bounds=(lower, upper), x_scale=steps)
                values = np.asarray(solved.x)
        better = np.sum(problem.residuals(values) ** 2) < np.sum(problem.residuals(start) ** 2)
    except (SolveError, ValueError, np.linalg.LinAlgError):
        return start
    return values if better else start


def _equations(problem: FitProblem, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Equations of motion missed by all measurements that have some, and their deviations by noise."""
    placed = zip(problem.blocks, problem.unknown_indices, strict=True)
    each = [block.equations(values[place]) for block, place in placed if isinstance(block, SteppedBlock)]
    return np.concatenate([part[0] for part in each]), np.concatenate([part[1] for part in each])


def _missed_equations(problem: FitProblem, values: FloatArray, sizes: FloatArray) -> FloatArray:
    priors = [(values[index] - mean) / deviation for index, (mean, deviation) in problem.priors.items()]
    return np.concatenate([_equations(problem, values)[0] / sizes, priors])


def residual_scale(problem: FitProblem, x: FloatArray) -> float:
    """Standard deviation of the weighted residuals at ``x`` that are not outliers, from their median."""
    return DEVIATION_PER_MEDIAN * float(np.median(np.abs(problem.residuals(x))))


def _local(problem: FitProblem, start: FloatArray, loss: str, scale: float, tolerance: float) -> LeastSquaresSolution:
    lower, upper = search_bounds(problem)
    chosen: Any = loss
    try:
        solution = scipy.optimize.least_squares(
            problem.residuals,
            np.clip(start, lower, upper),
            jac=problem.jacobian,
            bounds=(lower, upper),
            x_scale=typical_steps(problem, problem.start),
            loss=chosen,
            f_scale=scale,
            xtol=tolerance,
            ftol=tolerance,
            gtol=tolerance,
            max_nfev=MOST_EVALUATIONS,
        )
    except SolveError as error:
        return LeastSquaresSolution(start, np.inf, converged=False, message=str(error))
    except (ValueError, np.linalg.LinAlgError):
        where = ", ".join(f"{name} = {x:.3g}" for name, x in zip(problem.names, start, strict=True))
        return LeastSquaresSolution(start, np.inf, converged=False, message=f"numbers overflow from {where}")
    return LeastSquaresSolution(
        np.asarray(solution.x), float(solution.cost), converged=bool(solution.success), message=str(solution.message)
    )


def cannot_be_negative(problem: FitProblem) -> NDArray[np.bool_]:
    """Mask (n,) of the unknowns of a fit that start above 0 and cannot be negative."""
    return np.asarray((problem.start > 0) & (problem.lower >= 0))


def search_bounds(problem: FitProblem) -> tuple[FloatArray, FloatArray]:
    """Lower and upper search bound of each unknown in SI, each (n,), so that numbers stay in floating-point range."""
    positive = cannot_be_negative(problem)
    lower = np.where(positive, np.maximum(problem.lower, problem.start / SEARCH_RANGE_FACTOR), problem.lower)
    upper = np.where(positive, np.minimum(problem.upper, problem.start * SEARCH_RANGE_FACTOR), problem.upper)
    return lower, upper


def typical_steps(problem: FitProblem, start: FloatArray) -> FloatArray:
    """Typical step of each unknown in SI (n,), its start value; for a delay a tenth of the shortest period."""
    top = max(float(block.frequencies[-1]) for block in problem.blocks)
    extra = [0.1 / top if name.startswith("delay[") else 1.0 for name in problem.names]
    return np.where(np.abs(start) > 0, np.abs(start), np.array(extra))


def residual_variance(residuals: FloatArray, parameters: int, loss: str, scale: float) -> float:
    """Effective variance of the weighted residuals under a loss (Huber 1981, Robust Statistics, section 7.6)."""
    free = max(len(residuals) - parameters, 1)
    if loss == "linear" or scale == 0:
        return float(residuals @ residuals) / free
    # With psi the residual times its weight it is sum psi^2/(n - p) over the square of the mean of psi'.
    weight, slope = _influence(loss, residuals, scale)
    return float(np.sum((weight * residuals) ** 2)) / free / float(np.mean(slope)) ** 2


def loss_weights(residuals: FloatArray, loss: str, scale: float) -> FloatArray:
    """Weight of each residual under a robust loss, from 0 to 1, shape (n_residuals,)."""
    return np.ones(len(residuals)) if loss == "linear" or scale == 0 else _influence(loss, residuals, scale)[0]


def _influence(loss: str, residuals: FloatArray, scale: float) -> tuple[FloatArray, FloatArray]:
    """Weight of each residual under a robust loss, and derivative of weight times residual, each (n_residuals,)."""
    squared = (residuals / (LOSS_TUNING[loss] * scale)) ** 2
    if loss == "huber":
        inside = squared <= 1
        return np.where(inside, 1.0, 1 / np.sqrt(np.maximum(squared, 1.0))), inside.astype(float)
    if loss == "soft_l1":
        return (1 + squared) ** -0.5, (1 + squared) ** -1.5
    # Cauchy's loss, the logarithm of 1 + z^2
    return 1 / (1 + squared), (1 - squared) / (1 + squared) ** 2
