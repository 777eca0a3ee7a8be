"""Small probability of a failure with its confidence interval and the reasons that make it uncertain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class RareEvent:
    """Probability of a failure with its confidence interval, its error and the number of variants calculated.

    Attributes
    ----------
    probability, low, high : float
        Probability and ends of its interval; NaN where nothing failed.
    variation : float
        Standard error over the probability.
    evaluations : int
        Variants calculated.
    doubts : tuple of str
        Reasons why the probability is uncertain; empty where there are none.
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
        """Reliability index beta, with which the failure probability is Phi(-beta), of the normal distribution."""
        from scipy.special import ndtri

        return float(-ndtri(self.probability))

    @property
    def words(self) -> str:
        """Failure probability in words, with its interval and the number of variants."""
        between = f"{self.low:.3g} to {self.high:.3g}; " if np.isfinite(self.low) else ""
        return f"{self.probability:.3g} ({between}{self.evaluations} variants)"


def lognormal_interval(probability: float, variation: float, quantile: float) -> tuple[float, float]:
    """Ends of the confidence interval of a small probability whose logarithm is normally distributed."""
    if not probability or not np.isfinite(variation):
        return float("nan"), float("nan")
    factor = float(np.exp(quantile * np.sqrt(np.log1p(variation**2))))
    return probability / factor, min(1.0, probability * factor)
