"""Test of lack of fit, whether the residuals of a fit are larger than noise or have a pattern over frequency."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import scipy

from torsionnet.base.result_rows import Out
from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.noise_bias import noise_shift
from torsionnet.identification.residuals.measurement_block import MeasurementBlock
from torsionnet.identification.residuals.noise import Noise
from torsionnet.linear.assembly.rows import FloatArray

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
    kind : {"delay", "gain", "reference_angle", "hysteretic", "viscous", "ratio", "value", "misfire", "gas_torque",
        "between"}
    of : str
        The signal that is late, too large or turned, the element with another kind of damping, the value set free, or
        the cylinder that misfires.
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
        return any(one.rejected for one in self.measurements)


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
    residuals = residuals * (1.0 if weights is None else weights) - shift + basis @ (basis.T @ shift)
    found = [
        block.measured_noise(values[place])
        for block, place in zip(problem.blocks, problem.unknown_indices, strict=True)
    ]
    every = zip(problem.blocks, problem.residual_slices, problem.unknown_indices, found, strict=True)
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
    chances = [float(scipy.stats.f.sf(total, mean**2 / square, noise.certainty))]
    waves = _waves(count, len(r) // count, block.runs)
    sizes, directions = np.linalg.eigh(waves.T @ R @ waves)
    seen = sizes > ABSORBED_VARIANCE_SHARE * sizes[-1]
    pattern = float(np.mean((directions[:, seen].T @ (waves.T @ r)) ** 2 / sizes[seen]))
    chances.append(float(scipy.stats.f.sf(pattern, int(seen.sum()), noise.certainty)))
    weights = block.absolute_scale**2
    beyond = max(float((residual**2 - np.diag(covariance)) @ weights), 0.0)
    size = np.sqrt(beyond / float(np.sum(np.abs(block.measured) ** 2)))
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
