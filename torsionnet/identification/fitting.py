"""Identification of parameters by least squares over all measurements of a drivetrain."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Literal, TypeAlias

import numpy as np

from torsionnet.base.errors import SolveError, UsageError, did_you_mean
from torsionnet.base.threads import one_thread
from torsionnet.drivetrain import Drivetrain
from torsionnet.identification.causes import (
    BETWEEN,
    Cause,
    CauseFit,
    Solve,
    explaining_fits,
    fit_causes,
    possible_causes,
    starts_of_causes,
    sum_of_squares,
    under_own_noise,
    with_causes,
)
from torsionnet.identification.fit import Fit, make_fit, stepwise_optimum
from torsionnet.identification.fit_problem import FitProblem, make_problem
from torsionnet.identification.fit_search import (
    CONVERGENCE_TOLERANCE,
    LeastSquaresSolution,
    local_optimum,
    loss_weights,
    relative_misfits,
    typical_steps,
)
from torsionnet.identification.lack_of_fit import Explanation, LackOfFit, misfits
from torsionnet.identification.plan.fit_entries import Unknown, read_unknowns
from torsionnet.identification.residuals.measurement import Measurement
from torsionnet.identification.residuals.sampled_response import FORMS
from torsionnet.identification.residuals.stepped_block import SteppedBlock
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.signals.recording import Recording
from torsionnet.signals.uncertainty import ENOUGH_STEPS, resolution

# Explanations of a misfit, each one additional unknown with which the model would fit, and the values it then has.

CAUSES_FITTED_FIRST = 6
"""Number of causes of a misfit that are fitted first, those that would reduce it most by a linear estimate, to save
time."""
LEAST_INDEPENDENT_EFFECT = 1e-6
"""Share of a cause's effect on the residuals that the parameters must be unable to reproduce, as less is rounding; a
cause below it is ignored."""

Errors = Callable[[FitProblem, LeastSquaresSolution], Mapping[str, float]]
"""Function that returns the standard errors (SI) at an optimum of a fit problem by name of the unknown."""


def explanations(problem: FitProblem, values: FloatArray, solve: Solve, errors: Errors) -> tuple[Explanation, ...]:
    """Explanations of the misfit of a fit, the best first, with others about as good; empty if none removes most."""
    whole = sum_of_squares(problem, values)
    starts = starts_of_causes(problem, values)
    # No linear step shows a reference angle, which is found from afar, nor a course between samples, which jumps.
    turned = [cause for cause in possible_causes(problem) if cause.kind in ("reference_angle", BETWEEN)]
    first = list(dict.fromkeys([*turned, *(cause for start in starts for cause in _promising(problem, start))]))
    tried = fit_causes(problem, first, starts, solve, whole)
    good = explaining_fits(tried, whole)
    if not good:  # the linear estimate may have picked the wrong causes
        others = [cause for cause in possible_causes(problem) if cause not in first]
        good = explaining_fits(fit_causes(problem, others, starts, solve, whole), whole)
    explained = [_explained(cause_fit, cause_fit.sum_of_squares / whole, solve, errors) for cause_fit in good]
    return tuple(explanation for explanation in explained if explanation.complete or not explained[0].complete)


def _promising(problem: FitProblem, values: FloatArray) -> list[Cause]:
    """Causes of a misfit that a linear step predicts to reduce it most, the best first."""
    causes = [cause for cause in possible_causes(problem) if cause.kind != BETWEEN]
    wide = with_causes(problem, causes, values, instead=False)
    residuals, slopes = _residuals_by_configuration(wide, problem.names)
    own = [wide.names.index(name) for name in problem.names]
    # Squares that a linear step with one cause removes, beyond what the unknowns of the fit could remove themselves.
    basis, _ = np.linalg.qr(_scaled(slopes[:, own]))
    gains = []
    for cause in causes:
        columns = [index for index, name in enumerate(wide.names) if name.partition("[")[0] == cause.unknown]
        more = _scaled(slopes[:, columns])
        rest = more - basis @ (basis.T @ more)
        seen = np.linalg.norm(rest, axis=0) > LEAST_INDEPENDENT_EFFECT
        fresh, _ = np.linalg.qr(rest[:, seen])
        gains.append(float(np.sum((fresh.T @ residuals) ** 2)))
    order = np.argsort(gains)[::-1][:CAUSES_FITTED_FIRST]
    return [causes[place] for place in order if gains[place] > 0]


def _residuals_by_configuration(wide: FitProblem, names: tuple[str, ...]) -> tuple[FloatArray, FloatArray]:
    """Residuals and derivatives where unknowns other than ``names`` have the values of each test's configuration."""
    parts, slopes = [], []
    for block, place in zip(wide.blocks, wide.unknown_indices, strict=True):
        own = dict(zip(block.response.names, block.response.start.tolist(), strict=True))
        at = wide.start[place]
        for number, index in enumerate(place):
            if wide.names[index] not in names:
                at[number] = own.get(wide.names[index], at[number])
        residual, jacobian = block.residuals(at)
        whole = np.zeros((len(residual), len(wide.names)))
        np.add.at(whole.T, place, jacobian.T)
        parts.append(residual)
        slopes.append(whole)
    return np.concatenate(parts), np.concatenate(slopes)


