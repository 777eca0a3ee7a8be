"""Test of lack of fit, whether the residuals of a fit are larger than noise or have a pattern over frequency."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import scipy

from torsionnet.base.number_text import value_with_error
from torsionnet.base.result_rows import Out
from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.residuals.measurement_block import MeasurementBlock
from torsionnet.identification.residuals.noise import Noise
from torsionnet.identification.residuals.response_blocks import RecordBlock
from torsionnet.identification.residuals.sampled_response import errors_in_form, parts
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray

# Bias of fitted values by noise on the signal that H1 or H2 multiplies by, in records without a clean reference.

REPORTED_BIAS = 0.5
"""Bias of a fitted value, in standard errors, above which a verdict reports it, as a smaller one is lost in the
error."""


def noise_shift(problem: FitProblem, values: FloatArray) -> FloatArray:
    """Mean that squared noise gives to the weighted residuals, (n_residuals,), from the sensor noise of the fit."""
    shifts = np.zeros(len(problem.residuals(values)))
    for block, span, place in zip(problem.blocks, problem.residual_slices, problem.unknown_indices, strict=True):
        if isinstance(block, RecordBlock):
            shift = _shift(block, values[place])
            shifts[span] = errors_in_form(block.form, parts(shift)[:, None], block.measured)[:, 0] / block.sizes
    return shifts


def noise_bias(problem: FitProblem, values: FloatArray) -> FloatArray:
    """Bias of the fitted values by squared noise of the sensors, in SI, (n,)."""
    shift = noise_shift(problem, values)
    if not shift.any():
        return np.zeros(len(values))
    return np.asarray(-np.linalg.lstsq(problem.jacobian(values), shift, rcond=None)[0])


def _shift(block: RecordBlock, values: FloatArray) -> ComplexArray:
    """Bias that squared noise gives to model minus test at each line of a record, complex, SI, (n_b,)."""
    windowed, (on_output, on_input) = block.windowed, block.sources
    rows = windowed.rows
    # Squared noise in the denominator of H1 makes it read low, that in the numerator of H2 high.
    own = np.where(windowed.background, len(rows.weights) * rows.squares / windowed.power, 0.0)[block.kept]
    if not own.any():
        return np.asarray(own, dtype=complex)
    if windowed.instrument.estimator == "H2":
        return np.asarray(-on_output * own)
    return np.asarray(on_input * own * block.predicted(values)[0])


def noise_bias_sentence(
    problem: FitProblem, values: FloatArray, errors: FloatArray, moved: FloatArray
) -> Iterator[str]:
    """Sentence on the fitted values that noise biases by more than half a standard error, if there are any."""
    listed = [
        f"{name} reads about {100 * abs(change / value):.2g} % {'high' if change * value > 0 else 'low'}"
        for name, value, change, error in zip(problem.names, values, moved, errors, strict=True)
        if np.isfinite(error) and value and abs(change) > REPORTED_BIAS * error
    ]
    if not listed:
        return
    blocks = [block for block in problem.blocks if isinstance(block, RecordBlock) and block.windowed.background.any()]
    measurement, estimator = blocks[0].measurement, blocks[0].windowed.instrument.estimator
    signal, other = measurement.input, "H2"
    if estimator == "H2":
        signal, other = measurement.output, "H1"
    yield (
        f"noise on {signal} biases {estimator}: {', '.join(listed)}, by which the intervals are widened; name the "
        f"set-point as reference, or take {other} if the other sensor is less noisy"
    )


FALSE_ALARM_PROBABILITY = 1e-3
"""Probability of calling noise a misfit for every measurement of a fit, small because a misfit withholds all
intervals."""
PATTERN_COUNT = 5
"""Number of patterns of residuals over frequency that are looked for, cosines of up to four half periods over the
lines."""
ABSORBED_VARIANCE_SHARE = 1e-3
"""Variance of a pattern of residuals, over the largest one, below which the fitted parameters have absorbed it."""
NEGLIGIBLE_MISFIT = 2e-3
"""RMS of the misfit over RMS of the response below which it is ignored, as sensors are not calibrated any better."""


@dataclass(frozen=True)
class Misfit:
    """Test of one measurement against the fitted model, with residuals over noise and the probability of noise alone.

    Attributes
    ----------
    name : str
        Name of the measurement.
    ratio : float
        RMS of the residuals over what noise alone would leave.
    size : float
        RMS of the difference beyond noise, over that of the response.
    probability : float
        Probability that noise alone leaves residuals as large, or as clear a pattern over frequency.
    """

    name: str
    ratio: float
    size: float
    probability: float

    @property
    def rejected(self) -> bool:
        """Whether the model does not fit this measurement, by probability and size of the misfit."""
        return self.probability < FALSE_ALARM_PROBABILITY and self.size > NEGLIGIBLE_MISFIT


@dataclass(frozen=True)
class Explanation:
    """Explanation of a misfit by one additional unknown, with its value and those of all parameters then, SI.

    Attributes
    ----------
    kind : {"delay", "gain", "reference_angle", "moving_inertia", "hysteretic", "viscous", "ratio", "value",
        "misfire", "gas_torque", "between", "friction", "stage"}
    of : str
        The signal that is late, too large or turned, the element with another kind of damping or with friction or a
        stage left out, the value set free, or the cylinder that misfires.
    values, standard_errors : mapping of str to float
        Values and errors of all parameters with the additional unknown, which is among them, SI.
    before : float or None
        Value that the model had for the unknown, SI.
    complete : bool
        Whether nothing but noise is left.
    left : float
        Sum of squares left over that of the fit.
    between : str
        Course of the signal between samples with which the model would fit; empty for other kinds.
    """

    kind: str
    of: str
    unknown: str
    values: Mapping[str, float]
    standard_errors: Mapping[str, float]
    before: float | None
    complete: bool
    left: float
    between: str = ""


@dataclass(frozen=True)
class LackOfFit:
    """Result of the test of lack of fit for all measurements of a fit, with what would explain a misfit.

    Attributes
    ----------
    measurements : tuple of Misfit
        Tests of the measurements whose noise can be told apart from the model's error.
    explanations : tuple of Explanation
        Single additional unknowns with which the model would fit, the best first; only if it does not fit.
    data_warnings : tuple of str
        Warnings about the data, in words.
    """

    measurements: tuple[Misfit, ...]
    explanations: tuple[Explanation, ...] = ()
    data_warnings: Annotated[tuple[str, ...], Out(json="doubts")] = ()

    @property
    def rejected(self) -> Annotated[bool, Out(json="rejected")]:
        """Whether the model does not fit any one measurement, so that its values have no intervals."""
        return any(misfit.rejected for misfit in self.measurements)


def misfits(problem: FitProblem, values: FloatArray, weights: FloatArray | None = None) -> tuple[Misfit, ...]:
    """Tests of all measurements whose noise is known apart from the model, with the ``weights`` of a robust loss.

    The residuals of the optimum, r = (1 - P) e with the projection P on what the parameters can do, have the covariance
    (1 - P) R (1 - P) under noise of the covariance R. Sums of squares of them are compared with their mean and scatter
    under that (Satterthwaite); patterns are sums along cosines over the lines. The bias of residuals by squared noise
    is subtracted before.
    """
    residuals, slopes = problem.residuals_and_jacobian(values)
    shift = noise_shift(problem, values)
    basis, _ = np.linalg.qr(slopes / np.maximum(np.linalg.norm(slopes, axis=0), np.finfo(float).tiny))
    # Of that shift the fit has taken up the part Q Q^T, and the rest is left in the residuals.
    residuals = residuals * (1.0 if weights is None else weights) - shift + basis @ (basis.T @ shift)
    tests = [
        block.measured_noise(values[place])
        for block, place in zip(problem.blocks, problem.unknown_indices, strict=True)
    ]
    every = zip(problem.blocks, problem.residual_slices, problem.unknown_indices, tests, strict=True)
    seen = [(block, span, values[place], noise) for block, span, place, noise in every if noise]
    known = [(block, span, noise) for block, span, _, noise in seen]
    covariances = [_covariance(block, noise, mine) for block, _, mine, noise in seen]
    spread = basis.copy()
    for (_, span, _), covariance in zip(known, covariances, strict=True):
        spread[span] = covariance @ basis[span]
    both = basis.T @ spread
    result = []
    for (block, span, noise), covariance in zip(known, covariances, strict=True):
        Q, S = basis[span], spread[span]
        # Covariance of residuals of a fit, (I - Q Q^T) C (I - Q Q^T), the block of this measurement.
        left = covariance - Q @ S.T - S @ Q.T + Q @ both @ Q.T
        result.append(_judge_block(block, residuals[span], left, noise))
    return tuple(result)


def _covariance(block: MeasurementBlock, noise: Noise, values: FloatArray) -> FloatArray:
    """Covariance (count, count) of a measurement's weighted residuals by its noise and by systematic errors."""
    size = np.sqrt(np.tile(noise.ratio, block.parts))
    return np.asarray(block.known_correlation * np.outer(size, size) + block.systematic_covariance(values))


