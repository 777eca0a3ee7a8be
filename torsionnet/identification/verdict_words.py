"""Verdicts on a fit in words, about undetermined or correlated parameters, values at bounds, odd measurements."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from itertools import combinations

import numpy as np

from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.fit_search import typical_steps
from torsionnet.identification.lack_of_fit import noise_bias_sentence
from torsionnet.identification.residuals.equation_block import EquationBlock
from torsionnet.identification.residuals.measurement_block import MeasurementBlock
from torsionnet.identification.residuals.response_block import ResponseBlock
from torsionnet.identification.residuals.stepped_block import SteppedBlock
from torsionnet.identification.residuals.stepped_curve import names_of_laws, springs_of_sliders
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.signals.uncertainty import LEAST_BINS, half_power_bandwidth, significant_peaks

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
