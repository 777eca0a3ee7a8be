"""Truncated distributions of a parameter, of which only the values between two limits are left."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.expressions import Number
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.study.space.variations.nominal import NominalReader
from torsionnet.study.space.variations.variation import Marginal

LEAST_SHARE_LEFT = 1e-9
"""Smallest share of a distribution that may be left between its limits, as less is an error in the entry."""


class TruncatedMarginal(Marginal):
    """Distribution of the values of ``whole`` from ``low`` to ``high`` in SI, as if all others were drawn again.

    Examples
    --------
    >>> from torsionnet.study.space.variations.normal import NormalMarginal
    >>> round(float(TruncatedMarginal(NormalMarginal(0.0, 1.0), 0.0, np.inf).ppf(0.5)), 6)
    0.67449
    """

    def __init__(self, whole: Marginal, low: float, high: float) -> None:
        self.whole, self.low, self.high = whole, max(low, whole.low), min(high, whole.high)
        ends = np.array([self.low, self.high])
        self._below, self._above = whole.cdf(ends), whole.sf(ends)
        by_below, by_above = self._below[1] - self._below[0], self._above[0] - self._above[1]
        self.share = float(by_below if self._below[0] < 0.5 else by_above)
        """Share of the values of the whole distribution, from 0 to 1, that are left between the limits."""

    def _both(self, values: ArrayLike) -> tuple[FloatArray, FloatArray]:
        inside = np.clip(np.asarray(values, dtype=float), self.low, self.high)
        below, above = self.whole.cdf(inside), self.whole.sf(inside)
        # A difference of shares keeps its digits on the side where these are small.
        lower = np.where(below < 0.5, below - self._below[0], self._above[0] - above) / self.share
        upper = np.where(above < 0.5, above - self._above[1], self._below[1] - below) / self.share
        return np.clip(lower, 0, 1), np.clip(upper, 0, 1)

    def cdf(self, values: ArrayLike) -> FloatArray:
        return self._both(values)[0]

    def sf(self, values: ArrayLike) -> FloatArray:
        return self._both(values)[1]

    def ppf(self, shares: ArrayLike) -> FloatArray:
        p = np.asarray(shares, dtype=float)
        return self._at(self._below[0] + p * self.share, self._above[1] + (1 - p) * self.share)

    def isf(self, shares: ArrayLike) -> FloatArray:
        p = np.asarray(shares, dtype=float)
        return self._at(self._below[0] + (1 - p) * self.share, self._above[1] + p * self.share)

    def _at(self, below: FloatArray, above: FloatArray) -> FloatArray:
        from_below, from_above = self.whole.ppf(np.minimum(below, 0.5)), self.whole.isf(np.minimum(above, 0.5))
        return np.clip(np.where(below < 0.5, from_below, from_above), self.low, self.high)

    def log_density(self, values: ArrayLike) -> FloatArray:
        x = np.asarray(values, dtype=float)
        inside = (x >= self.low) & (x <= self.high)
        return np.where(inside, self.whole.log_density(x) - np.log(self.share), -np.inf)


def truncated(whole: Marginal, low: Number | None, high: Number | None, reader: NominalReader) -> Marginal:
    """Distribution between the limits of a variation, the whole one if there are no limits."""
    if low is None and high is None:
        return whole
    ends: Any = [
        default if number is None else reader.value(number, key)
        for key, number, default in (("low", low, -np.inf), ("high", high, np.inf))
    ]
    if ends[0] >= ends[1]:
        reader.fault(f"low ({ends[0]:g}) must be below high ({ends[1]:g})", "low" if low is not None else "high")
    if reader.faults:
        return whole
    found = TruncatedMarginal(whole, *ends)
    if not found.share >= LEAST_SHARE_LEFT:
        key = "low" if low is not None else "high"
        reader.fault(f"hardly any value of {reader.nominal.name} is left from {ends[0]:g} to {ends[1]:g}", key)
    return found
