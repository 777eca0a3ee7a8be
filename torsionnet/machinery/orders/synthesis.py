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
    # An order p/q in lowest terms has whole periods in N revolutions if q divides N.
    cycle = math.lcm(*(relative.denominator for relative in relatives))
    highest = max(relatives, default=Fraction(0))
    return cycle if cycle <= MOST_REVOLUTIONS and cycle * highest <= MOST_PERIODS else None


def waveforms(spectrum: ComplexArray, points: int | None = None) -> FloatArray:
    """Waveforms Re sum_k X_k exp(j k phi) at even steps of phi over a cycle, in the unit of X, (n_speeds, n_out, n)."""
    highest = spectrum.shape[1] - 1
    n = points or _even_steps(POINTS_PER_PERIOD * max(highest, 1))
    # Sampling theorem: more than two points per period of the highest order.
    if n <= 2 * highest:
        raise UsageError(
            f"{n} points are too few for a waveform with {highest} periods; take more than {2 * highest}",
            kind="wrong-count",
        )
    # Waves that lie in one piece are made and searched in less than half the time.
    rows = np.array(spectrum.transpose(0, 2, 1), order="C")
    if highest > MOST_PERIODS_BY_PRODUCT:
        rows[:, :, 0] *= 2  # irfft counts what is constant once, and all else twice
        return np.asarray(np.fft.irfft(rows, n) * (n / 2))
    # Re X exp(j k phi) = Re X cos(k phi) - Im X sin(k phi), for all k at once as one product.
    parts = np.concatenate([rows.real, rows.imag], axis=-1)
    return np.asarray(parts @ _cosines(highest, n))


@lru_cache(maxsize=8)
def _cosines(highest: int, n: int) -> FloatArray:
    """Matrix (2 highest + 2, n) of cosines and sines that maps real and imaginary parts of amplitudes to waveforms."""
    angle = 2 * np.pi * np.outer(np.arange(highest + 1), np.arange(n)) / n
    return np.concatenate([np.cos(angle), -np.sin(angle)])


def _even_steps(least: int) -> int:
    """Number of points of a waveform, at least ``least``, for which the Fourier transform is fast."""
    # Lengths 2^m, 3 2^m and 5 2^m, the shortest of the three that suffices.
    return min(factor << max(0, math.ceil(math.log2(least / factor))) for factor in (1, 3, 5))


def extremes(waves: FloatArray) -> FloatArray:
    """Largest and smallest values of waveforms, in their unit, by parabolas through points, (2, n_speeds, n_out)."""
    return np.array([_outermost(waves, np.argmax(waves, axis=-1)), _outermost(waves, np.argmin(waves, axis=-1))])


def _outermost(waves: FloatArray, at: NDArray[np.intp]) -> FloatArray:
    n = waves.shape[-1]
    around = ((at[:, :, None] + step) % n for step in (-1, 0, 1))
    before, peak, after = (np.take_along_axis(waves, place, axis=-1)[:, :, 0] for place in around)
    # Parabola through three even points: it rises (y_1 - y_3)^2 / (8 (2 y_2 - y_1 - y_3)) above the middle one.
    curvature = before - 2 * peak + after
    with np.errstate(divide="ignore", invalid="ignore"):
        rise = np.where(curvature != 0, (before - after) ** 2 / (-8 * curvature), 0)
    return np.asarray(peak + rise)


# Extremes of sums of orders over a common cycle, found on a coarse grid and refined by Newton's method.

COARSE_POINTS_PER_PERIOD = 8
"""Number of points of the coarse grid over a cycle for each period of the highest order: a quarter of its maxima is
wider than a step."""
MOST_WAVEFORM_POINTS = 4_000_000
"""Largest number of waveform points that are held in memory at a time; speeds are processed in parts accordingly."""
MOST_MAXIMA = 20_000
"""Largest number of waveform maxima that are refined at a time: their amplitudes take some 10 MB."""
NEWTON_STEPS = 5
"""Number of Newton steps from a grid point of a waveform to the maximum near it; three leave 1e-5 where a maximum is
flat, five less than 1e-9."""


