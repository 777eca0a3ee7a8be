"""A small probability with its interval, and whether it is to be trusted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class RareEvent:
    """Probability of a failure.

    Attributes
    ----------
    probability, low, high : float
        With its interval; ``low`` and ``high`` are NaN where nothing failed.
    variation : float
        Standard error over the probability.
    evaluations : int
        Variants calculated.
    doubts : tuple of str
        Why it is not to be trusted; none where it is.
    method : {"importance", "subset"}
    """

    probability: float
    low: float
    high: float
    variation: float
    evaluations: int
    doubts: tuple[str, ...]
    method: str

    @property
    def index(self) -> float:
        """Reliability index, beta with probability = Phi(-beta)."""
        from scipy.special import ndtri

        return float(-ndtri(self.probability))

    @property
    def words(self) -> str:
        """The probability with its interval and what it took."""
        between = f"{self.low:.3g} to {self.high:.3g}; " if np.isfinite(self.low) else ""
        return f"{self.probability:.3g} ({between}{self.evaluations} variants)"


def between(probability: float, variation: float, quantile: float) -> tuple[float, float]:
    """Ends of an interval whose logarithm is normal, as the relative error of a small probability is."""
    if not probability or not np.isfinite(variation):
        return float("nan"), float("nan")
    factor = float(np.exp(quantile * np.sqrt(np.log1p(variation**2))))
    return probability / factor, min(1.0, probability * factor)
