"""Extremes of sums of orders over a long common cycle, searched on a coarse grid and refined by Newton's method."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from torsionnet.response.frequency_response import ComplexArray, FloatArray
from torsionnet.response.synthesis import waveforms

LONG_CYCLE_PERIODS = 300
"""Periods of the highest order in a cycle from which a coarse grid with refinement is faster than a fine grid."""
COARSE_POINTS_PER_PERIOD = 8
"""Points of the coarse grid for each period of the highest order."""
MOST_MAXIMA = 100
"""Most local maxima of a wave that are refined; with more candidates for the highest a fine grid is cheaper."""
NEWTON_STEPS = 3
"""Steps of Newton's method, which reach the last digits from within 1/16 of a period."""


def refined_extremes(
    amplitudes: ComplexArray, counts: Sequence[int], spectrum: ComplexArray
) -> tuple[FloatArray, FloatArray]:
    """Largest and smallest value of Re sum_l X_l exp(j c_l phi) along the cycle, each (n_speeds, n_out).

    Between two points h apart a wave exceeds the nearer one by at most h^2/8 sum |X_l| c_l^2, so that few maxima of
    the grid have to be refined. nan where they are too many.

    Parameters
    ----------
    amplitudes : (n_speeds, n_lines, n_out) array
    counts : sequence of int
        Number of periods of each line in the cycle.
    spectrum : (n_speeds, highest count + 1, n_out) array
        Amplitudes sorted by their number of periods.
    """
    n = COARSE_POINTS_PER_PERIOD * max(counts)
    waves = waveforms(spectrum, n)
    rise = (2 * np.pi / n) ** 2 / 8 * (np.abs(amplitudes) * np.square(counts)[:, None]).sum(axis=1)
    high, low = (_highest(sign * waves, rise, sign * amplitudes, np.array(counts)) for sign in (1.0, -1.0))
    return high, -low


def _highest(waves: FloatArray, rise: FloatArray, amplitudes: ComplexArray, counts: NDArray[np.int64]) -> FloatArray:
    found = waves.max(axis=2)
    above = np.flatnonzero(waves >= (found - rise)[:, :, None])
    speeds, outputs, points = np.unravel_index(above, waves.shape)
    n = waves.shape[2]
    here = waves[speeds, outputs, points]
    is_crest = here >= np.maximum(waves[speeds, outputs, points - 1], waves[speeds, outputs, (points + 1) % n])
    speeds, outputs, points = speeds[is_crest], outputs[is_crest], points[is_crest]
    many = np.zeros(found.shape, dtype=np.int64)
    np.add.at(many, (speeds, outputs), 1)
    few = many[speeds, outputs] <= MOST_MAXIMA
    speeds, outputs, points = speeds[few], outputs[few], points[few]
    tops = _tops(amplitudes[speeds, :, outputs], counts, points * (2 * np.pi / n), np.pi / n)
    np.maximum.at(found, (speeds, outputs), tops)
    return np.where(many <= MOST_MAXIMA, found, math.nan)


def _tops(amplitudes: ComplexArray, counts: NDArray[np.int64], start: FloatArray, half_step: float) -> FloatArray:
    """Maxima (n,) of waves (n, n_lines) nearest to start angles, by Newton's method."""
    angle = start
    for _ in range(NEWTON_STEPS):
        terms = amplitudes * np.exp(1j * angle[:, None] * counts)
        slope, curvature = -(terms.imag @ counts), -(terms.real @ np.square(counts))
        step = np.divide(-slope, curvature, out=np.zeros_like(slope), where=curvature < 0)
        angle = np.clip(angle + step, start - 2 * half_step, start + 2 * half_step)
    return np.asarray((amplitudes * np.exp(1j * angle[:, None] * counts)).real.sum(axis=1))