def cycle_extremes(amplitudes: ComplexArray, periods: Sequence[int]) -> FloatArray:
    """Highest and lowest sum of orders Re sum_l X_l exp(j c_l phi), in the unit of X, shape (2, n_speeds, n_out).

    Between two points h apart a wave exceeds the nearer one by at most h^2/8 sum |X_l| c_l^2, so that few maxima of
    a coarse grid have to be refined.

    Parameters
    ----------
    amplitudes : (n_speeds, n_lines, n_out) array
        Complex amplitudes X_l.
    periods : sequence of int
        Periods c_l of each line in the cycle, not negative.

    Examples
    --------
    >>> cycle_extremes(np.array([[[1.0], [0.25j]]]), [2, 4]).round(6).tolist()
    [[[1.100917]], [[-1.100917]]]
    """
    counts = np.unique(np.asarray(periods, dtype=np.int64))
    waves = np.zeros((len(amplitudes), amplitudes.shape[2], len(counts)), dtype=complex)
    for line, place in enumerate(np.searchsorted(counts, periods)):
        waves[:, :, place] += amplitudes[:, line]
    # Counts with a common factor repeat that often in the cycle: one repetition has all extremes.
    counts //= max(1, math.gcd(*counts.tolist()))
    together = max(1, MOST_WAVEFORM_POINTS // (COARSE_POINTS_PER_PERIOD * int(counts[-1] + 1) * waves.shape[1]))
    parts = (waves[start : start + together] for start in range(0, len(waves), together))
    return np.concatenate([np.zeros((2, 0, waves.shape[1])), *(_of_part(part, counts) for part in parts)], axis=1)


def _of_part(amplitudes: ComplexArray, counts: NDArray[np.int64]) -> FloatArray:
    """Highest and lowest values (2, n_speeds, n_out) of waves in the unit of their amplitudes (n_speeds, n_out, n)."""
    steps, families = _families(counts)
    waves = [_periods(amplitudes[:, :, lines], counts[lines], steps) for lines in families]
    # |x''| <= sum |X_l| c_l^2 bounds the rise between two points h apart by h^2/8 of it.
    rise = (2 * np.pi / steps) ** 2 / 8 * (np.abs(amplitudes) * np.square(counts)).sum(axis=2)
    highest = _highest(waves, steps, rise, amplitudes, counts)
    # The lowest value is that of -x, turned; the waves are negated in place since they are needed no more.
    turned = [np.negative(wave, out=wave) for wave in waves]
    return np.array([highest, -_highest(turned, steps, rise, -amplitudes, counts)])


def _families(counts: NDArray[np.int64]) -> tuple[int, list[NDArray[np.bool_]]]:
    """Number of points of the coarse grid over a cycle, and masks (n,) of the counts in one family, or in two.

    Families with g_1 and g_2 repetitions in a cycle, without a common factor, have g_2 and g_1 points in one of g_1 g_2
    steps, and each point of the one meets each of the other once (Chinese remainder theorem). So a few points tell
    what all points of the cycle would, as of orders of an engine and of teeth that mesh.
    """
    first = counts % counts[0] == 0 if counts[0] else np.ones(len(counts), dtype=bool)
    if not first.all():
        g_1, g_2 = int(counts[0]), int(np.gcd.reduce(counts[~first]))
        least = COARSE_POINTS_PER_PERIOD * int(counts[-1])
        if math.gcd(g_1, g_2) == 1 and g_1 * g_2 >= least:
            return g_1 * g_2, [first, ~first]
    return max(COARSE_POINTS_PER_PERIOD * int(counts[-1]), 1), [np.ones(len(counts), dtype=bool)]


def _periods(amplitudes: ComplexArray, counts: NDArray[np.int64], steps: int) -> FloatArray:
    """Waveforms (n_speeds, n_out, n) in the unit of their amplitudes over one repetition, at so many steps a cycle."""
    common = max(1, math.gcd(*counts.tolist()))
    counts = counts // common
    spectrum = np.zeros((len(amplitudes), int(counts[-1]) + 1, amplitudes.shape[1]), dtype=complex)
    spectrum[:, counts] = amplitudes.transpose(0, 2, 1)
    return waveforms(spectrum, steps // common)


def _highest(
    waves: Sequence[FloatArray], steps: int, rise: FloatArray, amplitudes: ComplexArray, counts: NDArray[np.int64]
) -> FloatArray:
    """Highest values (n_speeds, n_out) of sums of one or two families of waves, refined from the coarse grid."""
    highest: FloatArray = np.sum([wave.max(axis=2) for wave in waves], axis=0)
    # Only a point within that rise of the highest one can have the true maximum beside it. Waves without a rise, as
    # outputs that nothing excites, are flat, and every point of theirs is as high.
    rows, points = _near_highest(waves[0], rise)
    values = [wave.reshape(-1, wave.shape[2]) for wave in waves]
    around = [values[0][rows, (points + step) % values[0].shape[1]] for step in (-1, 0, 1)]
    if len(waves) > 1:
        # All pairs of points of the two families at each speed, and the step of the cycle at which both meet.
        others, met = _near_highest(waves[1], rise)
        count = np.bincount(others, minlength=rise.size)
        own = np.repeat(np.arange(len(rows)), count[rows])
        place = np.arange(len(own)) - np.repeat(np.cumsum(count[rows]) - count[rows], count[rows])
        met = met[(np.cumsum(count) - count)[rows[own]] + place]
        rows, points, around = rows[own], points[own], [each[own] for each in around]
        n_1, n_2 = (part.shape[1] for part in values)
        around = [each + values[1][rows, (met + step) % n_2] for each, step in zip(around, (-1, 0, 1), strict=True)]
        points = (points * n_2 * pow(n_2, -1, n_1) + met * n_1 * pow(n_1, -1, n_2)) % steps
    is_crest = (around[1] >= np.maximum(around[0], around[2])) & (around[1] >= (highest - rise).reshape(-1)[rows])
    rows, points, n = rows[is_crest], points[is_crest], steps
    tops, each = highest.reshape(-1), amplitudes.reshape(-1, len(counts))
    for start in range(0, len(points), MOST_MAXIMA):
        part = slice(start, start + MOST_MAXIMA)
        angles = np.asarray(points[part] * (2 * np.pi / n), dtype=float)
        np.maximum.at(tops, rows[part], _tops(each[rows[part]], counts, angles, 2 * np.pi / n))
    return highest


def _near_highest(waves: FloatArray, rise: FloatArray) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Rows and points of waves (n_speeds, n_out, n) that lie within a rise of the highest point, row by row."""
    flat = np.flatnonzero(waves >= np.where(rise > 0, waves.max(axis=2) - rise, np.inf)[:, :, None])
    return flat // waves.shape[2], flat % waves.shape[2]


def _tops(amplitudes: ComplexArray, counts: NDArray[np.int64], start: FloatArray, step: float) -> FloatArray:
    """Maxima (n,) of waves with amplitudes (n, n_counts), in their unit, within a step in rad of start angles."""
    series = _Series(amplitudes, counts)
    low, high, angle = start - step, start + step, start
    for _ in range(NEWTON_STEPS):
        value, slope, curvature = series.at(angle)
        # Where x' > 0 the maximum comes later: the bracket shrinks to that side.
        low, high = np.where(slope > 0, angle, low), np.where(slope > 0, high, angle)
        # Newton for x' = 0 where x'' < 0; elsewhere, or out of the bracket, the step is a bisection.
        newton = angle - np.divide(slope, curvature, out=np.full_like(slope, np.inf), where=curvature < 0)
        before, angle = angle, np.where((low <= newton) & (newton <= high), newton, (low + high) / 2)
    # The last step is so short that the parabola has the value at its end.
    return np.asarray(value + (slope + curvature * (angle - before) / 2) * (angle - before))


class _Series:
    """Sums Re sum_k X_k exp(j c_k phi) of waves (n, n_counts), in the unit of X, with their derivatives to phi."""

    def __init__(self, amplitudes: ComplexArray, counts: NDArray[np.int64]) -> None:
        self.amplitudes, self.counts = np.ascontiguousarray(amplitudes.T), counts
        self.gaps = [int(counts[0]), *np.diff(counts).tolist()]

    def at(self, angle: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Value, slope per rad and curvature per rad^2 of waves, in their unit, each at its angle in rad."""
        turns = {gap: np.exp(1j * gap * angle) for gap in set(self.gaps)}
        # X_k exp(j c_k phi) from the lowest count up, with the gaps between counts as powers.
        parts, turned = np.empty_like(self.amplitudes), np.ones(len(angle), dtype=complex)
        for place, gap in enumerate(self.gaps):
            if gap:
                turned = turned * turns[gap]
            np.multiply(self.amplitudes[place], turned, out=parts[place])
        # x' = -sum c Im(X e), x'' = -sum c^2 Re(X e).
        return parts.real.sum(axis=0), -(self.counts @ parts.imag), -(np.square(self.counts) @ parts.real)