def _scaled(columns: FloatArray) -> FloatArray:
    return np.asarray(columns / np.maximum(np.linalg.norm(columns, axis=0), np.finfo(float).tiny))


def _explained(cause_fit: CauseFit, left: float, solve: Solve, errors: Errors) -> Explanation:
    cause, tried = cause_fit.cause, cause_fit.problem
    optimum = under_own_noise(cause_fit, solve)
    at = optimum.x
    before = tried.start[tried.names.index(cause.unknown)] if cause.is_value else None
    return Explanation(
        kind=cause.kind,
        of=cause.place(tried),
        unknown=cause.unknown,
        values=dict(zip(tried.names, at.tolist(), strict=True)),
        standard_errors=errors(tried, optimum),
        before=None if before is None else float(before),
        complete=not any(misfit.rejected for misfit in misfits(tried, at)),
        left=left,
        between=cause.between,
    )


def data_remarks(problem: FitProblem) -> tuple[str, ...]:
    """Remarks on records compared where the sensor moves by few of its steps, and on what one harmonic leaves out."""
    remarks = []
    for block in problem.blocks:
        measurement = block.measurement
        if isinstance(block, SteppedBlock) and not block.has_harmonics:
            remarks.append("one harmonic of the motion is compared: periodic_response tells whether the others count")
        if isinstance(measurement.data, Recording) and not measurement.equations:
            steps = resolution(measurement.data, measurement.output, measurement.input)
            if steps is not None and steps.enough_up_to < block.frequencies[-1]:
                limit = f"{steps.enough_up_to:.3g} Hz"
                remarks.append(
                    f"{measurement.output} moves by less than {ENOUGH_STEPS:g} of its steps above {limit}: "
                    "end the band there"
                )
    return tuple(dict.fromkeys(remarks))


Loss: TypeAlias = Literal["linear", "soft_l1", "huber", "cauchy"]
LOSSES = ("linear", "soft_l1", "huber", "cauchy")
NOISE_ROUNDS = 3
"""Times that a fit of records estimates their noise again, as it hardly changes after the first."""
SETTLED_CHANGE = 1e-3
"""Relative change of all fitted values below which the noise of records is not estimated again."""
LINE_NOISE_ROUNDS, SETTLED_BY_LINES = 12, 1e-6
"""Times that a fit of responses estimates their noise again at most, and the relative change of all fitted values
below which it does not: responses are quickly calculated, and their first weights are far from their noise."""
HARMONIC_ROUNDS = 4
"""Times that harmonics are calculated again, which depend little on the values."""
MISSED_SHARE = 0.5
"""RMS of model minus test over RMS of the test above which lines are compared by their magnitudes, too."""
IDLE_EFFECT = 1e-10
"""Effect of a parameter on the response, over the response in standard deviations, below which it is rounding and the
parameter does not act."""


