"""From amplitudes by order to the waveform they sum up to, over a cycle that holds whole periods of all of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from torsionnet.core.errors import UsageError
from torsionnet.response.frequency_response import ComplexArray, FloatArray

PER_PERIOD = 64
"""Points on a waveform for each period of its highest order."""
FEW_PERIODS = 40
"""Up to so many periods a product with cosines is faster than the Fourier transform."""
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
    # Waves that lie in one piece are made and searched in less than half the time.
    rows = np.ascontiguousarray(spectrum.transpose(0, 2, 1))
    if highest > FEW_PERIODS:
        return np.asarray(np.fft.irfft(rows, n) * (n / 2))
    parts = np.concatenate([rows.real, rows.imag], axis=-1)
    return np.asarray(parts @ _cosines(highest, n))


@lru_cache(maxsize=8)
def _cosines(highest: int, n: int) -> FloatArray:
    """What real and imaginary parts of the amplitudes, and half of a mean value, are multiplied with."""
    angle = 2 * np.pi * np.outer(np.arange(highest + 1), np.arange(n)) / n
    cosine = np.cos(angle)
    cosine[0] /= 2
    return np.concatenate([cosine, -np.sin(angle)])


def _even_steps(least: int) -> int:
    """At least so many, and a number for which the Fourier transform is fast."""
    return min(factor << max(0, math.ceil(math.log2(least / factor))) for factor in (1, 3, 5))


def extremes(waves: FloatArray) -> FloatArray:
    """Largest and smallest values (2, ...) along the cycle, by parabolas through the outermost points."""
    return np.array([_outermost(waves, np.argmax(waves, axis=-1)), _outermost(waves, np.argmin(waves, axis=-1))])


def _outermost(waves: FloatArray, at: NDArray[np.intp]) -> FloatArray:
    n = waves.shape[-1]
    around = ((at[:, :, None] + step) % n for step in (-1, 0, 1))
    before, peak, after = (np.take_along_axis(waves, place, axis=-1)[:, :, 0] for place in around)
    curvature = before - 2 * peak + after
    with np.errstate(divide="ignore", invalid="ignore"):
        rise = np.where(curvature != 0, (before - after) ** 2 / (-8 * curvature), 0)
    return np.asarray(peak + rise)
