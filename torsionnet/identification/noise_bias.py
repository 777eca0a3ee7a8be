"""Bias of fitted values by noise on the signal that H1 or H2 multiplies by, in records without a clean reference."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.residuals.record_block import RecordBlock
from torsionnet.identification.residuals.residual_forms import errors_in_form, parts
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray

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
