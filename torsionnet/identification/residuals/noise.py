"""Noise level of a measurement, estimated so that errors of the model do not count as noise.

What a model leaves unexplained is noise and its own error, which cannot be told apart in a single line. But the error
of a linear model follows the input from one window to the next, or runs smoothly from line to line; noise does neither.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.identification.residuals.noise_sources import sensor_noise_powers
from torsionnet.identification.residuals.segments import SegmentRows
from torsionnet.identification.residuals.windowed_estimate import WindowedEstimate
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray

POOLED_VALUES = 20.0
"""Number of independent complex noise values that an average over neighbouring lines contains, for a noise level within
a quarter or so."""
FEWEST_VALUES = 4.0
"""Least number of independent noise values of a whole measurement from which its noise is estimated, as fewer scatter
too widely."""
PARABOLA_HALF_WIDTH = 3
"""Number of lines on either side of a line to which a local parabola through the residuals is fitted, to separate noise
from smooth errors."""
FEWEST_SCATTERED_LINES = 2 * PARABOLA_HALF_WIDTH + 2
"""Fewest lines from whose scatter about local parabolas a noise level is estimated."""


@dataclass(frozen=True, eq=False)
class Noise:
    """Noise variance of each line of a measurement, over the variance that the weights of a fit suppose.

    Attributes
    ----------
    ratio : (n_b,) array
        Variance found over the variance supposed, for each line.
    certainty : float
        Number of independent real values behind the estimate.
    """

    ratio: FloatArray
    certainty: float


def noise_between_windows(
    windowed: WindowedEstimate, G: ComplexArray, kept: NDArray[np.bool_], supposed: FloatArray, independent: float
) -> Noise | None:
    """Noise of a record's lines from the part of the residuals that does not follow the input between windows.

    Parameters
    ----------
    windowed : WindowedEstimate
    G : (n_f,) complex array
        Transfer function of the model; residuals proportional to its prediction in a line do not count.
    kept : (n_all,) bool array
        Lines compared.
    supposed : (n_b,) array
        Variance of a line that the fit supposes, of real and imaginary part together.
    independent : float
        Equivalent number of independent lines.

    Returns
    -------
    Noise or None
        None where there are too few windows, or too few lines.
    """
    rows = windowed.rows.only(kept)
    w = rows.weights
    left, predicted = (rows.segments.lines(values) for values in windowed.residual_and_prediction(G))
    share = predicted / (w * predicted).sum(axis=0)
    rest = left - share * (w * left).sum(axis=0)
    overlap, weight = _overlaps(rows), np.abs(w) ** 2
    whole = overlap[0].real * weight.sum(axis=0)
    smeared = _smeared(overlap, w.conj())
    crossed = (weight * share.conj() * smeared).sum(axis=0).real
    expected = whole - 2 * crossed + (weight * np.abs(share) ** 2).sum(axis=0) * (w * smeared).sum(axis=0).real
    worth = np.maximum(expected / whole, 0) * whole**2 / _squares(overlap, weight) * independent / w.shape[1]
    if float(worth.sum()) < FEWEST_VALUES:
        return None
    level = (weight * np.abs(rest) ** 2).sum(axis=0) / np.maximum(expected, 1e-6 * whole)
    variance = level * (w * smeared).sum(axis=0).real
    return _pooled(variance / supposed, worth)


def _overlaps(rows: SegmentRows) -> ComplexArray:
    """Covariance (n_lags, n_b) of the lines of two windows, by their distance in windows, for unit white noise."""
    pieces, step, length = rows.segments.pieces(), rows.segments.step, rows.segments.length
    return np.array(
        [(pieces[:, lag:] * pieces[:, : length - lag].conj()).sum(axis=1) for lag in range(0, length, step)]
    )


def _smeared(overlap: ComplexArray, lines: ComplexArray) -> ComplexArray:
    """Covariance (n_segments, n_b) of the noise of windows, from its part (n_lags, n_b) by distance, times lines."""
    found = overlap[0] * lines
    for lag in range(1, min(len(overlap), len(lines))):
        found[:-lag] += overlap[lag] * lines[lag:]
        found[lag:] += overlap[lag].conj() * lines[:-lag]
    return np.asarray(found)


def _squares(overlap: ComplexArray, weight: FloatArray) -> FloatArray:
    """Sum of the squared covariances between windows, weighted on both sides, for each line, (n_b,)."""
    total = np.abs(overlap[0]) ** 2 * (weight**2).sum(axis=0)
    for lag in range(1, min(len(overlap), len(weight))):
        total = total + 2 * np.abs(overlap[lag]) ** 2 * (weight[lag:] * weight[:-lag]).sum(axis=0)
    return np.asarray(total)


def _pooled(ratio: FloatArray, worth: FloatArray) -> Noise:
    """Noise of each line, averaged over so many neighbours that every mean has POOLED_VALUES values."""
    half = min(len(ratio), int(np.ceil(POOLED_VALUES / 2 / max(float(worth.mean()), 1e-9))))
    sums, weights = (np.convolve(values, np.ones(2 * half + 1))[half:-half] for values in (worth * ratio, worth))
    return Noise(sums / weights, 2 * float(min(worth.sum(), weights.mean())))


def noise_between_lines(residual: ComplexArray | FloatArray, correlation: FloatArray) -> Noise | None:
    """Noise of a measurement's lines from the part of the residuals (n_b,) that is not smooth over the lines.

    Parameters
    ----------
    residual : (n_b,) complex array, or real where only magnitudes are compared
    correlation : (n_b, n_b) array
        Correlation of the noise between lines.
    """
    if len(residual) < FEWEST_SCATTERED_LINES:
        return None
    rough = _roughness(len(residual))
    spread = rough @ correlation @ rough.T
    mean, square = float(np.trace(spread)), float((spread**2).sum())
    worth = mean**2 / square
    if worth < FEWEST_VALUES:
        return None
    parts = 2 if np.iscomplexobj(residual) else 1
    scale = float((np.abs(rough @ residual) ** 2).sum()) / (parts * mean)
    return Noise(np.full(len(residual), scale), parts * worth) if scale > np.finfo(float).tiny else None


def noise_powers_between_lines(
    residual: ComplexArray | FloatArray, correlation: FloatArray, gain: FloatArray
) -> tuple[float, float]:
    """Power of a noise equal in all lines, and of one in proportion to ``gain``, from what is not smooth over lines.

    Local parabolas L leave of independent noise with variances v_j the squares E |(r - L r)_i|^2 =
    sum_j (1 - L)_ij^2 v_j, to which v = a + b gain is fitted.

    Parameters
    ----------
    residual : (n_b,) complex array, or real where only magnitudes are compared
        Model minus test in the unit of the response.
    correlation : (n_b, n_b) array
        Correlation of the noise between lines.
    gain : (n_b,) array
        Squared magnitude of the response.
    """
    rough, size = _roughness(len(residual)), np.sqrt(gain)
    even = np.sum((rough @ correlation) * rough, axis=1)
    relative = np.sum(((rough * size) @ correlation) * (rough * size), axis=1)
    parts = 2 if np.iscomplexobj(residual) else 1
    return sensor_noise_powers(np.abs(rough @ residual) ** 2 / parts / even, relative / even, np.zeros(len(residual)))


def _roughness(count: int) -> FloatArray:
    """Matrix (count, count) that subtracts from each line's value a local parabola fitted by least squares."""
    found = np.zeros((count, count))
    basis, _ = np.linalg.qr(np.linspace(-1, 1, 2 * PARABOLA_HALF_WIDTH + 1)[:, None] ** np.arange(3))
    for place in range(count):
        first = min(max(place - PARABOLA_HALF_WIDTH, 0), count - 2 * PARABOLA_HALF_WIDTH - 1)
        near = slice(first, first + 2 * PARABOLA_HALF_WIDTH + 1)
        found[place, near] = -basis[place - first] @ basis.T
        found[place, place] += 1
    return found
