"""Smoothing of a model's response by the windows of Welch's method, before comparison with an estimate.

Under a stationary input the estimate at f tends to the transform of the impulse response times the lag window, which is
the window's correlation with itself. In frequency that is a weighted mean of the response about f.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.estimation import Estimation

NEIGHBOUR_BINS = 8
"""Number of bins on either side of a line that a window mixes into it, beyond which its side lobes are negligible."""
POINTS_PER_BIN = 8
"""Number of points per bin at which a response is evaluated for smoothing, as more give a smoother mean at more
cost."""
SMOOTHING_ERROR_SHARE = 0.15
"""Standard error of the smoothing of all lines together, as a share of it, if the input was a sweep, which is not
stationary."""
LINE_ERROR_RATIO = 1.5
"""Standard error of a single line's smoothing as a multiple of it under a sweep, where the slope of the input's power
has as much effect as the curvature of the response."""
ERROR_CORRELATION_LINES = 1.5
"""Distance in lines over which the smoothing errors of lines are correlated, about the width of a window's band."""


@dataclass(frozen=True, eq=False)
class Smoothing:
    """Linear smoothing of a response G, forward @ G + mirrored @ conj(G); for H2 applied to 1/G, then inverted.

    Attributes
    ----------
    fine : (n_f,) array
        Frequencies at which the transfer function is needed, Hz.
    forward, mirrored : (n_b, n_f) sparse array
    inverted : bool
    exact : bool
        Whether this is the exact mean effect of the windows (stationary input).
    line_indices : (n_b,) array of int
        Indices of the lines in ``fine``.
    """

    fine: FloatArray
    forward: scipy.sparse.csr_array
    mirrored: scipy.sparse.csr_array
    inverted: bool
    exact: bool
    line_indices: NDArray[np.intp]

    def smoothed(self, G: ComplexArray, slopes: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Smoothed response at the lines (n_b,) and derivatives (n_b, n), from G (n_f,) and derivatives (n_f, n)."""
        if not self.inverted:
            return self._linear(G), self._linear(slopes)
        below = self._linear(1 / G)
        return 1 / below, self._linear(slopes / (G**2)[:, None]) / (below**2)[:, None]

    def covariance(self, change: ComplexArray) -> FloatArray:
        """Covariance (2 n_b, 2 n_b) of the errors of a model's smoothed response where the input was a sweep.

        Real parts stand before imaginary ones; ``change`` (n_b,) is smoothed minus exact.
        """
        far = np.subtract.outer(self.line_indices, self.line_indices) / POINTS_PER_BIN / ERROR_CORRELATION_LINES
        both = LINE_ERROR_RATIO**2 * np.outer(change, change.conj()) * np.exp(-(far**2) / 2)
        return np.block([[both.real, -both.imag], [both.imag, both.real]]) / 2

    def _linear(self, G: ComplexArray) -> ComplexArray:
        return np.asarray(self.forward @ G + self.mirrored @ G.conj())


def smoothing(frequencies: FloatArray, estimation: Estimation) -> Smoothing:
    """Smoothing of a model's response for the lines (n_b,) in Hz of an estimate, by its window and estimator."""
    step = 1 / (estimation.seconds * POINTS_PER_BIN)
    offsets = np.arange(-NEIGHBOUR_BINS * POINTS_PER_BIN, NEIGHBOUR_BINS * POINTS_PER_BIN + 1)
    inverted, exact = estimation.estimator == "H2", not estimation.swept
    weights = _shares(estimation, offsets)
    if estimation.aligned:
        # Windows saw G exp(j omega lag), whose phase was put back at each line: neighbours are turned against it.
        turn = 2j * np.pi * offsets * step * estimation.aligned
        weights = weights * np.exp(-turn if inverted else turn)
    lines = np.rint(frequencies / step).astype(np.intp)
    places = lines[:, None] + offsets
    count = int(np.abs(places).max())
    # There is no response at 0 Hz to ask for: the real part of its neighbour stands in.
    targets, half = np.maximum(np.abs(places), 1), np.where(places == 0, 0.5, 1.0)
    forward = _sparse(np.where(places >= 0, weights * half, 0.0), targets, count)
    mirrored = _sparse(np.where(places <= 0, weights * half, 0.0), targets, count)
    fine = np.asarray(np.arange(1, count + 1) * step, dtype=np.float64)
    return Smoothing(fine, forward, mirrored, inverted, exact, lines - 1)


def _sparse(weights: FloatArray, places: NDArray[np.intp], count: int) -> scipy.sparse.csr_array:
    """Sparse matrix (n_b, count) from weights (n_b, n) and the numbers of their columns, counted from 1."""
    lines = np.repeat(np.arange(len(places)), places.shape[1])
    return scipy.sparse.csr_array((weights.ravel(), (lines, places.ravel() - 1)), shape=(len(places), count))


def _shares(estimation: Estimation, offsets: NDArray[np.intp]) -> FloatArray:
    """Weights with which a window mixes the response at frequency offsets (in fine steps) into a line, sum 1."""
    samples = 4 * NEIGHBOUR_BINS * POINTS_PER_BIN
    window = np.asarray(scipy.signal.get_window(estimation.window, samples), dtype=np.float64)
    power = np.abs(np.fft.fft(window, samples * POINTS_PER_BIN)) ** 2
    share = power[offsets % len(power)]
    return np.asarray(share / share.sum())
