"""The distribution of one parameter, in SI."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtr, ndtri

from torsionnet.response.frequency_response import FloatArray


class Marginal:
    """Base of the distributions of one parameter.

    Both tails are exact: what is close to the upper end is asked for by the share above it.

    Attributes
    ----------
    low, high : float
        Where the values end; infinite where they tail off.
    """

    low: float
    high: float

    def cdf(self, values: ArrayLike) -> FloatArray:
        """Share of the variants below."""
        raise NotImplementedError

    def sf(self, values: ArrayLike) -> FloatArray:
        """Share of the variants above."""
        raise NotImplementedError

    def ppf(self, shares: ArrayLike) -> FloatArray:
        """Value with a share of the variants below it."""
        raise NotImplementedError

    def isf(self, shares: ArrayLike) -> FloatArray:
        """Value with a share of the variants above it."""
        raise NotImplementedError

    def log_density(self, values: ArrayLike) -> FloatArray:
        """Logarithm of the probability density; minus infinity where no value is possible."""
        raise NotImplementedError

    def from_normal(self, normal: ArrayLike) -> FloatArray:
        """Values at the same shares as those of a standard normal variable."""
        u = np.asarray(normal, dtype=float)
        tail = ndtr(-np.abs(u))
        return np.where(u < 0, self.ppf(tail), self.isf(tail))

    def to_normal(self, values: ArrayLike) -> FloatArray:
        """Inverse of :meth:`from_normal`."""
        below, above = self.cdf(values), self.sf(values)
        return np.asarray(np.where(below < above, ndtri(below), -ndtri(above)))
