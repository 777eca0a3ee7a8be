"""What the windows of an average make of a model's response before it is compared with the estimate.

Under a stationary input the estimate at f tends to the transform of the impulse response times the lag window, which is
the window's correlation with itself. In frequency that is a weighted mean of the response about f.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import get_window
from scipy.sparse import csr_array

from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.response.estimation import Estimation

REACH = 8
"""Bins on either side of a line that enter it."""
FINER = 8
"""Points of the transfer function per bin."""
UNCERTAIN = 0.15
"""Share of the smoothing that is in doubt as a whole if the input was a sweep, which is not stationary."""
OFF = 1.5
"""The same of single lines: where the power of the input slopes, that does as much as the curve of the response."""
ALIKE = 1.5
"""Lines over which such errors are alike."""


@dataclass(frozen=True, eq=False)
class Smoothing:
    """Estimate of a model's response: forward @ G + mirrored @ conj(G), or of H2 the same of 1/G and 1/estimate.

    Attributes
    ----------
    fine : (n_f,) array
        Frequencies at which the transfer function is needed, Hz.
    forward, mirrored : (n_b, n_f) sparse array
    inverted : bool
    exact : bool
        Whether this is all that windows do, in the mean.
    own : (n_b,) array of int
        Places of the lines in ``fine``.
    """

    fine: FloatArray
    forward: csr_array
    mirrored: csr_array
    inverted: bool
    exact: bool
    own: NDArray[np.intp]

    def smoothed(self, G: ComplexArray, slopes: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Of G (n_f,) and its derivatives (n_f, n): the lines (n_b,), (n_b, n)."""
        if not self.inverted:
            return self._linear(G), self._linear(slopes)
        below = self._linear(1 / G)
        return 1 / below, self._linear(slopes / (G**2)[:, None]) / (below**2)[:, None]

    def covariance(self, change: ComplexArray) -> FloatArray:
        """Of real and imaginary parts of lines (2 n_b, 2 n_b) that windows change by so much, under a sweep."""
        far = np.subtract.outer(self.own, self.own) / FINER / ALIKE
        both = OFF**2 * np.outer(change, change.conj()) * np.exp(-(far**2) / 2)
        return np.block([[both.real, -both.imag], [both.imag, both.real]]) / 2

    def _linear(self, G: ComplexArray) -> ComplexArray:
        return np.asarray(self.forward @ G + self.mirrored @ G.conj())


def smoothing(frequencies: FloatArray, estimation: Estimation) -> Smoothing:
    """Of the lines (n_b,) of an estimate of one pair."""
    step = 1 / (estimation.seconds * FINER)
    offsets = np.arange(-REACH * FINER, REACH * FINER + 1)
    weights = _shares(estimation, offsets)
    own = np.rint(frequencies / step).astype(np.intp)
    places = own[:, None] + offsets
    count = int(np.abs(places).max())
    # There is no response at 0 Hz to ask for: the real part of its neighbour stands in.
    targets, half = np.maximum(np.abs(places), 1), np.where(places == 0, 0.5, 1.0)
    forward = _sparse(np.where(places >= 0, weights * half, 0.0), targets, count)
    mirrored = _sparse(np.where(places <= 0, weights * half, 0.0), targets, count)
    fine = np.asarray(np.arange(1, count + 1) * step, dtype=np.float64)
    inverted, exact = estimation.estimator == "H2", not estimation.swept
    return Smoothing(fine, forward, mirrored, inverted, exact, own - 1)


def _sparse(weights: FloatArray, places: NDArray[np.intp], count: int) -> csr_array:
    """Weights (n_b, n) of columns 1 to ``count``."""
    lines = np.repeat(np.arange(len(places)), places.shape[1])
    return csr_array((weights.ravel(), (lines, places.ravel() - 1)), shape=(len(places), count))


def _shares(estimation: Estimation, offsets: NDArray[np.intp]) -> FloatArray:
    """How much of its line the window lets through at frequencies so many fine steps away."""
    samples = 4 * REACH * FINER
    window = np.asarray(get_window(estimation.window, samples), dtype=np.float64)
    power = np.abs(np.fft.fft(window, samples * FINER)) ** 2
    share = power[offsets % len(power)]
    return np.asarray(share / share.sum())
