"""Peaks so narrow that windows widened them in a response whose record is not at hand."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.residuals.response_block import ResponseBlock
from torsionnet.signals.advice import LEAST_BINS, half_power_bandwidth, peaks

FIX = "fit the record itself, which has no such error, or use longer windows"


def narrow_peaks(problem: FitProblem, values: FloatArray) -> Iterator[str]:
    """A sentence for each response in which windows may pass for damping."""
    for block, place in zip(problem.blocks, problem.places, strict=True):
        if isinstance(block, ResponseBlock) and block.data.coherence is not None:
            yield from _narrow(block, values[place])


def _narrow(block: ResponseBlock, values: FloatArray) -> Iterator[str]:
    smooth, f = block.smoothing, block.frequencies
    if len(f) < 2 or (smooth is not None and smooth.exact):
        return
    bin_width = float(np.diff(f).min())
    curve, lines = block.curve(values), block.fine
    for peak in peaks(np.abs(curve)):
        width = half_power_bandwidth(lines, np.abs(curve), peak)
        if not f[0] <= lines[peak] <= f[-1] or not width < LEAST_BINS * bin_width:
            continue
        label = block.measurement.label
        about = f"{label}: the peak at {lines[peak]:.3g} Hz is {width:.2g} Hz wide, under {LEAST_BINS} lines"
        if smooth is None:
            yield f"{about}: what windows did to it passes for damping; {FIX}"
        else:
            yield f"{about}: windows under a sweep are corrected in part, and the errors widened; {FIX}"
