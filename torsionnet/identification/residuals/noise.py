"""Noise level of a measurement, estimated so that errors of the model do not count as noise.

What a model leaves unexplained is noise and its own error, which cannot be told apart in a single line. But the error
of a linear model follows the input from one window to the next, or runs smoothly from line to line; noise does neither.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from torsionnet.identification.residuals.windowed_estimate import SegmentRows, WindowedEstimate
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.estimation import Estimation
from torsionnet.linear.frequency_response import FrequencyResponse

# Split of the noise of a record between the sensors of output and input.

REWEIGHTING_ROUNDS = 5
"""Repetitions of the least squares for noise powers, whose weights depend on their result; a few suffice."""
COMPATIBLE_STANDARD_ERRORS = 4.0
"""Standard errors by which two estimates of one noise power may differ and still be averaged, as noise that comes with
the excitation shows only in the lines that it drives."""
LEAST_POWER = np.finfo(float).tiny ** 0.25
"""Noise power that counts as none, whose inverse has a square in the range of numbers."""


def sensor_noise_powers(
    level: FloatArray,
    gain: FloatArray,
    rest: FloatArray,
    repeated: float = 1.0,
    seen: tuple[float, float] | None = None,
) -> tuple[float, float]:
    """Noise powers of output sensor and input sensor (as variances) that fit the noise left in all lines best.

    One number each for all lines: the level of a single line rests on the few windows in which the sweep passes it,
    and weights made of that alone would favour lines that happen to agree. Neither is below 0; one that is found within
    its own uncertainty of 0 is taken as the mean of all it may be, as no sensor is free of noise by chance.

    Parameters
    ----------
    level, gain, rest : (n,) array
        Noise left of every line, the squared magnitude of the response there, and what is known of the noise.
    repeated : float, optional
        Number of lines that share one independent value.
    seen : tuple of float, optional
        Noise power of the input as it was found elsewhere, and the standard error of that.

    Examples
    --------
    >>> [round(share, 2) for share in sensor_noise_powers(np.array([1.0, 3.0, 5.0]), np.arange(3.0), np.zeros(3))]
    [1.0, 2.0]
    """
    # Level of each line: P_out + gain P_in + rest, of which the rest is known.
    both = np.column_stack([np.ones_like(gain), gain])
    shares, spread = _noise_powers(level, both, rest, repeated)
    if seen is None or abs(seen[0] - shares[1]) > COMPATIBLE_STANDARD_ERRORS * np.hypot(seen[1], spread[1]):
        # Where lines and windows contradict each other, the lines alone give the ratio, scaled to fit on average.
        made_up = rest + both @ shares
        shares = shares * np.mean(level / np.maximum(made_up, LEAST_POWER))
        return _above_zero(float(shares[0]), float(shares[1]))
    input_power = weighted_mean([seen, (float(shares[1]), float(spread[1]))])
    assert input_power is not None
    # With the input's power known the output's is fitted alone.
    on_output, _ = _noise_powers(level, both[:, :1], rest + input_power[0] * gain, repeated)
    return _above_zero(float(on_output[0]), input_power[0])


def weighted_mean(estimates: Iterable[tuple[float, float] | None]) -> tuple[float, float] | None:
    """Mean of values weighted by their standard errors, and its own standard error, or None without values.

    >>> weighted_mean([(1.0, 1.0), None, (2.0, 1.0)])
    (1.5, 0.7071067811865476)
    """
    known = [(value, max(error, np.finfo(float).tiny ** 0.25)) for value, error in filter(None, estimates)]
    if not known:
        return None
    # Weights 1/e^2, and the mean has the error (sum 1/e^2)^(-1/2).
    total = sum(error**-2 for _, error in known)
    return sum(value * error**-2 for value, error in known) / total, float(total**-0.5)


def _noise_powers(
    level: FloatArray, columns: FloatArray, rest: FloatArray, repeated: float
) -> tuple[FloatArray, FloatArray]:
    """Powers of noise sources whose sum with a known rest fits a measured noise level, and their standard errors."""
    fitted, shares = np.maximum(level, LEAST_POWER), np.zeros(columns.shape[1])
    for _ in range(REWEIGHTING_ROUNDS):
        # A level scatters in proportion to itself: rows over the level of the last round.
        rows = columns / fitted[:, None]
        scale = np.maximum(rows.max(axis=0), LEAST_POWER)
        shares = scipy.optimize.nnls(rows / scale, (level - rest) / fitted)[0] / scale
        fitted = np.maximum(rest + columns @ shares, LEAST_POWER)
    return _probable(level - rest, columns, fitted, repeated)


def _probable(
    level: FloatArray, columns: FloatArray, fitted: FloatArray, repeated: float
) -> tuple[FloatArray, FloatArray]:
    """Means of noise powers under a normal distribution cut off at 0, and their standard deviations, (n_sources,)."""
    rows = columns / fitted[:, None]
    scale = np.maximum(np.linalg.norm(rows, axis=0), np.finfo(float).tiny)
    inverse = np.linalg.pinv(rows / scale)
    best = inverse @ (level / fitted)
    misfit = level / fitted - rows @ (best / scale)
    spread = np.sqrt(repeated * np.mean(misfit**2) * (inverse**2).sum(axis=1))
    far = best / np.maximum(spread, max(1e-12 * float(np.abs(best).max()), LEAST_POWER))
    # Mean of a normal distribution cut off at 0, m + s phi(m/s)/Phi(m/s).
    shares = np.maximum(best + spread * np.exp(scipy.stats.norm.logpdf(far) - scipy.stats.norm.logcdf(far)), 0.0)
    return shares / scale, spread / scale


def _above_zero(on_output: float, on_input: float) -> tuple[float, float]:
    return max(on_output, 0.0 if on_input else np.finfo(float).tiny), on_input


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
    # What is in proportion to the prediction goes out: an error of the model is that in all windows.
    share = predicted / (w * predicted).sum(axis=0)
    rest = left - share * (w * left).sum(axis=0)
    overlap, weight = _overlaps(rows), np.abs(w) ** 2
    whole = overlap[0].real * weight.sum(axis=0)
    smeared = _smeared(overlap, w.conj())
    # Expected |rest|^2 for unit noise: the noise's own, less twice what it shares with the fit, plus the fit's.
    crossed = (weight * share.conj() * smeared).sum(axis=0).real
    expected = whole - 2 * crossed + (weight * np.abs(share) ** 2).sum(axis=0) * (w * smeared).sum(axis=0).real
    # Worth by Satterthwaite: square of the mean over the sum of squares, as windows overlap.
    worth = np.maximum(expected / whole, 0) * whole**2 / _squares(overlap, weight) * independent / w.shape[1]
    if float(worth.sum()) < FEWEST_VALUES:
        return None
    # Power that is there over that of unit noise is the level.
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
    covariance = overlap[0] * lines
    for lag in range(1, min(len(overlap), len(lines))):
        covariance[:-lag] += overlap[lag] * lines[lag:]
        covariance[lag:] += overlap[lag].conj() * lines[:-lag]
    return np.asarray(covariance)


def _squares(overlap: ComplexArray, weight: FloatArray) -> FloatArray:
    """Sum of the squared covariances between windows, weighted on both sides, for each line, (n_b,)."""
    # Sum over pairs i, j of w_i^2 |c_(i-j)|^2 w_j^2, each pair of a lag twice.
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
    # Worth in independent values, (tr C)^2/sum C^2 for the covariance C of what the parabolas leave.
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
    # Expected power of each remainder: under noise equal in all lines, and under noise in proportion to the gain.
    even = np.sum((rough @ correlation) * rough, axis=1)
    relative = np.sum(((rough * size) @ correlation) * (rough * size), axis=1)
    parts = 2 if np.iscomplexobj(residual) else 1
    return sensor_noise_powers(np.abs(rough @ residual) ** 2 / parts / even, relative / even, np.zeros(len(residual)))


def _roughness(count: int) -> FloatArray:
    """Matrix (count, count) that subtracts from each line's value a local parabola fitted by least squares."""
    roughness = np.zeros((count, count))
    # With an orthonormal basis Q of 1, x, x^2 over the neighbours, I - Q Q^T leaves what no parabola fits.
    basis, _ = np.linalg.qr(np.linspace(-1, 1, 2 * PARABOLA_HALF_WIDTH + 1)[:, None] ** np.arange(3))
    for place in range(count):
        first = min(max(place - PARABOLA_HALF_WIDTH, 0), count - 2 * PARABOLA_HALF_WIDTH - 1)
        near = slice(first, first + 2 * PARABOLA_HALF_WIDTH + 1)
        roughness[place, near] = -basis[place - first] @ basis.T
        roughness[place, place] += 1
    return roughness


