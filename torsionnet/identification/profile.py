"""Profile-likelihood intervals of fitted values, how far one can move while the others are fitted again."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import scipy

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.threads import one_thread
from torsionnet.identification.verdict_words import has_no_scatter
from torsionnet.linear.assembly.rows import FloatArray

if TYPE_CHECKING:
    from torsionnet.identification.fit_result import FitResult

STEP_DOUBLINGS = 12
"""Number of doublings of the step, from one standard error on, after which an end of an interval counts as infinite."""
BOUND_GAP = 1e-6
"""Distance to a bound, over that from the optimum, at which the model is evaluated, as it may be singular at the
bound."""


@one_thread()
def profile_interval(fit: FitResult, name: str, level: float) -> tuple[float, float]:
    """Profile-likelihood interval (lower, upper) of one value in SI, where chi squared rises by less than allowed."""
    if fit.problem is None:
        raise UsageError("a fit read from a file has no data to profile; fit again", kind="missing-data")
    if name not in fit.values:
        raise UsageError(
            f'no parameter of the fit is named "{name}"{did_you_mean(name, fit.values)}', kind="unknown-parameter"
        )
    rejected = fit.lack_of_fit is not None and fit.lack_of_fit.rejected
    if rejected or has_no_scatter(fit.problem, np.array(list(fit.values.values()))):
        return -np.inf, np.inf
    profile = _Profile(fit, name, level)
    return profile.end(-1), profile.end(+1)


class _Profile:
    def __init__(self, fit: FitResult, name: str, level: float) -> None:
        assert fit.problem is not None
        self.problem, self.index = fit.problem, list(fit.values).index(name)
        self.best = np.array(list(fit.values.values()))
        residuals, slopes = self.problem.residuals_and_jacobian(self.best)
        factor = fit.chi_squared / max(len(residuals) - len(self.best), 1)
        error = fit.standard_errors[name]
        known = np.isfinite(error) and error > 0
        self.step = error if known else 0.1 * abs(self.best[self.index]) or 1.0
        # Correlated noise widens a standard error; the rise of chi squared allowed is widened alike.
        naive = float(np.linalg.pinv(slopes.T @ slopes)[self.index, self.index])
        variance = error**2 / naive if known and naive > 0 else factor
        self.allowed = fit.chi_squared + variance * float(scipy.stats.f.ppf(level, 1, fit.degrees_of_freedom))

    def end(self, sign: int) -> float:
        bound = float((self.problem.lower if sign < 0 else self.problem.upper)[self.index])
        inside, guess = float(self.best[self.index]), self.best.copy()
        distance = self.step
        # Outwards in doubled steps until chi squared is above the limit, then back to where it passes.
        for _ in range(STEP_DOUBLINGS):
            place = self.best[self.index] + sign * distance
            if (place - bound) * sign >= 0:
                place = bound + BOUND_GAP * (self.best[self.index] - bound)
                if self.rise(place, guess) < 0:
                    return bound
            if self.rise(place, guess) >= 0:
                # Without noise no change is allowed, and rounding decides what the best values themselves make.
                if self.rise(inside, guess) >= 0:
                    return inside
                low, high = sorted((inside, place))
                return float(scipy.optimize.brentq(self.rise, low, high, args=(guess,), xtol=1e-3 * self.step))
            inside, distance = place, 2 * distance
        return sign * np.inf

    def rise(self, value: float, guess: FloatArray) -> float:
        """Chi squared with one parameter held at a value and the others fitted again, minus the limit allowed."""
        others = [i for i in range(len(self.best)) if i != self.index]
        whole = guess.copy()
        whole[self.index] = value
        if not others:
            return float(np.sum(self.problem.residuals(whole) ** 2)) - self.allowed

        # The least chi squared over the other parameters, found by least squares within their bounds.
        def filled(x: FloatArray) -> FloatArray:
            full = whole.copy()
            full[others] = x
            return full

        def residuals(x: FloatArray) -> FloatArray:
            return self.problem.residuals(filled(x))

        def jacobian(x: FloatArray) -> FloatArray:
            return np.asarray(self.problem.jacobian(filled(x))[:, others])

        optimum = scipy.optimize.least_squares(
            residuals,
            np.clip(guess[others], self.problem.lower[others], self.problem.upper[others]),
            jac=jacobian,
            bounds=(self.problem.lower[others], self.problem.upper[others]),
            x_scale=np.maximum(np.abs(guess[others]), 1e-12),
        )
        guess[others] = optimum.x
        return 2 * float(optimum.cost) - self.allowed
