"""What is made small where every design is a crowd of samples: mean and deviation, a percentile, or the rejects."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.errors import UsageError


class RobustMeasure(Protocol):
    """Of the samples of a design one number, on the bad side of them."""

    def name(self, quantity: str, sign: float) -> str:
        """What it is called; ``sign`` is 1 where large is bad, -1 where small is."""
        ...

    def of(self, samples: FloatArray, sign: float) -> FloatArray:
        """Measure (n,) of samples (n, count)."""
        ...


@dataclass(frozen=True)
class MeanAndDeviation:
    """Mean and ``k`` standard deviations.

    >>> MeanAndDeviation(2.0).of(np.array([[1.0, 3.0]]), 1.0).tolist()
    [4.0]
    """

    k: float = 3.0

    def __post_init__(self) -> None:
        if not (np.isfinite(self.k) and self.k >= 0):
            raise UsageError(f"mean and k standard deviations need a k from 0, got {self.k:g}")

    def name(self, quantity: str, sign: float) -> str:
        more = f" {'+' if sign > 0 else '-'} {self.k:g} sigma" if self.k else ""
        return f"mean{more} of {quantity}"

    def of(self, samples: FloatArray, sign: float) -> FloatArray:
        return np.asarray(samples.mean(axis=1) + sign * self.k * samples.std(axis=1))


@dataclass(frozen=True)
class SamplePercentile:
    """What so many percent of samples are not worse than.

    >>> SamplePercentile(75.0).of(np.array([[0.0, 1.0, 2.0, 3.0, 4.0]]), -1.0).tolist()
    [1.0]
    """

    percent: float = 95.0

    def __post_init__(self) -> None:
        if not 0 < self.percent < 100:
            raise UsageError(f"a percentile lies between 0 and 100 %, got {self.percent:g}")

    def name(self, quantity: str, sign: float) -> str:
        return f"{self.percent if sign > 0 else 100 - self.percent:g} % percentile of {quantity}"

    def of(self, samples: FloatArray, sign: float) -> FloatArray:
        share = self.percent / 100 if sign > 0 else 1 - self.percent / 100
        return np.asarray(np.quantile(samples, share, axis=1))


@dataclass(frozen=True)
class Rejects:
    """Share of samples that exceed a limit, from their largest excess.

    Designs with as many rejects are told by how far these exceed limits, which counts less than half a sample.

    >>> Rejects().of(np.array([[-1.0, -1.0, -1.0, 0.1]]), 1.0).round(3).tolist()
    [0.253]
    """

    def name(self, quantity: str, sign: float) -> str:
        del quantity, sign
        return "share of rejects"

    def of(self, samples: FloatArray, sign: float) -> FloatArray:
        over = np.maximum(np.nan_to_num(sign * samples, nan=np.inf), 0.0)
        far = np.where(np.isinf(over), 1.0, over / (1 + over)).mean(axis=1)
        return np.asarray((over > 0).mean(axis=1) + far / (2 * samples.shape[1]))
