"""How uncertain the lines of a response are, and how far neighbours share their errors."""

from __future__ import annotations

import numpy as np
from scipy.signal import get_window
from scipy.sparse import csr_array

from torsionnet.assembly.rows import FloatArray
from torsionnet.response import FrequencyResponse
from torsionnet.response.estimation import Estimation

LOWEST_COHERENCE, HIGHEST_COHERENCE = 1e-3, 1 - 1e-6
SAMPLES = 512
"""Of a window, whose shape is all that matters here."""
NOTHING = 1e-4
"""Correlation that is left out."""
USUAL_WINDOW, USUAL_OVERLAP = "hann", 0.5
"""What is assumed of a coherence that does not say how it was averaged."""


def line_noise(data: FrequencyResponse, error: float | None) -> FloatArray:
    """Variance (n_f,) of the real part, and as much of the imaginary one, of one pair.

    From a relative standard error if there is one, else from the coherence; in proportion to the squared magnitude
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
    """How a response was averaged; what is usual if it does not say, and None if it was not averaged.

    Lines of a window are 1 / seconds apart, and evenly.
    """
    if data.estimation is not None or data.coherence is None:
        return data.estimation
    apart = np.diff(data.frequencies)
    if not len(apart) or not np.allclose(apart / apart.min(), np.rint(apart / apart.min()), atol=0.01):
        return None
    return Estimation("", USUAL_WINDOW, float(1 / apart.min()), USUAL_OVERLAP, "mean", 10**6, 10**6)


def line_correlation(frequencies: FloatArray, estimation: Estimation) -> csr_array:
    """Of the random errors of lines (n_b, n_b): segments overlap, and so do the bands that a window lets through.

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
    return csr_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=shape)


def _by_distance(estimation: Estimation) -> FloatArray:
    """Correlation of lines that are 0, 1, 2 ... bins apart, as far as there is any."""
    window = np.asarray(get_window(estimation.window, SAMPLES), dtype=np.float64)
    step = max(1, SAMPLES - round(estimation.overlap * SAMPLES))
    total = np.zeros(SAMPLES // 2)
    for m in range(min(estimation.averages, -(-SAMPLES // step))):
        shared = np.zeros(SAMPLES)
        shared[m * step :] = window[m * step :] * window[: SAMPLES - m * step]
        weight = 1 if m == 0 else 2 * (1 - m / estimation.averages)
        total += weight * np.abs(np.fft.fft(shared)[: SAMPLES // 2]) ** 2
    found = total / total[0]
    return np.asarray(found[: np.flatnonzero(found > NOTHING)[-1] + 1])
