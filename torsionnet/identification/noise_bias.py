"""What noise of the instrument, squared, does to a fit of records that have no clean one."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.identification.blocks import RecordBlock
from torsionnet.identification.problem import Problem

MATERIAL = 0.5
"""Standard errors; a smaller bias is not worth a word."""


def biased(problem: Problem, values: FloatArray, errors: FloatArray) -> Iterator[str]:
    """Which values noise moves, and by how much."""
    shifts, sources = np.zeros(len(problem.residuals(values))), []
    for block, span, place in zip(problem.blocks, problem.spans, problem.places, strict=True):
        if isinstance(block, RecordBlock):
            shift = _shift(block, values[place])
            shifts[span] = np.concatenate([shift.real, shift.imag]) / block.deviations
            if shift.any():
                instrument = block.windowed.instrument
                sources.append((instrument.signal, instrument.estimator))
    if not sources:
        return
    slopes = problem.jacobian(values)
    moved = -np.linalg.lstsq(slopes, shifts, rcond=None)[0]
    told = [
        f"{name} reads about {100 * abs(change / value):.2g} % {'high' if change * value > 0 else 'low'}"
        for name, value, change, error in zip(problem.names, values, moved, errors, strict=True)
        if np.isfinite(error) and value and abs(change) > MATERIAL * error
    ]
    if told:
        signal, estimator = sources[0]
        other = "H2" if estimator == "H1" else "H1"
        yield (
            f"noise on {signal} biases {estimator}: {', '.join(told)}; name the set-point as reference, or take {other} "
            "if its sensor is the better one"
        )


def _shift(block: RecordBlock, values: FloatArray) -> ComplexArray:
    """Mean of model minus test (n_b,) that squared noise makes, by the noise the fit has laid to its two sensors."""
    windowed, (on_output, on_input) = block.windowed, block.sources
    rows = windowed.rows
    own = np.where(windowed.background, len(rows.weights) * rows.squares / windowed.power, 0.0)[block.kept]
    if not own.any():
        return own
    if windowed.instrument.estimator == "H2":
        return np.asarray(-on_output * own)
    return np.asarray(on_input * own * block.predicted(values)[0])
