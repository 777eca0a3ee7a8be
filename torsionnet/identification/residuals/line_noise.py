"""Variance of a response's lines by noise, and the correlation between neighbouring lines."""

from __future__ import annotations

import sys

import numpy as np
import scipy

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.estimation import Estimation
from torsionnet.linear.frequency_response import FrequencyResponse

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
        shared = np.zeros(WINDOW_SAMPLES)
        shared[m * step :] = window[m * step :] * window[: WINDOW_SAMPLES - m * step]
        weight = 1 if m == 0 else 2 * (1 - m / estimation.averages)
        total += weight * np.abs(np.fft.fft(shared)[: WINDOW_SAMPLES // 2]) ** 2
    found = total / total[0]
    return np.asarray(found[: np.flatnonzero(found > NEGLIGIBLE_CORRELATION)[-1] + 1])
