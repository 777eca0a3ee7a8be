"""Profile likelihood: how far one value can go while the others make the best of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy import stats
from scipy.optimize import brentq, least_squares

from torsionnet.assembly.rows import FloatArray
from torsionnet.errors import UsageError, did_you_mean

if TYPE_CHECKING:
    from torsionnet.identification.fit import Fit

DOUBLINGS = 12


def profile_interval(fit: Fit, name: str, level: float) -> tuple[float, float]:
    """Both ends of the interval in which chi squared rises by less than the level allows."""
    if fit.problem is None:
        msg = "a fit read from a file has no data to profile; fit again"
        raise UsageError(msg)
    if name not in fit.values:
        msg = f'no parameter of the fit is named "{name}"{did_you_mean(name, fit.values)}'
        raise UsageError(msg)
    profile = _Profile(fit, name, level)
    return profile.end(-1), profile.end(+1)


class _Profile:
    def __init__(self, fit: Fit, name: str, level: float) -> None:
        assert fit.problem is not None
        self.problem, self.index = fit.problem, list(fit.values).index(name)
        self.best = np.array(list(fit.values.values()))
        free = max(fit.degrees_of_freedom, 1)
        self.allowed = fit.chi_squared * (1 + float(stats.f.ppf(level, 1, free)) / free)
        error = fit.standard_errors[name]
        self.step = error if np.isfinite(error) and error > 0 else 0.1 * abs(self.best[self.index]) or 1.0

    def end(self, sign: int) -> float:
        bound = float((self.problem.lower if sign < 0 else self.problem.upper)[self.index])
        inside, guess = float(self.best[self.index]), self.best.copy()
        reach = self.step
        for _ in range(DOUBLINGS):
            place = self.best[self.index] + sign * reach
            if (place - bound) * sign >= 0:
                if self.rise(bound, guess) < 0:
                    return bound if np.isfinite(bound) else sign * np.inf
                place = bound
            if self.rise(place, guess) >= 0:
                return float(brentq(lambda x: self.rise(x, guess), *sorted((inside, place)), xtol=1e-3 * self.step))
            inside, reach = place, 2 * reach
        return sign * np.inf

    def rise(self, value: float, guess: FloatArray) -> float:
        """Chi squared at this value, the others fitted again, less what is allowed."""
        others = [i for i in range(len(self.best)) if i != self.index]
        whole = guess.copy()
        whole[self.index] = value
        if not others:
            return float(np.sum(self.problem.residuals(whole) ** 2)) - self.allowed

        def filled(x: FloatArray) -> FloatArray:
            full = whole.copy()
            full[others] = x
            return full

        found = least_squares(
            lambda x: self.problem.residuals(filled(x)),
            np.clip(guess[others], self.problem.lower[others], self.problem.upper[others]),
            jac=lambda x: self.problem.jacobian(filled(x))[:, others],
            bounds=(self.problem.lower[others], self.problem.upper[others]),
            x_scale=np.maximum(np.abs(guess[others]), 1e-12),
        )
        guess[others] = found.x
        return 2 * float(found.cost) - self.allowed