def _judge_block(block: MeasurementBlock, residual: FloatArray, covariance: FloatArray, noise: Noise) -> Misfit:
    count = len(noise.ratio)
    scale = 1 / np.sqrt(np.tile(noise.ratio, len(residual) // count))
    r, R = residual * scale, covariance * np.outer(scale, scale)
    mean, square = float(np.trace(R)), float(np.sum(R**2))
    total = float(r @ r) / mean
    # By Satterthwaite the sum over its mean has (tr R)^2/tr R^2 degrees of freedom.
    chances = [float(scipy.stats.f.sf(total, mean**2 / square, noise.certainty))]
    # A model that is wrong leaves slow waves over the lines, even where the sum of squares could be noise.
    waves = _waves(count, len(r) // count, block.runs)
    sizes, directions = np.linalg.eigh(waves.T @ R @ waves)
    seen = sizes > ABSORBED_VARIANCE_SHARE * sizes[-1]
    pattern = float(np.mean((directions[:, seen].T @ (waves.T @ r)) ** 2 / sizes[seen]))
    chances.append(float(scipy.stats.f.sf(pattern, int(seen.sum()), noise.certainty)))
    weights = block.absolute_scale**2
    beyond = max(float((residual**2 - np.diag(covariance)) @ weights), 0.0)
    size = np.sqrt(beyond / float(np.sum(np.abs(block.measured) ** 2)))
    # Two tests were made: twice the smaller chance.
    return Misfit(block.measurement.label, float(np.sqrt(total)), float(size), min(1.0, 2 * min(chances)))


def _waves(count: int, parts: int, runs: Sequence[slice]) -> FloatArray:
    """Cosines over each run of lines, in each part of the residuals on its own, (parts * n_lines, n_patterns)."""
    columns = []
    for run in runs:
        length = run.stop - run.start
        waves = np.zeros((count, min(PATTERN_COUNT, length)))
        waves[run] = np.cos(np.pi * np.outer((np.arange(length) + 0.5) / length, np.arange(waves.shape[1])))
        columns.append(waves)
    return np.asarray(np.kron(np.eye(parts), np.concatenate(columns, axis=1)))


# Sentences on lack of fit, which say that a model does not fit, what would explain that and what to do.

ADVICE_BY_CAUSE = {
    "delay": "find it along (delay: true) or mend the channel",
    "gain": "find it along (gain: true), or look for a wrong ratio, calibration or sign",
    "hysteretic": "give the spring a loss factor instead of a viscous damping",
    "viscous": "give the spring a viscous damping instead of a loss factor",
    "reference_angle": "find it along (reference_angle: true), or correct where the reference stands",
    "moving_inertia": "give it to the model, or find it along (moving_inertia: true)",
    "misfire": "look at its injection, or find the share along",
    "gas_torque": "look at its injection, or find the factor along",
    "ratio": "look for other teeth, or correct the ratio",
    "value": "free it too, or correct it",
    "between": "say so by between, in the signal or in the measurement",
    "friction": "give it friction",
    "stage": "give it one more stage",
}
INTERVALS_WITHHELD = "Intervals are withheld"
MOST_EXPLANATIONS_LISTED = 3
"""Number of explanations of a misfit that a sentence lists at most, as more would hide the first."""


def lack_of_fit_sentences(lack: LackOfFit | None) -> Iterator[str]:
    """Sentence on a model that does not fit, with explanation and advice; no sentence if the model fits."""
    if lack is None or not lack.rejected:
        return
    wrong = [misfit for misfit in lack.measurements if misfit.rejected]
    where = "" if len(lack.measurements) == 1 else f" {', '.join(misfit.name for misfit in wrong)}"
    worst = max(misfit.ratio for misfit in wrong)
    says = f"the model does not fit{where}: the residuals are {worst:.2g} times the noise, in a pattern over frequency"
    withheld = "; ".join([INTERVALS_WITHHELD, *lack.data_warnings])
    if not lack.explanations:
        yield (
            f"{says}; no delay, gain, other kind of damping or single other value explains it: look at the residuals, "
            f"or try other starts. {withheld}"
        )
        return
    best, *others = lack.explanations
    verb = "would explain it" if best.complete else "would explain most of it"
    explained = [
        f"{_what(best)} {verb}: {_values(best)}",
        *(f"so would {_what(explanation)}: {_values(explanation)}" for explanation in others),
    ]
    yield f"{says}; {'; '.join(explained[:MOST_EXPLANATIONS_LISTED])}; {ADVICE_BY_CAUSE[best.kind]}. {withheld}"


def _what(explanation: Explanation) -> str:
    values = [value for name, value in explanation.values.items() if name.partition("[")[0] == explanation.unknown]
    return cause_in_words(
        explanation.kind, explanation.of, sum(values) / max(len(values), 1), explanation.before, explanation.between
    )


def cause_in_words(kind: str, of: str, value: float, before: float | None, between: str = "") -> str:
    """Description in words of a cause of a misfit with the value that it would need.

    >>> cause_in_words("gain", "n_out", 0.7767, None), cause_in_words("ratio", "stage.ratio", 2.33, 3.0)
    ('a gain of 0.7767 in n_out', 'stage.ratio = 2.33 instead of 3')
    >>> cause_in_words("gain", "theta_1", -1.002, None)
    'a gain of -1.002 in theta_1 (a channel is reversed)'
    >>> cause_in_words("between", "T_M", float("nan"), None, "band_limited")
    'T_M band-limited between samples'
    """
    if between:
        return f"{of} {between.replace('_', '-')} between samples"
    if kind == "delay":
        return f"a delay of {1e3 * value:.3g} ms in {of}"
    if kind == "gain":
        return f"a gain of {value:.4g} in {of}{' (a channel is reversed)' * (value < 0)}"
    if kind == "reference_angle":
        return f"a reference angle of {math.degrees(value):.4g} deg in {of}"
    if kind == "moving_inertia":
        return f"an inertia of {value:.3g} kg*m^2 that moves between the torque and {of}"
    if kind == "misfire":
        return f"a misfire of {of} ({100 * value:.3g} % of its injection lost)"
    if kind == "gas_torque":
        return f"a gas torque of {of} {value:.3g} times that of the others"
    if kind == "friction":
        return f"friction left out at {of} ({value:.3g} N*m)"
    if kind == "stage":
        return f"a stage left out at {of} ({value:.4g} N*m/rad more)"
    if kind == "hysteretic":
        return f"hysteretic instead of viscous damping in {of} (loss factor {value:.3g})"
    if kind == "viscous":
        return f"viscous instead of hysteretic damping in {of} ({value:.3g} N*m*s/rad)"
    return f"{of} = {value:.4g} instead of {before:.4g}"


def _values(explanation: Explanation) -> str:
    """Text with the values that all other parameters would have if an explanation of a misfit were true."""
    listed = [
        f"{name} would be {value_with_error(value, explanation.standard_errors[name])}"
        for name, value in explanation.values.items()
        if name.partition("[")[0] != explanation.unknown
    ]
    return ", ".join(listed) or "nothing else changes"
