"""Result of a fit with standard errors, verdicts in words and profile intervals, and how an optimum becomes one.

Search for an optimum of a fit that starts with the lowest lines and adds higher ones step by step. Where a model has
many resonances, one that is a little off already misses a high peak, and the misfit has a minimum wherever two of the
peaks coincide. Low lines depend smoothly on the parameters; fitting them first brings the higher peaks near enough, one
after the other.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import fields

import numpy as np
import scipy

from torsionnet.base.errors import SolveError, TorsionnetError, UsageError, did_you_mean
from torsionnet.base.threads import one_thread
from torsionnet.drivetrain import Drivetrain
from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.fit_result import Compared, FitResult, dump_fit, read_fit
from torsionnet.identification.fit_search import (
    NO_SCATTER,
    LeastSquaresSolution,
    cannot_be_negative,
    has_no_scatter,
    is_rounding_alone,
    local_optimum,
    not_seen,
    relative_misfits,
    residual_variance,
    search_bounds,
    typical_steps,
    verdicts,
)
from torsionnet.identification.lack_of_fit import LackOfFit, lack_of_fit_sentences, noise_bias
from torsionnet.identification.plan.fit_entries import ParameterQuantity, parameter_quantity
from torsionnet.identification.residuals.equation_block import EquationBlock
from torsionnet.identification.residuals.stepped_block import SteppedBlock
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.assembly.table_range import range_notes
from torsionnet.model.law_network import following_elements
from torsionnet.signals.stepped_levels import HARMONICS

# Profile-likelihood intervals of fitted values, how far one can move while the others are fitted again.

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


# Result of a fit with values, standard errors and verdicts in words, and how an optimum is turned into it.

# Search for an optimum of a fit that starts with the lowest lines and adds higher ones step by step.

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
        values = start
        with np.errstate(all="ignore"):  # overflow is checked by the cost
            for share in LINE_SHARES:
                values = _with_lines(problem, values, share)
    except (SolveError, ValueError, np.linalg.LinAlgError):
        return best  # few lines may lead anywhere, even where the model cannot be solved
    other = local_optimum(problem, values, loss)
    return other if other.converged and other.cost < (1 - LEAST_IMPROVEMENT) * best.cost else best


def _with_lines(problem: FitProblem, start: FloatArray, share: float) -> FloatArray:
    """Values (n,) in SI of the unknowns at the optimum for a share of the lines, the lowest, and for the priors."""
    # From the lowest lines on, where few modes act: each further peak meets a model that is right below it.
    every = np.sort(np.concatenate([block.frequencies for block in problem.blocks]))
    count = min(max(int(share * len(every)), FEWEST_LINES_PER_PARAMETER * len(start)), len(every))
    inside = [np.tile(block.frequencies <= every[count - 1], block.parts) for block in problem.blocks]
    kept = np.concatenate([*inside, np.ones(len(problem.priors), dtype=bool)])
    lower, upper = search_bounds(problem)

    def residuals(x: FloatArray) -> FloatArray:
        return np.asarray(problem.residuals(x)[kept])

    def jacobian(x: FloatArray) -> FloatArray:
        return np.asarray(problem.jacobian(x)[kept])

    solution = scipy.optimize.least_squares(
        residuals,
        np.clip(start, lower, upper),
        jac=jacobian,
        bounds=(lower, upper),
        x_scale=typical_steps(problem, problem.start),
        max_nfev=MOST_STEP_EVALUATIONS,
    )
    return np.asarray(solution.x)


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


SINGULAR_RATIO = 1e-9
"""Singular value of the scaled derivatives, over the largest, below which the data do not determine a combination of
parameters, as less is rounding."""
EXTRA_UNITS = {"delay": "s", "gain": "", "reference_angle": "rad", "moving_inertia": "kg*m^2"}
UNDETERMINED_VARIANCE_RATIO = 1e12
"""Variance that an undetermined combination of parameters is given, over the total variance, so large that it dominates
the correlation."""

RUNAWAY_FACTOR = 1e3
"""Factor from its start value beyond which a fitted value without visible effect has run to zero or to infinity."""
INVISIBLE_EFFECT = 0.1
"""Effect of a whole value on the residuals, in standard deviations of all together, up to which the data do not show
the value."""
ENDLESS_ADVICE = {  # advice by dimension for a value that grows without end
    "stiffness": "the data do not show that it gives way; make it rigid",
    "inertia": "the data do not show that it moves; lock its node",
    "damping": "the data do not show that it slips; make it rigid",
}


class Fit(FitResult):
    """Result of a fit of parameters to measurements, with values, standard errors, correlation, verdicts and notes.

    Attributes
    ----------
    values, standard_errors : mapping of str to float
        SI; an infinite standard error says that the data do not determine the value, or that the model does not fit.
    correlation : (n, n) array
        In the order of ``values``.
    chi_squared : float
        Sum of the squared weighted residuals, priors included.
    degrees_of_freedom : int
        Independent values that the residuals are worth, less the parameters.
    comparisons : tuple of Compared
    verdicts : tuple of str
        Which values can be trusted, in words.
    notes : tuple of str
    steps : mapping of str to tuple of tuples of float
        Errors of a value by the steps (resolution) of a sensor, SI: for each test whose sensor has steps, one error for
        each rest position within a step. They are part of the standard errors.
    lack_of_fit : LackOfFit, optional
        Test of whether the residuals are more than noise; None in a fit that was read from a file.
    """

    def profile(self, name: str, confidence: float = 0.95) -> tuple[float, float]:
        """Profile-likelihood interval (lower, upper) of one value in SI: where chi squared rises by less than allowed.

        Unlike :meth:`intervals` it may be asymmetric; an end is infinite, or at a bound, where the data set none.
        """
        return profile_interval(self, name, confidence)

    def to_yaml(self, path: str | None = None) -> str:
        """YAML text with the result of the fit, also written to ``path``; :func:`load_fit` reads it."""
        return dump_fit(self, path)


ABOUT_FITTED = "laws of motion are linear about the operating point that the drivetrain has with the fitted values"
"""Note of a fit of a drivetrain with laws of motion."""

BY_HARMONICS = f"one harmonic does not tell the steps: {HARMONICS} harmonics of the twist are in the first one"


def make_fit(
    model: Drivetrain, problem: FitProblem, optimum: LeastSquaresSolution, loss: str, lack: LackOfFit | None = None
) -> Fit:
    """Result of a fit from an optimum, with standard errors, correlation, comparisons, verdicts and notes.

    The covariance is that of weighted least squares under correlated noise, A J^T R J A with A = (J^T J)^-1 and the
    correlation R of the residuals, times the reduced chi squared; errors by the steps of sensors and the bias by noise
    are added. If the model does not fit, the values are wrong, so their standard errors are infinite; so are they where
    rounding alone is left and nothing says what the noise is. The noise of records is known from their windows: a
    reduced chi squared below 1 does not reduce it, nor one of 0 an error that is stated.
    """
    plain_names = {name: name.partition("[")[0] for name in problem.names}
    natures = {plain: parameter_quantity(model, plain) for plain in plain_names.values()}
    values, limits = _at_limits(problem, optimum.x, natures)
    residuals, slopes = problem.residuals_and_jacobian(values)
    free = problem.effective_count - len(values)
    left_over = residual_variance(residuals, len(values), loss, optimum.scale)
    silent, exact = has_no_scatter(problem, values), is_rounding_alone(problem, values)
    # Smaller residuals than the noise that was measured are chance, and do not narrow the intervals.
    factor = max(left_over, 1.0) if exact or (problem.noise_is_measured and loss == "linear") else left_over
    # Columns of like size: then small singular values are combinations without effect, and not units.
    effects = np.linalg.norm(slopes, axis=0)
    scale = 1 / np.where(effects > 0, effects, 1.0)  # parameters without effect at the optimum are not determined
    left, sizes, directions = np.linalg.svd(slopes * scale, full_matrices=False)
    lost = sizes <= SINGULAR_RATIO * sizes[0]  # all of them, where nothing has an effect
    # Values move by B r, B the pseudo-inverse V S^-1 U^T: of noise of covariance C they have B C B^T.
    backward = (directions.T / np.where(lost, np.inf, sizes)) @ left.T
    inverse = problem.noise_covariance(backward) + problem.shared_covariance(backward, values) / max(
        factor, np.finfo(float).tiny
    )
    covariance = factor * inverse * np.outer(scale, scale)
    # What has a part in a direction without effect is not determined at all.
    undetermined = (np.abs(directions[lost]) > np.sqrt(SINGULAR_RATIO)).any(axis=0)
    errors = np.where(undetermined, np.inf, np.sqrt(np.diag(covariance)))
    correlation = _correlation(inverse, directions[lost])
    names, moved = problem.names, noise_bias(problem, values)
    unseen = not_seen(problem, values, errors, limits)
    errors[[names.index(name) for name in unseen]] = np.inf
    sentences = verdicts(problem, values, errors, correlation, directions[lost], moved, {**limits, **unseen})
    rejected = lack is not None and lack.rejected
    warnings = () if rejected else (NO_SCATTER,) if silent else misfit_warnings(problem, values, loss)
    withheld = np.inf if rejected or silent else 0.0
    return Fit(
        values=dict(zip(names, values.tolist(), strict=True)),
        standard_errors=dict(zip(names, (np.hypot(errors, moved) + withheld).tolist(), strict=True)),
        correlation=correlation,
        chi_squared=float(residuals @ residuals),
        degrees_of_freedom=max(int(free), 1),
        comparisons=tuple(_compared(problem, number, values) for number in range(len(problem.blocks))),
        verdicts=(*lack_of_fit_sentences(lack), *warnings, *limits.values(), *unseen.values(), *sentences),
        notes=_notes(problem, loss, left_over, scaled=factor == left_over and not withheld),
        units={name: EXTRA_UNITS.get(plain, natures[plain].unit) for name, plain in plain_names.items()},
        title=f"Fit of {model.name}",
        steps=_steps(problem, backward * scale[:, None]),
        lack_of_fit=lack,
        problem=problem,
        loss=loss,
    )


def _correlation(inverse: FloatArray, lost: FloatArray) -> FloatArray:
    """Correlation (n, n) of the fitted values; parameters of an undetermined combination are fully correlated."""
    heavy = inverse + UNDETERMINED_VARIANCE_RATIO * max(float(np.trace(inverse)), 1.0) * lost.T @ lost
    size = np.sqrt(np.diag(heavy))
    return np.asarray(heavy / np.outer(size, size))


def _steps(problem: FitProblem, backward: FloatArray) -> dict[str, tuple[tuple[float, ...], ...]]:
    tests = [moved.tolist() for moved in problem.step_shifts(backward)]
    return {name: tuple(map(tuple, steps)) for name, *steps in zip(problem.names, *tests, strict=True) if steps}


def _compared(problem: FitProblem, number: int, values: FloatArray) -> Compared:
    block, place = problem.blocks[number], problem.unknown_indices[number]
    predicted, _ = block.predicted(values[place])
    residual, _ = block.residuals(values[place])
    count, size = len(block.frequencies), block.deviations
    return Compared(
        name=block.measurement.label,
        frequencies=block.frequencies,
        measured=block.measured,
        fitted=predicted,
        deviation=np.hypot(size[:count], size[count:]) / np.sqrt(2),
        misfit=float(np.sqrt(np.mean(residual**2))),
        unit=block.unit,
        has_phase=block.has_phase,
        orders=block.line_orders,
        speeds=block.line_speeds,
        times=block.times if isinstance(block, EquationBlock) else None,
    )


def _notes(problem: FitProblem, loss: str, factor: float, *, scaled: bool) -> tuple[str, ...]:
    labels = [f"{block.measurement.label} ({block.description})" for block in problem.blocks]
    by = ", by which the errors are scaled" if scaled else ""
    robust = "" if loss == "linear" else f", robust loss {loss}"
    first = f"from {', '.join(labels)}{robust}; reduced chi squared {factor:.3g}{by}"
    remarks = (*filter(None, (block.remark for block in problem.blocks)), *unnamed_configurations(problem))
    tangents = [block for block in problem.blocks if not block.has_equations]
    has_laws = any(following_elements(block.response.drivetrain.definition) for block in tangents)
    read = (range_notes(block.response.drivetrain.assembly, np.abs(block.frequencies)) for block in tangents)
    beyond = dict.fromkeys(note for notes in read for note in notes)
    whole = any(isinstance(block, SteppedBlock) and block.has_harmonics for block in problem.blocks)
    remarks = (*remarks, *([BY_HARMONICS] if whole else []))
    return (first, *remarks, *([ABOUT_FITTED] if has_laws else []), *beyond)


def unnamed_configurations(problem: FitProblem) -> tuple[str, ...]:
    """Remark on measurements that name no configuration of a model that has some, one sentence or none."""
    taken = []
    for block in problem.blocks:
        rig = block.response.drivetrain
        if not block.measurement.configuration and rig.axes and not rig.configuration:
            taken.append(block.measurement.label)
    if not taken:
        return ()
    known = ", ".join(problem.blocks[0].response.drivetrain.configurations)
    return (f"{', '.join(taken)} names no configuration, so the model as written is compared; there are {known}",)


def load_fit(path: str | os.PathLike[str]) -> Fit:
    """Fit read from a file that :meth:`Fit.to_yaml` has written; it lacks the data needed for profiles.

    Raises
    ------
    UsageError
        There is no such file.
    ModelError
        The file is not the result of a fit.
    """
    fit = read_fit(path)
    return Fit(**{part.name: getattr(fit, part.name) for part in fields(fit)})


def _at_limits(
    problem: FitProblem, values: FloatArray, natures: Mapping[str, ParameterQuantity]
) -> tuple[FloatArray, dict[str, str]]:
    """Fitted values (n,) with 0 for those that ran to zero, and a sentence by name for each that ran off."""
    residuals, slopes = problem.residuals_and_jacobian(values)
    spread = np.sqrt(float(residuals @ residuals) / max(len(residuals) - len(values), 1))
    # Effect of a relative change: below the noise the value is as good as 0 or infinite.
    effect = np.linalg.norm(slopes, axis=0) * np.abs(values)
    unseen = cannot_be_negative(problem) & (effect <= INVISIBLE_EFFECT * max(spread, np.finfo(float).tiny))
    ended, said = values.copy(), {}
    for index in np.flatnonzero(unseen):
        name, factor = problem.names[index], values[index] / problem.start[index]
        kind = natures.get(name.partition("[")[0], ParameterQuantity()).dimension
        if factor < 1 / RUNAWAY_FACTOR and problem.lower[index] == 0:
            what = kind if kind in ENDLESS_ADVICE else "parameter"
            said[name] = f"{name} runs to zero: the data do not show this {what}; leave it out"
            ended[index] = 0.0
        elif factor > RUNAWAY_FACTOR:
            said[name] = (
                f"{name} grows without end: {ENDLESS_ADVICE.get(kind, 'the data set it no upper end; leave it out')}"
            )
    try:
        problem.residuals(ended)
    except (TorsionnetError, ArithmeticError):  # a model that cannot do without it, as without a stiffness
        ended = values
    return ended, said
