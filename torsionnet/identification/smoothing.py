"""What the windows of an average make of a model's response before it is compared with the estimate.

Under a stationary input the estimate at f tends to the transform of the impulse response times the lag window, which is
the window's correlation with itself. In frequency that is a weighted mean of the response about f.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import get_window

from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.response.estimation import Estimation

REACH = 8
"""Bins on either side of a line that enter it."""
FINER = 8
"""Points of the transfer function per bin."""
UNCERTAIN = 0.15
"""Share of the smoothing that is in doubt if the input was a sweep, which is not stationary."""


@dataclass(frozen=True, eq=False)
class Smoothing:
    """Estimate of a model's response: forward @ G + mirrored @ conj(G), or of H2 the same of 1/G and 1/estimate.

    Attributes
    ----------
    fine : (n_f,) array
        Frequencies at which the transfer function is needed, Hz.
    forward, mirrored : (n_b, n_f) array
    inverted : bool
    exact : bool
        Whether this is all that windows do, in the mean.
    own : (n_b,) array of int
        Places of the lines in ``fine``.
    """

    fine: FloatArray
    forward: FloatArray
    mirrored: FloatArray
    inverted: bool
    exact: bool
    own: NDArray[np.intp]

    def smoothed(self, G: ComplexArray, slopes: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Of G (n_f,) and its derivatives (n_f, n): the lines (n_b,), (n_b, n)."""
        if not self.inverted:
            return self._linear(G), self._linear(slopes)
        below = self._linear(1 / G)
        return 1 / below, self._linear(slopes / (G**2)[:, None]) / (below**2)[:, None]

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
    lines = np.broadcast_to(np.arange(len(frequencies))[:, None], places.shape)
    forward, mirrored = (np.zeros((len(frequencies), count + 1)) for _ in range(2))
    for target, mine in ((forward, places >= 0), (mirrored, places < 0)):
        np.add.at(target, (lines[mine], np.abs(places[mine])), np.broadcast_to(weights, places.shape)[mine])
    # There is no response at 0 Hz to ask for: the real part of its neighbour stands in.
    for target in (mirrored, forward):
        target[:, 1] += forward[:, 0] / 2
    fine = np.asarray(np.arange(1, count + 1) * step, dtype=np.float64)
    inverted, exact = estimation.estimator == "H2", not estimation.swept
    return Smoothing(fine, forward[:, 1:], mirrored[:, 1:], inverted, exact, own - 1)


def _shares(estimation: Estimation, offsets: NDArray[np.intp]) -> FloatArray:
    """How much of its line the window lets through at frequencies so many fine steps away."""
    samples = 4 * REACH * FINER
    window = np.asarray(get_window(estimation.window, samples), dtype=np.float64)
    power = np.abs(np.fft.fft(window, samples * FINER)) ** 2
    share = power[offsets % len(power)]
    return np.asarray(share / share.sum())