@one_thread()
def identify(
    model: Drivetrain,
    measurements: Measurement | Sequence[Measurement],
    parameters: str | Sequence[str] | Mapping[str, Unknown | float | None],
    *,
    residual: Literal["complex", "log", "magnitude"] = "complex",
    loss: Loss = "linear",
    starts: int = 1,
    seed: int = 0,
) -> Fit:
    """Fit of parameters of a drivetrain to one or several measurements, with standard errors and test of lack of fit.

    Parameters
    ----------
    model : Drivetrain
    measurements : Measurement or sequence of these
        Each names the configuration it was made in; parameters are shared unless they are free per configuration.
    parameters : str, sequence of str, or mapping
        Names of parameters or ``element.field``; in a mapping with a start value in SI or an :class:`Unknown`.
    residual : {"complex", "log", "magnitude"}, optional
        Difference of the complex values, of log magnitude and phase, or of log magnitude alone, which is all that
        responses without a phase have. Responses are weighted by the error stated or by the coherence where there is
        one, else by a noise with a part equal in all lines and one in proportion to the model, as their scatter says.
    loss : {"linear", "soft_l1", "huber", "cauchy"}, optional
        Loss function; the robust ones give less weight to outlying lines, judged by the scatter of most lines.
    starts : int, optional
        Number of start values; all but the first are drawn within the bounds (a decade about the first without bounds).
    seed : int, optional
        Seed of the start values drawn.

    Returns
    -------
    Fit

    Raises
    ------
    UsageError
        Names that are not there, unlike units, a band without lines, parameters that do not act on the data, or more
        parameters than data.
    SolveError
        The fit does not converge, or ends where its errors cannot be calculated.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("dmf_rig")
    >>> test = rig.frequency_response("theta_1", "T_T", np.linspace(1, 20, 40))
    >>> fit = tn.identify(rig.configured(c_2=10), tn.Measurement(test, "theta_1", "T_T"), ["c_2"])
    >>> round(fit.values["c_2"], 6)
    4.0
    """
    for what, given, known in (("residual", residual, FORMS), ("loss", loss, LOSSES)):
        if given not in known:
            raise UsageError(
                f'no {what} is named "{given}"{did_you_mean(str(given), known)}; there is {", ".join(known)}',
                kind="unknown-word",
            )
    listed = [measurements] if isinstance(measurements, Measurement) else list(measurements)
    if not listed:
        raise UsageError("there is nothing measured to fit to", kind="missing-entry")
    problem = make_problem(model, listed, read_unknowns(parameters), residual)
    _check_information(problem)
    best = best_optimum(problem, loss, starts, seed)
    if not best.converged or not np.isfinite(best.cost):
        raise SolveError(
            f"the fit does not converge: {best.message}; try other start values, bounds, or starts=10",
            kind="no-solution",
        )
    try:
        return _judge_fit(model, problem, best, loss)
    except np.linalg.LinAlgError as error:
        values = ", ".join(f"{name} = {x:.3g}" for name, x in zip(problem.names, best.x, strict=True))
        text = f"the standard errors cannot be calculated where the fit ends, at {values} ({error})"
        raise SolveError(
            f"{text}; fix a parameter, give bounds, or take other start values", kind="no-solution"
        ) from None


def best_optimum(problem: FitProblem, loss: str, starts: int = 1, seed: int = 0) -> LeastSquaresSolution:
    """Best optimum of a fit from several start values, weighed by the noise that it leaves itself."""
    begun = _starts_and_reversed(problem, starts, seed)
    best, start = min(((local_optimum(problem, start, loss), start) for start in begun), key=lambda pair: pair[0].cost)
    # Steps from the start that was given must not be missed where another one, drawn at random, led further at once.
    for first in [start] if start is begun[0] else [start, begun[0]]:
        best = stepwise_optimum(problem, best, first, loss)
    if problem.has_records:
        return _optimum_with_its_noise(problem, best, loss, problem.learn_noise, NOISE_ROUNDS, SETTLED_CHANGE)
    if problem.has_unknown_noise:
        return _optimum_with_its_noise(problem, best, loss, problem.learn_noise, LINE_NOISE_ROUNDS, SETTLED_BY_LINES)
    return best


def _judge_fit(model: Drivetrain, problem: FitProblem, best: LeastSquaresSolution, loss: Loss) -> Fit:
    """Result of a fit, weighed by measured noise and with explanations of the misfit if the model does not fit."""
    lack = LackOfFit(misfits(problem, best.x, loss_weights(problem.residuals(best.x), loss, best.scale)))
    if lack.rejected and any(isinstance(block, SteppedBlock) for block in problem.blocks):
        best = _with_harmonics(problem, best, loss)
        lack = LackOfFit(misfits(problem, best.x, loss_weights(problem.residuals(best.x), loss, best.scale)))
    if not lack.rejected and problem.has_unknown_noise and relative_misfits(problem, best.x).max() > MISSED_SHARE:
        # A response that is missed altogether jumps at its peaks as noise would; its logarithm does not.
        problem.forget_noise()
        lack = LackOfFit(misfits(problem, best.x))
    if not lack.rejected:
        if problem.has_unknown_noise:

            def learn(values: FloatArray) -> None:
                trust = loss_weights(problem.residuals(values), loss, best.scale)
                problem.learn_from_residuals(values, trust)

            best = _optimum_with_its_noise(problem, best, loss, learn, LINE_NOISE_ROUNDS, SETTLED_BY_LINES)
        return make_fit(model, problem, best, loss, lack)
    problem.take_measured_noise(best.x)
    best = local_optimum(problem, best.x, loss)

    def solve(tried: FitProblem, start: FloatArray, tolerance: float = CONVERGENCE_TOLERANCE) -> LeastSquaresSolution:
        return local_optimum(tried, start, loss, tolerance)

    def errors(tried: FitProblem, at: LeastSquaresSolution) -> Mapping[str, float]:
        return make_fit(model, tried, at, loss).standard_errors

    reasons = explanations(problem, best.x, solve, errors)
    lack = replace(lack, explanations=reasons, data_warnings=data_remarks(problem))
    return make_fit(model, problem, best, loss, lack)


