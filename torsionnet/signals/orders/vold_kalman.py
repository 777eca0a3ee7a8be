"""Second-generation Vold-Kalman filter: the complex envelopes of several orders at once, by least squares.

The data equation says x(t) = a_0(t) + sum_k Re a_k(t) exp(j o_k phi_k(t)) + noise; the structure equation, that the
p-th difference of each envelope a_k is small: H. Vold, M. Mains and J. Blough, Theoretical foundations for high
performance order tracking with the Vold-Kalman tracking filter, SAE 972007; J. Tuma, Setting the passband width in the
Vold-Kalman order tracking filter, ICSV 12 (2005). Envelopes are cubic B-splines with several coefficients in the time
1/bandwidth, and the differences are those of their coefficients (P. Eilers and B. Marx, Flexible smoothing with
B-splines and penalties, Statistical Science 11 (1996) 89), so that the size of the banded normal equations follows from
the bandwidth, not from the sampling rate.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import comb
from typing import Any

import numpy as np

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.signals.orders.tracked_orders import TrackingKernel
from torsionnet.signals.recording import FloatArray

COEFFICIENTS_PER_BANDWIDTH = 10
"""Coefficients of an envelope in the time 1/bandwidth: the filter then differs from that with a coefficient for each
sample by less than 1 % at the edges of its band."""
SPLINE_DEGREE = 3
"""Degree of the splines of envelopes."""
MOST_POLES = 4
"""Largest number of poles; more make the equations too ill-conditioned."""
WORST_CONDITION = 1e13
"""Ratio of the weights of structure and data equations from which the banded equations lose all digits."""


@dataclass(frozen=True)
class VoldKalman:
    """Settings of Vold-Kalman filters.

    Attributes
    ----------
    bandwidth : float
        Width in Hz between the points at which an envelope's fluctuation passes with 1/sqrt(2), -3 dB.
    share : float
        Instead: bandwidth as share of the frequency of each order.
    poles : int
        1 to 4: differences of the envelope that are kept small. The filter's flanks fall with twice as many powers of
        the distance.

    Raises
    ------
    UsageError
        The bandwidth is not positive, or the poles are not 1 to 4.

    Examples
    --------
    >>> VoldKalman(bandwidth=1.0).poles
    2
    """

    bandwidth: float = 1.0
    share: float = 0.0
    poles: int = 2

    def __post_init__(self) -> None:
        if self.share < 0 or (not self.share and not self.bandwidth > 0):
            raise UsageError(
                "the bandwidth of a Vold-Kalman filter is positive, in Hz or as share of the frequency",
                kind="out-of-range",
            )
        if not 1 <= self.poles <= MOST_POLES:
            raise UsageError(f"a Vold-Kalman filter has 1 to {MOST_POLES} poles, got {self.poles}", kind="out-of-range")

    @property
    def kernel(self) -> TrackingKernel:
        """Weights with which the filters take the mean of an amplitude over time."""
        return TrackingKernel(0.0 if self.share else self.bandwidth, self.share, self.poles)

    @property
    def words(self) -> str:
        """Words on the bandwidth and the poles of the filters."""
        width = f"{100 * self.share:.4g} % of the order's frequency" if self.share else f"{self.bandwidth:.4g} Hz"
        return f"Vold-Kalman filter of {self.poles} poles, bandwidth {width} between the -3 dB points"

    @property
    def related_bandwidths(self) -> float:
        """Time within which values share data, times the bandwidth, without unit.

        With a correlation that falls in a straight line over it, values are worth as many independent ones as with
        white noise behind the filter: it is 3/2 of the integral of H^4 over the square of that of H^2, with the
        response H = 1/(1 + (sqrt 2 - 1) (2f/bandwidth)^(2 poles)).
        """
        power = 2 * self.poles
        # Integrals of powers n of H = 1/(1 + x^2p): I_(n+1) = I_n (1 - 1/(2 p n)), with I_1 from the sine.
        first = np.pi / power / np.sin(np.pi / power)
        of_squares = first * (1 - 1 / power)
        of_fourths = of_squares * (1 - 1 / (2 * power)) * (1 - 1 / (3 * power))
        return float(1.5 * of_fourths / of_squares**2 * (np.sqrt(2) - 1) ** (1 / power))

    def bandwidths(self, frequencies: FloatArray) -> FloatArray:
        """Bandwidth in Hz at frequencies of orders in Hz, in their shape."""
        return self.share * frequencies if self.share else np.full(frequencies.shape, self.bandwidth)


class EnvelopeFilter:
    """Filter for the envelopes of orders in signals that share their samples.

    Parameters
    ----------
    times : (n,) array
        Times of the samples, s, rising; they need not be even.
    phases : (n_orders, n) array
        Phase o_k phi_k of each order at each sample, rad.
    knots : (n_knots,) array
        Even times between which an envelope is one cubic, s.
    bandwidths : (n_orders + 1, n_knots - 1) array
        Bandwidth in Hz of the mean and of each order, in each interval between knots.
    poles : int
    """

    def __init__(
        self, times: FloatArray, phases: FloatArray, knots: FloatArray, bandwidths: FloatArray, poles: int
    ) -> None:
        from scipy.interpolate import BSpline
        from scipy.linalg import cholesky_banded

        self.times, self.phases, self.poles = times, phases, poles
        step = knots[1] - knots[0]
        around = np.arange(-SPLINE_DEGREE, len(knots) + SPLINE_DEGREE)
        self._full = knots[0] + step * around
        self._edges = self._full[SPLINE_DEGREE:-SPLINE_DEGREE]
        inside = np.clip(times, self._edges[0], self._edges[-1])
        self._design: Any = BSpline.design_matrix(inside, self._full, SPLINE_DEGREE)
        self.count, self.width = len(knots) - 1 + SPLINE_DEGREE, 1 + 2 * len(phases)
        # Normal equations (B^T B + W) c = B^T y of data and structure, banded as each spline spans a few knots.
        gram = self._gram()
        structure = self._structure(gram, bandwidths, step)
        self._weights = structure
        with np.errstate(all="ignore"):
            try:
                self._factor = cholesky_banded(self._banded(gram + structure), lower=True, overwrite_ab=True)
            except np.linalg.LinAlgError:
                raise SolveError(
                    f"{len(phases)} orders cannot be told apart from {times[0]:.6g} to {times[-1]:.6g} s: take fewer "
                    "poles, or a larger bandwidth, or leave out an order that runs with another one",
                    kind="unfit-order",
                ) from None

    @cached_property
    def _starts(self) -> np.ndarray[Any, np.dtype[np.intp]]:
        return np.asarray(np.searchsorted(self.times, self._edges[:-1]), dtype=np.intp)

    def _basis(self, part: slice) -> FloatArray:
        """Cosine and minus sine of each order at samples, with 1 for the mean, shape (n, 1 + 2 n_orders)."""
        # y = mean + sum over the orders of Re X cos(phase) - Im X sin(phase).
        basis = np.empty((part.stop - part.start, self.width))
        basis[:, 0] = 1
        basis[:, 1::2] = np.cos(self.phases[:, part]).T
        basis[:, 2::2] = -np.sin(self.phases[:, part]).T
        return basis

    def _intervals(self) -> Any:
        """Yield the number of each interval with samples, the samples, and all basis functions there."""
        bounds = [0, *self._starts.tolist()[1:], len(self.times)]
        data = self._design.data.reshape(len(self.times), SPLINE_DEGREE + 1)
        for number, (begin, end) in enumerate(pairwise(bounds)):
            if end > begin:
                part = slice(begin, end)
                both = data[part, :, None] * self._basis(part)[:, None, :]
                yield number, part, both.reshape(end - begin, -1)

    def _gram(self) -> FloatArray:
        """Blocks of the data equation's normal matrix, shape (reach + 1, n_coefficients, width, width)."""
        reach, width, many = max(SPLINE_DEGREE, self.poles), self.width, SPLINE_DEGREE + 1
        gram = np.zeros((reach + 1, self.count, width, width))
        for number, _, both in self._intervals():
            product = (both.T @ both).reshape(many, width, many, width)
            for row in range(many):
                for other in range(row, many):
                    gram[other - row, number + row] += product[other, :, row, :]
        return gram

    def _structure(self, gram: FloatArray, bandwidths: FloatArray, step: float) -> FloatArray:
        """Blocks of the structure equation's normal matrix: squared differences of coefficients, weighted."""
        poles, count = self.poles, self.count
        # Row sums of the data's normal matrix: the weight with which samples hold a slowly varying envelope.
        diagonal = np.einsum("dcii->ci", gram[:1]) + 2 * np.einsum("dcii->ci", gram[1 : SPLINE_DEGREE + 1])
        edge = np.sqrt(2) - 1
        at = np.clip(np.arange(count) - 1, 0, bandwidths.shape[1] - 1)
        per_line = np.repeat(bandwidths[:, at], [1, *[2] * (len(bandwidths) - 1)], axis=0).T
        density = np.empty_like(diagonal)
        typical = diagonal.mean(axis=0)
        density[:] = typical
        inner = slice(SPLINE_DEGREE, count - SPLINE_DEGREE)
        density[inner] = _smooth(diagonal, COEFFICIENTS_PER_BANDWIDTH)[inner]
        # The response is 1/sqrt(2) at half the bandwidth B: r (2 sin(pi B h/2))^2p = sqrt(2) - 1 over knots h apart.
        factor = edge * (2 * np.sin(np.pi * np.minimum(per_line * step, 1) / 2)) ** (-2.0 * poles)
        if factor.max() > WORST_CONDITION:
            raise UsageError(
                "the bandwidths of the orders differ by too much for so many poles: give one bandwidth in Hz, or take "
                "fewer poles",
                kind="contradicting-values",
            )
        weights = density * factor
        # Difference of degree p: its signed binomials, multiplied in pairs, fill the bands.
        signs = np.array([(-1) ** k * comb(poles, k) for k in range(poles + 1)], dtype=float)
        structure = np.zeros_like(gram)
        lines = np.arange(self.width)
        rows = count - poles
        middle = weights[poles // 2 : poles // 2 + rows]
        for first in range(poles + 1):
            for other in range(first, poles + 1):
                structure[other - first][first : first + rows, lines, lines] += signs[first] * signs[other] * middle
        return structure

    def _banded(self, blocks: FloatArray) -> FloatArray:
        reach, count, width, _ = blocks.shape
        bands = np.zeros((reach * width, count * width))
        # Lower bands as LAPACK stores them: the row says the distance below the diagonal.
        for distance in range(reach):
            for column in range(width):
                first = column if distance == 0 else 0
                rows = distance * width + np.arange(first, width) - column
                bands[rows, column::width] = blocks[distance, :, first:, column].T
        return bands

    def solve(self, values: FloatArray) -> FloatArray:
        """Coefficients of the envelopes of signals (n_signals, n), shape (n_coefficients, width, n_signals)."""
        right = np.zeros((self.count, self.width, len(values)))
        for number, part, both in self._intervals():
            share = (both.T @ values[:, part].T).reshape(SPLINE_DEGREE + 1, self.width, -1)
            right[number : number + SPLINE_DEGREE + 1] += share
        return self._back(right)

    def lost(self, coefficients: FloatArray) -> FloatArray:
        """Change of coefficients when the signal they describe is filtered again, in their shape and unit."""
        blocks = self._weights
        lines = np.arange(self.width)
        weighted = np.zeros_like(coefficients)
        for distance in range(len(blocks)):
            weights = blocks[distance][:, lines, lines][:, :, None]
            rows = self.count - distance
            weighted[distance:] += weights[:rows] * coefficients[:rows]
            if distance:
                weighted[:rows] += weights[:rows] * coefficients[distance:]
        return self._back(weighted)

    def _back(self, right: FloatArray) -> FloatArray:
        from scipy.linalg import cho_solve_banded

        solved = cho_solve_banded((self._factor, True), right.reshape(self.count * self.width, -1))
        return np.asarray(solved).reshape(right.shape)

    def envelopes(self, coefficients: FloatArray, times: FloatArray) -> tuple[FloatArray, ComplexArray]:
        """Mean (n_signals, n) and complex envelopes (n_signals, n_orders, n) at times in s, in the signals' unit."""
        from scipy.interpolate import BSpline

        values = np.moveaxis(BSpline(self._full, coefficients, SPLINE_DEGREE)(times), 0, -1)
        values = np.moveaxis(values, 1, 0)
        return values[:, 0], values[:, 1::2] + 1j * values[:, 2::2]

    def residual(self, coefficients: FloatArray, values: FloatArray) -> FloatArray:
        """Values minus mean and orders, shape (n_signals, n), in the signals' unit."""
        residual = values.copy()
        for number, part, both in self._intervals():
            used = coefficients[number : number + SPLINE_DEGREE + 1].reshape(both.shape[1], -1)
            residual[:, part] -= (both @ used).T
        return residual


def _smooth(values: FloatArray, reach: int) -> FloatArray:
    """Mean over the neighbours on both sides, along the first axis."""
    padded = np.pad(values, ((reach, reach), (0, 0)), mode="reflect" if len(values) > reach else "edge")
    # Moving mean as the difference of two running sums.
    sums = np.cumsum(np.concatenate([np.zeros((1, values.shape[1])), padded]), axis=0)
    return np.asarray((sums[2 * reach + 1 :] - sums[: -2 * reach - 1]) / (2 * reach + 1))
