"""Search for a local optimum of a fit, with or without a robust loss, and verdicts in words on what it found."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from torsionnet.base.errors import SolveError
from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.lack_of_fit import noise_bias_sentence
from torsionnet.identification.residuals.equation_block import EquationBlock
from torsionnet.identification.residuals.measurement_block import MeasurementBlock
from torsionnet.identification.residuals.response_blocks import ResponseBlock
from torsionnet.identification.residuals.stepped_block import SteppedBlock
from torsionnet.identification.residuals.stepped_curve import names_of_laws, springs_of_sliders
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.signals.uncertainty import LEAST_BINS, half_power_bandwidth, significant_peaks

# Search for a local optimum of a least-squares fit of parameters, with or without a robust loss.

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


# Verdicts on a fit in words, about undetermined or correlated parameters, values at bounds, odd measurements.

INDISTINGUISHABLE_CORRELATION, DISTINGUISHED_RELATIVE_ERROR = 0.95, 0.05
"""Correlation of two fitted parameters above which a verdict says that the data cannot distinguish them, unless the
standard errors of both, over their values, are no larger than this: then the data do, however related they are."""
NO_SCATTER = "the model leaves nothing but rounding, from which no error follows: intervals are withheld"
"""Verdict on a fit to what has no noise, such as a calculated response."""
ROUNDED_MISFIT = 1e-12
"""RMS of model minus test over RMS of the test up to which rounding is all of it."""
VAGUE_RELATIVE_ERROR = 0.3
"""Standard error of a fitted value, over the value, above which a verdict says that it is hardly determined."""
OUTLYING_MISFIT_RATIO = 2.0
"""Misfit of one measurement over the median of the others above which a verdict says that it does not fit them."""
AT_BOUND_DISTANCE = 1e-6
"""Relative distance to a bound within which a fitted value stands at it, as the search ends inside the bound by
rounding."""
UNSEEN_EFFECT = 1e-9
"""Effect of a whole value on the residuals, over that of the strongest, up to which it is none but rounding."""
SLIPPING_SWINGS = 5.0
"""Swing over the twist at which a slider begins to slip, from which its spring tells hardly anything."""
NARROW_PEAK_ADVICE = "fit the record itself, which has no such error, or use longer windows"


def verdicts(
    problem: FitProblem,
    values: FloatArray,
    errors: FloatArray,
    correlation: FloatArray,
    lost: FloatArray,
    moved: FloatArray,
    ended: Collection[str] = (),
) -> tuple[str, ...]:
    """Verdicts on a fit in words, one sentence each; values that ``ended`` at zero or infinity are left out."""
    return (
        *_combinations(problem, lost, ended),
        *_alike(problem, values, errors, correlation),
        *_vague(problem, values, errors, ended),
        *_bounds(problem, values, ended),
        *_odd(problem, values),
        *noise_bias_sentence(problem, values, errors, moved),
        *_narrow_peaks(problem, values),
    )


def not_seen(problem: FitProblem, values: FloatArray, errors: FloatArray, ended: Collection[str]) -> dict[str, str]:
    """Sentence by name for each value of a law of motion that the swings measured tell nothing of.

    These are breaks beyond all swings and stages behind them, values lost in the noise, and the spring of a slider
    that slips nearly all the time.
    """
    effects = np.linalg.norm(problem.jacobian(values), axis=0) * np.abs(values)
    sentences: dict[str, str] = {}
    for block in problem.blocks:
        if not isinstance(block, SteppedBlock | EquationBlock):
            continue
        curve = block.curve_of_steps if isinstance(block, SteppedBlock) else block.equation
        swings, laws = block.swings, (curve.unknowns, curve.elements)
        sliding = springs_of_sliders(*laws, values[: len(curve.names)])
        for name in names_of_laws(*laws):
            place = problem.names.index(name) if name in problem.names else -1
            if place < 0 or name in sentences or name in ended:
                continue
            limit = sliding.get(name, np.inf)
            if effects[place] <= UNSEEN_EFFECT * effects.max():
                sentences[name] = f"{name} is not seen: no swing reaches it, the largest is {swings.max():.3g} rad"
            elif swings.min() > SLIPPING_SWINGS * limit:
                sentences[name] = f"{name} is not seen: it slips at {limit:.3g} rad, and no swing is below 5 times that"
            elif not errors[place] < abs(values[place]) / 2:
                most = abs(values[place]) + 2 * errors[place]
                sentences[name] = f"{name} is not seen: it is lost in the noise, and at most about {most:.2g}"
    return sentences


def _where(problem: FitProblem) -> str:
    labels = [block.measurement.label for block in problem.blocks]
    return f"in {labels[0]} alone" if len(labels) == 1 else f"in {', '.join(labels)}"


def _combinations(problem: FitProblem, lost: FloatArray, ended: Collection[str]) -> Iterator[str]:
    """Sentence for each combination of parameters that the data of a fit do not determine."""
    for direction in lost:
        members = np.flatnonzero(np.abs(direction) > 1e-3 * np.abs(direction).max())
        if all(problem.names[index] in ended for index in members):
            continue
        names = " and ".join(problem.names[index] for index in members)
        yield (
            f"{names} cannot be told apart {_where(problem)}: the data fix only a combination of them. "
            "Fix one, or add a measurement in which they act differently"
        )


def _alike(problem: FitProblem, values: FloatArray, errors: FloatArray, correlation: FloatArray) -> Iterator[str]:
    steps = typical_steps(problem, problem.start)
    sizes = np.where([name.startswith("delay[") for name in problem.names], steps, np.abs(values))
    for first, second in combinations(range(len(problem.names)), 2):
        pair = [first, second]
        if (
            abs(float(correlation[first, second])) > INDISTINGUISHABLE_CORRELATION
            and np.isfinite(errors[pair]).all()
            and (errors[pair] > DISTINGUISHED_RELATIVE_ERROR * sizes[pair]).any()
        ):
            both = f"{problem.names[first]} and {problem.names[second]}"
            yield f"{both} are indistinguishable {_where(problem)}: correlation {correlation[first, second]:.2f}"


def _vague(problem: FitProblem, values: FloatArray, errors: FloatArray, ended: Collection[str]) -> Iterator[str]:
    for name, value, error in zip(problem.names, values, errors, strict=True):
        if (
            name not in ended
            and np.isfinite(error)
            and error > VAGUE_RELATIVE_ERROR * abs(value)
            and not name.startswith("delay[")
        ):
            yield f"{name} is hardly determined: {value:.3g} with a standard error of {error:.2g}"


def _bounds(problem: FitProblem, values: FloatArray, ended: Collection[str]) -> Iterator[str]:
    for name, value, low, high in zip(problem.names, values, problem.lower, problem.upper, strict=True):
        for bound in (low, high):
            if (
                name not in ended
                and np.isfinite(bound)
                and abs(value - bound) <= AT_BOUND_DISTANCE * max(abs(value), abs(bound), 1e-300)
            ):
                yield f"{name} stands at its bound {bound:g}: its standard error means nothing there"


def _odd(problem: FitProblem, values: FloatArray) -> Iterator[str]:
    """Sentence for each measurement of a fit that the model fits much worse than the others.

    Not where the stated noise explains it: a precise channel beside a noisy one is no contradiction.
    """
    misfits = relative_misfits(problem, values)
    if len(misfits) < 2:
        return
    for number, misfit in enumerate(misfits):
        others = np.delete(misfits, number)
        block, place = problem.blocks[number], problem.unknown_indices[number]
        if misfit > OUTLYING_MISFIT_RATIO * np.median(others) and not _within_noise(block, values[place]):
            label = block.measurement.label
            yield (
                f"{label} does not fit the others: its response is off by {100 * misfit:.2g} % (RMS), theirs by "
                f"{100 * float(np.median(others)):.2g} %; free a parameter per configuration, or fit it alone"
            )


def _within_noise(block: MeasurementBlock, values: FloatArray) -> bool:
    """Whether the noise stated for a measurement explains its misfit."""
    return block.noise_is_stated and bool(np.mean(block.residuals(values)[0] ** 2) <= OUTLYING_MISFIT_RATIO**2)


def is_rounding_alone(problem: FitProblem, values: FloatArray) -> bool:
    """Whether rounding is all that a model leaves of every measurement of a fit."""
    return bool(relative_misfits(problem, values).max() <= ROUNDED_MISFIT)


def has_no_scatter(problem: FitProblem, values: FloatArray) -> bool:
    """Whether nothing tells of the errors of a fit: rounding alone is left, and a test says nothing of its noise."""
    return any(block.noise_is_unknown for block in problem.blocks) and is_rounding_alone(problem, values)


def relative_misfits(problem: FitProblem, values: FloatArray) -> FloatArray:
    """RMS of model minus test over RMS of the test, for each measurement, shape (n_measurements,)."""
    misfits = []
    for block, place in zip(problem.blocks, problem.unknown_indices, strict=True):
        predicted, measured = block.predicted(values[place])[0], block.measured
        error = np.abs(predicted) - np.abs(measured) if block.form == "magnitude" else predicted - measured
        misfits.append(np.sqrt(np.sum(np.abs(error) ** 2) / np.sum(np.abs(block.measured) ** 2)))
    return np.array(misfits)


def _narrow_peaks(problem: FitProblem, values: FloatArray) -> Iterator[str]:
    """Sentence for each peak of a response so narrow that the windows of its estimate act like damping."""
    for block, place in zip(problem.blocks, problem.unknown_indices, strict=True):
        if isinstance(block, ResponseBlock) and block.data.coherence is not None:
            yield from _narrow(block, values[place])


def _narrow(block: ResponseBlock, values: FloatArray) -> Iterator[str]:
    smooth, f = block.smoothing, block.frequencies
    if len(f) < 2 or (smooth is not None and smooth.exact):
        return
    bin_width = float(np.diff(f).min())
    curve, lines = block.curve(values), block.fine
    for peak in significant_peaks(np.abs(curve)):
        width = half_power_bandwidth(lines, np.abs(curve), peak)
        if not f[0] <= lines[peak] <= f[-1] or not width < LEAST_BINS * bin_width:
            continue
        label = block.measurement.label
        about = f"{label}: the peak at {lines[peak]:.3g} Hz is {width:.2g} Hz wide, under {LEAST_BINS} lines"
        if smooth is None:
            yield f"{about}: what windows did to it passes for damping; {NARROW_PEAK_ADVICE}"
        else:
            yield f"{about}: windows under a sweep are corrected in part, and the errors widened; {NARROW_PEAK_ADVICE}"
