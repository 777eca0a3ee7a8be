"""Fits of a model with one more unknown each, and the rule which of these unknowns explain a misfit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from torsionnet.base.errors import TorsionnetError
from torsionnet.identification.causes import Cause, with_causes
from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.fit_search import SEARCH_RANGE_FACTOR, LeastSquaresSolution
from torsionnet.identification.verdict_words import relative_misfits
from torsionnet.linear.assembly.rows import FloatArray

LEAST_MISFIT_REDUCTION = 0.8
"""Share of the sum of squared residuals that a freed cause must remove to count as an explanation of the misfit."""
START_FACTORS, GAIN_SIGNS = (1.0, 0.5, 2.0), (1.0, -1.0)
"""Multiples of a value in the model from which it is searched, as a resonance may lie in between, and start values of a
gain, as a channel may be reversed."""
EQUALLY_GOOD_RATIO = 1.5
"""Ratio of the sums of squared residuals left by two causes up to which both explain a misfit equally well."""
RANGE_END_FACTOR = 1e-3
"""Factor from the end of the search range within which a freed value has grown without bound."""

ROUGH_TOLERANCE = 1e-6
"""Relative change of cost, values and gradient at which the search with a cause freed ends at first: a cause that
explains nothing has a flat optimum, and most of its search would go into digits that nobody reads."""
SMALLEST_START = 1e-6
"""Start value in SI below which a freed value counts as 0 in the model, as of a shaft without damping."""
REFINED_RATIO = 2.0
"""Ratio to the sum of squares up to which a cause may count as an explanation, within which its search goes on to the
end."""


class Solve(Protocol):
    """Function that returns the local optimum of a fit problem found from start values."""

    def __call__(self, problem: FitProblem, start: FloatArray, tolerance: float = ..., /) -> LeastSquaresSolution: ...


@dataclass(frozen=True, eq=False)
class CauseFit:
    """Fit with one cause of a misfit freed, with its problem, the values at its optimum and the sum of squares left."""

    cause: Cause
    problem: FitProblem
    values: FloatArray
    sum_of_squares: float

    @property
    def criterion(self) -> float:
        """Akaike information criterion of the fit, the sum of squared residuals left plus 2 for each unknown."""
        return self.sum_of_squares + 2 * len(self.values)

    @property
    def misfit(self) -> float:
        """RMS of model minus test over RMS of the test, with the cause freed, over all measurements."""
        return overall_misfit(self.problem, self.values)

    @property
    def ended(self) -> bool:
        """Whether the fit drove the freed value without bound, so that the cause explains nothing."""
        mine = [name.partition("[")[0] == self.cause.unknown for name in self.problem.names]
        if not any(mine):
            return False
        begin, value = float(np.mean(self.problem.start[mine])), float(np.mean(self.values[mine]))
        return begin > 0 and abs(value / begin) >= RANGE_END_FACTOR * SEARCH_RANGE_FACTOR


def sum_of_squares(problem: FitProblem, values: FloatArray) -> float:
    """Sum of the squared weighted residuals of a fit problem at ``values`` of its unknowns."""
    return float(np.sum(problem.residuals(values) ** 2))


def overall_misfit(problem: FitProblem, values: FloatArray) -> float:
    """RMS of model minus test over RMS of the test, over all measurements of a fit problem, without unit."""
    return float(np.sqrt(np.mean(relative_misfits(problem, values) ** 2)))


def fit_causes(
    problem: FitProblem, causes: Sequence[Cause], starts: Sequence[FloatArray], solve: Solve, whole: float
) -> list[CauseFit]:
    """Best fit with each cause freed, of those from all start values, sorted with the best cause first.

    Causes that leave most of the sum of squares ``whole`` are not searched to the last digit.
    """
    best: dict[Cause, CauseFit] = {}
    found = [
        _tried(problem, cause, start, solve, factor)
        for start in starts
        for cause in causes
        for factor in _factors(problem, cause)
    ]
    for one in sorted((one for one in found if one is not None), key=lambda one: one.criterion):
        best.setdefault(one.cause, one)
    most = REFINED_RATIO * (1 - LEAST_MISFIT_REDUCTION) * whole
    refined = [_refined(one, solve) if one.sum_of_squares <= most else one for one in best.values()]
    return sorted(refined, key=lambda one: one.criterion)


def starts_of_causes(problem: FitProblem, values: FloatArray) -> list[FloatArray]:
    """Values (n,) from which causes are searched: those of the fit, and its start, as a wrong model leads far off."""
    return [values] if np.array_equal(values, problem.start) else [values, problem.start]


def under_own_noise(one: CauseFit, solve: Solve) -> LeastSquaresSolution:
    """Optimum with a cause freed, weighed by the noise that it leaves itself."""
    one.problem.learn_noise(one.values)
    return solve(one.problem, one.values)


def _refined(one: CauseFit, solve: Solve) -> CauseFit:
    found = solve(one.problem, one.values).x
    return replace(one, values=found, sum_of_squares=sum_of_squares(one.problem, found))


def _factors(problem: FitProblem, cause: Cause) -> tuple[float, ...]:
    if cause.kind == "gain" and any(block.form != "magnitude" for block in problem.blocks):
        return GAIN_SIGNS
    return START_FACTORS if cause.is_value and not problem.has_records else START_FACTORS[:1]


def _tried(problem: FitProblem, cause: Cause, start: FloatArray, solve: Solve, factor: float) -> CauseFit | None:
    """Fit with one cause freed, whose value starts ``factor`` times its own, or None if it cannot be calculated."""
    try:
        with_it = with_causes(problem, [cause], start, instead=True)
        begin = with_it.start.copy()
        places = [place for place, name in enumerate(with_it.names) if name.partition("[")[0] == cause.unknown]
        begin[places] *= factor
        begin = with_it.start_with_long_delays(begin)
        # A value that begins at 0, as damping, takes tiny steps at first, which a rough search takes for the end.
        from_zero = any(abs(begin[place]) < SMALLEST_START for place in places)
        found = (solve(with_it, begin) if from_zero else solve(with_it, begin, ROUGH_TOLERANCE)).x
        return CauseFit(cause, with_it, found, sum_of_squares(with_it, found))
    except (TorsionnetError, np.linalg.LinAlgError):
        return None  # what cannot be calculated explains nothing


def explaining_fits(tried: Sequence[CauseFit], whole: float) -> list[CauseFit]:
    """Fits with one cause freed that remove most of a misfit and leave about as little of it as the best of them.

    Parameters
    ----------
    tried : sequence of CauseFit
        The best first.
    whole : float
        Sum of squares with none of the causes freed.
    """
    sound = [one for one in tried if not one.ended and one.sum_of_squares <= (1 - LEAST_MISFIT_REDUCTION) * whole]
    if not sound:
        return []
    least, rounding = sound[0], np.finfo(float).eps * whole
    noise = _noise(least.problem)

    def as_good(one: CauseFit) -> bool:
        alike = (
            one.sum_of_squares <= EQUALLY_GOOD_RATIO * least.sum_of_squares
            and one.misfit <= np.sqrt(EQUALLY_GOOD_RATIO) * least.misfit
        )
        return one is least or alike or one.sum_of_squares <= max(noise, rounding)

    return [one for one in sound if as_good(one)]


def _noise(problem: FitProblem) -> float:
    """Sum of squared weighted residuals to expect from the stated errors of all measurements, 0 if one states none."""
    stated = all(block.noise_is_stated for block in problem.blocks)
    return problem.effective_count if stated else 0.0
