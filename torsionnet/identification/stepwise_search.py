"""Search for an optimum of a fit that starts with the lowest lines and adds higher ones step by step.

Where a model has many resonances, one that is a little off already misses a high peak, and the misfit has a minimum
wherever two of the peaks coincide. Low lines depend smoothly on the parameters; fitting them first brings the higher
peaks near enough, one after the other.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import scipy

from torsionnet.base.errors import SolveError
from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.fit_search import LeastSquaresSolution, local_optimum, search_bounds, typical_steps
from torsionnet.identification.verdict_words import relative_misfits
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray

LINE_SHARES = (1 / 16, 1 / 8, 1 / 4, 1 / 2, 0.7)
"""Shares of all lines, counted from the lowest, that are fitted one after the other, as each brings higher peaks near
enough."""
FEWEST_LINES_PER_PARAMETER, MOST_STEP_EVALUATIONS = 3, 50
"""Fewest lines for each parameter in a step of the search, and most evaluations of the residuals in each step, which
need not converge."""
SUSPICIOUS_MISFIT = 0.02
"""RMS of model minus test over RMS of the test above which a search may have ended beside the best optimum."""
WARNED_MISFIT, LEAST_IMPROVEMENT = 0.1, 1e-6
"""Relative RMS misfit above which a response of unknown noise is warned of, and least relative improvement of the cost
by which another optimum is taken."""
OUTLYING_LINE = 6.0
"""Misfit of a single line over its noise above which it is warned of; noise leaves more in 2 of 1e8 lines."""


def stepwise_optimum(
    problem: FitProblem, best: LeastSquaresSolution, start: FloatArray, loss: str
) -> LeastSquaresSolution:
    """Better optimum of the best one so far and that of a search with lines added step by step.

    Only for responses; records take far longer, and their lines are wide.
    """
    if (
        problem.has_records
        or not np.isfinite(best.cost)
        or relative_misfits(problem, best.x).max() <= SUSPICIOUS_MISFIT
    ):
        return best
    try:
        found = start
        with np.errstate(all="ignore"):  # overflow is checked by the cost
            for share in LINE_SHARES:
                found = _with_lines(problem, found, share)
    except (SolveError, ValueError, np.linalg.LinAlgError):
        return best  # few lines may lead anywhere, even where the model cannot be solved
    other = local_optimum(problem, found, loss)
    return other if other.converged and other.cost < (1 - LEAST_IMPROVEMENT) * best.cost else best


def _with_lines(problem: FitProblem, start: FloatArray, share: float) -> FloatArray:
    """Values (n,) in SI of the unknowns at the optimum for a share of the lines, the lowest, and for the priors."""
    every = np.sort(np.concatenate([block.frequencies for block in problem.blocks]))
    count = min(max(int(share * len(every)), FEWEST_LINES_PER_PARAMETER * len(start)), len(every))
    inside = [np.tile(block.frequencies <= every[count - 1], block.parts) for block in problem.blocks]
    kept = np.concatenate([*inside, np.ones(len(problem.priors), dtype=bool)])
    lower, upper = search_bounds(problem)

    def residuals(x: FloatArray) -> FloatArray:
        return np.asarray(problem.residuals(x)[kept])

    def jacobian(x: FloatArray) -> FloatArray:
        return np.asarray(problem.jacobian(x)[kept])

    found = scipy.optimize.least_squares(
        residuals,
        np.clip(start, lower, upper),
        jac=jacobian,
        bounds=(lower, upper),
        x_scale=typical_steps(problem, problem.start),
        max_nfev=MOST_STEP_EVALUATIONS,
    )
    return np.asarray(found.x)


def misfit_warnings(problem: FitProblem, values: FloatArray, loss: str) -> Iterator[str]:
    """Warning for each response of unknown noise that the model misses by far, or in single lines.

    It may have other peaks. A robust loss leaves outlying lines alone.
    """
    misfits = relative_misfits(problem, values)
    for block, place, misfit in zip(problem.blocks, problem.unknown_indices, misfits, strict=True):
        if not block.noise_is_unknown:
            continue
        label = block.measurement.label
        if misfit > WARNED_MISFIT and _has_peaks(block.predicted(values[place])[0]):
            yield (
                f"{label}: the model is off by {100 * misfit:.2g} % of the response (RMS), and nothing says "
                "that this is noise: it may have other peaks than the test; try starts=10, or an error or a coherence"
            )
        off = np.linalg.norm(block.residuals(values[place])[0].reshape(block.parts, -1), axis=0)
        worst = int(off.argmax())
        if loss == "linear" and off[worst] > OUTLYING_LINE:
            yield (
                f"{label}: the line at {block.frequencies[worst]:.4g} Hz is off by {off[worst]:.2g} times its noise: "
                "a narrow peak of the test may lie beside that of the model, or the noise is of another kind than "
                "equal in all lines or in proportion to them; try other start values, an error or a robust loss"
            )


def _has_peaks(response: ComplexArray) -> bool:
    size = np.abs(response)
    return bool(np.any((size[1:-1] > size[:-2]) & (size[1:-1] > size[2:])))