# Variance of a response's lines by noise, and the correlation between neighbouring lines.

LOWEST_COHERENCE, HIGHEST_COHERENCE = 1e-3, 1 - 1e-6
"""Limits to which the coherence of a line is clipped, so that no line has an infinite or zero variance."""
WINDOW_SAMPLES = 512
"""Number of samples of a window from which the correlation of lines is calculated, enough as only its shape matters."""
NEGLIGIBLE_CORRELATION = 1e-4
"""Correlation of the random errors of two lines below which it is left out, so that the matrix stays sparse."""
USUAL_WINDOW, USUAL_OVERLAP = "hann", 0.5
"""Window and overlap assumed for a response with coherence whose averaging is unknown, the most usual ones."""


def line_noise(data: FrequencyResponse, error: float | None) -> FloatArray:
    """Variance (n_f,) of the real part of a response by noise, SI, equal to that of the imaginary part.

    From the relative standard error if there is one, else from the coherence; in proportion to the squared magnitude
    where there is neither.
    """
    squared = data.magnitude[:, 0, 0] ** 2
    if error is not None:
        return np.asarray(error**2 * squared)
    if data.coherence is None:
        return squared
    worth = data.estimation.effective_averages if data.estimation else 1.0
    # At coherence 0 or 1 the variance would be infinite or 0, and a line without weight or of all the weight.
    coherence = np.clip(np.nan_to_num(data.coherence[:, 0, 0]), LOWEST_COHERENCE, HIGHEST_COHERENCE)
    return np.asarray(squared * (1 - coherence) / (2 * worth * coherence))


