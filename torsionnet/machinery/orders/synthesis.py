"""Synthesis of waveforms from order amplitudes, over a common cycle with whole periods of all orders."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.linear.frequency_response import ComplexArray, FloatArray

POINTS_PER_PERIOD = 64
"""Number of points of a waveform for each period of its highest order."""
MOST_PERIODS_BY_PRODUCT = 40
"""Number of periods in a cycle up to which a product with a matrix of cosines is faster than the Fourier transform."""
MOST_REVOLUTIONS, MOST_PERIODS = 1000, 5000
"""Largest number of shaft revolutions in a common cycle, and largest number of periods in one; a longer one is too long
to occur or to calculate."""


def common_cycle(relatives: Sequence[Fraction]) -> int | None:
    """Smallest number of revolutions of the reference shaft with a whole number of periods of each order.

    None if there are too many.
    """
    cycle = math.lcm(*(relative.denominator for relative in relatives))
    highest = max(relatives, default=Fraction(0))
    return cycle if cycle <= MOST_REVOLUTIONS and cycle * highest <= MOST_PERIODS else None


def waveforms(spectrum: ComplexArray, points: int | None = None) -> FloatArray:
    """Waveforms Re sum_k X_k exp(j k phi) at even steps of phi over a cycle, in the unit of X, (n_speeds, n_out, n)."""
    highest = spectrum.shape[1] - 1
    n = points or _even_steps(POINTS_PER_PERIOD * max(highest, 1))
    if n <= 2 * highest:
        raise UsageError(f"{n} points are too few for a waveform with {highest} periods; take more than {2 * highest}")
    # Waves that lie in one piece are made and searched in less than half the time.
    rows = np.array(spectrum.transpose(0, 2, 1), order="C")
    if highest > MOST_PERIODS_BY_PRODUCT:
        rows[:, :, 0] *= 2  # irfft counts what is constant once, and all else twice
        return np.asarray(np.fft.irfft(rows, n) * (n / 2))
    parts = np.concatenate([rows.real, rows.imag], axis=-1)
    return np.asarray(parts @ _cosines(highest, n))


@lru_cache(maxsize=8)
def _cosines(highest: int, n: int) -> FloatArray:
    """Matrix (2 highest + 2, n) of cosines and sines that maps real and imaginary parts of amplitudes to waveforms."""
    angle = 2 * np.pi * np.outer(np.arange(highest + 1), np.arange(n)) / n
    return np.concatenate([np.cos(angle), -np.sin(angle)])


def _even_steps(least: int) -> int:
    """Number of points of a waveform, at least ``least``, for which the Fourier transform is fast."""
    return min(factor << max(0, math.ceil(math.log2(least / factor))) for factor in (1, 3, 5))


def extremes(waves: FloatArray) -> FloatArray:
    """Largest and smallest values of waveforms, in their unit, by parabolas through points, (2, n_speeds, n_out)."""
    return np.array([_outermost(waves, np.argmax(waves, axis=-1)), _outermost(waves, np.argmin(waves, axis=-1))])


def _outermost(waves: FloatArray, at: NDArray[np.intp]) -> FloatArray:
    n = waves.shape[-1]
    around = ((at[:, :, None] + step) % n for step in (-1, 0, 1))
    before, peak, after = (np.take_along_axis(waves, place, axis=-1)[:, :, 0] for place in around)
    curvature = before - 2 * peak + after
    with np.errstate(divide="ignore", invalid="ignore"):
        rise = np.where(curvature != 0, (before - after) ** 2 / (-8 * curvature), 0)
    return np.asarray(peak + rise)
