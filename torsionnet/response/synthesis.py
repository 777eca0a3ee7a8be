"""From amplitudes by order to the waveform they sum up to, over a cycle that holds whole periods of all of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from torsionnet.core.errors import UsageError
from torsionnet.response.frequency_response import ComplexArray, FloatArray

PER_PERIOD = 64
"""Points on a waveform for each period of its highest order."""
MOST_REVOLUTIONS, HIGHEST_LINE = 1000, 5000
"""A common cycle of more revolutions, or with more periods in it, is none that anybody waits for."""


def common_cycle(relatives: Sequence[Fraction]) -> int | None:
    """Revolutions that hold a whole number of periods of each; None where that is too many."""
    cycle = math.lcm(*(relative.denominator for relative in relatives))
    highest = max(relatives, default=Fraction(0))
    return cycle if cycle <= MOST_REVOLUTIONS and cycle * highest <= HIGHEST_LINE else None


def synthesised(spectrum: ComplexArray, points: int | None = None) -> FloatArray:
    """Re sum_k X_k exp(j k phi) at even steps, shape (n_speeds, n_out, n)."""
    highest = spectrum.shape[1] - 1
    n = points or _even_steps(PER_PERIOD * max(highest, 1))
    if n <= 2 * highest:
        raise UsageError(f"{n} points do not show {highest} periods; take more than {2 * highest}")
    # Waves that lie in one piece are transformed and searched in less than half the time.
    return np.asarray(np.fft.irfft(np.ascontiguousarray(spectrum.transpose(0, 2, 1)), n) * (n / 2))


def _even_steps(least: int) -> int:
    """At least so many, and a number for which the Fourier transform is fast."""
    return min(factor << max(0, math.ceil(math.log2(least / factor))) for factor in (1, 3, 5))


def highest(waves: FloatArray) -> FloatArray:
    """Largest value along the cycle, by the parabola through the largest point and its neighbours."""
    at = np.argmax(waves, axis=-1)[:, :, None]
    n = waves.shape[-1]
    before, peak, after = (np.take_along_axis(waves, (at + step) % n, axis=-1)[:, :, 0] for step in (-1, 0, 1))
    curvature = before - 2 * peak + after
    with np.errstate(divide="ignore", invalid="ignore"):
        rise = np.where(curvature < 0, (before - after) ** 2 / (-8 * curvature), 0)
    return np.asarray(peak + rise)