def averaging_of(data: FrequencyResponse) -> Estimation | None:
    """Averaging of a response (window, overlap, averages) as stated, else the usual one if it has a coherence.

    Lines of a window are evenly spaced by 1 / seconds.
    """
    if data.estimation is not None or data.coherence is None:
        return data.estimation
    spacing = np.diff(data.frequencies)
    if not len(spacing) or not np.allclose(spacing / spacing.min(), np.rint(spacing / spacing.min()), atol=0.01):
        return None
    return Estimation("", USUAL_WINDOW, float(1 / spacing.min()), USUAL_OVERLAP, "mean", sys.maxsize, sys.maxsize)


def line_correlation(frequencies: FloatArray, estimation: Estimation) -> scipy.sparse.csr_array:
    """Correlation (n_b, n_b) of the random errors of a response's lines, as segments and window bands overlap.

    With the window's ambiguity function A(lag, shift), the sum over the lags m between segments of |A(m, f - f')|^2,
    over the same for equal lines. Without overlap that is |sum w^2 exp(2 pi j (f - f') t)|^2 / (sum w^2)^2.
    """
    bins = np.rint(frequencies * estimation.seconds).astype(np.intp)
    by_distance = _by_distance(estimation)
    rows, columns, values = [], [], []
    for distance, correlation in enumerate(by_distance):
        first = np.arange(len(bins))
        place = np.clip(np.searchsorted(bins, bins + distance), 0, len(bins) - 1)
        first = first[bins[place] == bins + distance]
        second = place[first]
        rows += [first, second] if distance else [first]
        columns += [second, first] if distance else [first]
        values += [np.full(len(first), correlation)] * (2 if distance else 1)
    shape = (len(bins), len(bins))
    return scipy.sparse.csr_array(
        (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=shape
    )


def _by_distance(estimation: Estimation) -> FloatArray:
    """Correlation of the random errors of lines 0, 1, 2 ... bins apart, up to the last that is not negligible."""
    window = np.asarray(scipy.signal.get_window(estimation.window, WINDOW_SAMPLES), dtype=np.float64)
    step = max(1, WINDOW_SAMPLES - round(estimation.overlap * WINDOW_SAMPLES))
    total = np.zeros(WINDOW_SAMPLES // 2)
    for m in range(min(estimation.averages, -(-WINDOW_SAMPLES // step))):
        # Windows m steps apart share noise where they overlap; lines correlate by the squared spectrum of that.
        shared = np.zeros(WINDOW_SAMPLES)
        shared[m * step :] = window[m * step :] * window[: WINDOW_SAMPLES - m * step]
        # Of n averages, n - m pairs are m apart, in both sequences.
        weight = 1 if m == 0 else 2 * (1 - m / estimation.averages)
        total += weight * np.abs(np.fft.fft(shared)[: WINDOW_SAMPLES // 2]) ** 2
    correlation = total / total[0]
    return np.asarray(correlation[: np.flatnonzero(correlation > NEGLIGIBLE_CORRELATION)[-1] + 1])