def _with_harmonics(problem: FitProblem, best: LeastSquaresSolution, loss: str) -> LeastSquaresSolution:
    """Optimum for steps of sines with all harmonics of the twist, which one harmonic by itself does not fit."""
    for _ in range(HARMONIC_ROUNDS):
        before = best.x
        for block, place in zip(problem.blocks, problem.unknown_indices, strict=True):
            if isinstance(block, SteppedBlock):
                block.take_harmonics(before[place])
        problem.clear_cache()
        best = local_optimum(problem, before, loss)
        if _moved(before, best.x) < SETTLED_CHANGE:
            break
    return best


def _optimum_with_its_noise(
    problem: FitProblem,
    best: LeastSquaresSolution,
    loss: str,
    learn: Callable[[FloatArray], None],
    rounds: int,
    settled: float,
) -> LeastSquaresSolution:
    """Optimum under the noise that it leaves itself, each found from the other by turns."""
    for _ in range(rounds):
        before = best.x
        learn(before)
        best = local_optimum(problem, before, loss)
        if _moved(before, best.x) < settled:
            break
    return best


def _moved(before: FloatArray, after: FloatArray) -> float:
    return float(np.max(np.abs(after - before) / np.maximum(np.abs(before), 1e-300)))


def _starts_and_reversed(problem: FitProblem, count: int, seed: int) -> list[FloatArray]:
    """Start values, each (n,), with other likely reference angles and delays, or a channel reversed where nearer."""
    starts = _starts(problem, count, seed)
    starts += problem.starts_with_other_references(starts[0])
    late = problem.start_with_long_delays(starts[0])
    starts += [] if np.array_equal(late, starts[0]) else [late]
    return [
        *starts,
        *(
            other
            for start in starts
            if (other := problem.start_with_reversed_channels(start)).tobytes() != start.tobytes()
        ),
    ]


def _starts(problem: FitProblem, count: int, seed: int) -> list[FloatArray]:
    rng = np.random.default_rng(seed)
    starts = [problem.start]
    # Without bounds a decade on either side of the start, drawn evenly over the logarithm.
    lower = np.where(np.isfinite(problem.lower) & (problem.lower > 0), problem.lower, np.abs(problem.start) / 10)
    upper = np.where(np.isfinite(problem.upper), problem.upper, np.abs(problem.start) * 10)
    for _ in range(count - 1):
        positive = (problem.start > 0) & (lower > 0) & (upper > 0)
        drawn = problem.start.copy()
        exponent = rng.random(len(drawn))
        drawn[positive] = lower[positive] * (upper[positive] / lower[positive]) ** exponent[positive]
        starts.append(np.clip(drawn, problem.lower, problem.upper))
    return starts


def _check_information(problem: FitProblem) -> None:
    residuals, slopes = problem.residuals_and_jacobian(problem.start)
    if len(residuals) < len(problem.names):
        raise UsageError(
            f"{len(problem.names)} parameters cannot be found from {problem.lines} lines: "
            f"{', '.join(problem.names)}; measure more, or fix some of them",
            kind="too-short",
        )
    effects = np.abs(slopes).max(axis=0) * typical_steps(problem, problem.start)
    seen = max(float(np.max(np.abs(block.measured)) / np.min(block.deviations)) for block in problem.blocks)
    idle = [name for name, size in zip(problem.names, effects, strict=True) if not size > IDLE_EFFECT * seen]
    # Of a law of motion, what the record never visits is not seen, which the result says.
    if idle and (not problem.has_equations or len(idle) == len(problem.names)):
        pairs = ", ".join(dict.fromkeys(block.measurement.channels for block in problem.blocks))
        does = "does" if len(idle) == 1 else "do"
        raise UsageError(
            f"{', '.join(idle)} {does} not act on {pairs}; leave {'it' if len(idle) == 1 else 'them'} out",
            kind="unseen-parameter",
        )


@one_thread()
def refit_with_noise_of(other: Fit, model: Drivetrain, fit: Fit) -> Fit:
    """Fit repeated from its optimum with the noise that another fit of the same measurements left unexplained."""
    assert fit.problem is not None
    assert other.problem is not None
    count = sum(block.count for block in other.problem.blocks) - len(other.values)
    left = max(other.chi_squared / max(count, 1), np.finfo(float).tiny)
    for block, theirs in zip(fit.problem.blocks, other.problem.blocks, strict=True):
        block.take_noise(theirs, left)
    fit.problem.clear_cache()
    solution = local_optimum(fit.problem, np.array(list(fit.values.values())), "linear")
    return make_fit(model, fit.problem, solution, "linear", LackOfFit(misfits(fit.problem, solution.x)))
