"""Lognormal variation of a parameter, with values above 0 whose logarithms are normally distributed."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, log, log1p, pi, sqrt
from typing import ClassVar

import numpy as np
import scipy
from numpy.typing import ArrayLike

from torsionnet.base.entries.spec import entry
from torsionnet.base.expressions import Number
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.study.space.variations.nominal import NominalReader
from torsionnet.study.space.variations.normal import DEVIATION, HIGH, LOW, MEAN
from torsionnet.study.space.variations.truncated import truncated
from torsionnet.study.space.variations.variation import (
    HIGHEST_VALUE,
    LOWEST_VALUE,
    MIDDLE,
    SPREAD,
    Marginal,
    Variation,
    register_variation,
)


class LognormalMarginal(Marginal):
    """Lognormal distribution by mean and standard deviation of the values, in SI."""

    low, high = -inf, inf

    def __init__(self, mean: float, deviation: float) -> None:
        self.deviation = sqrt(log1p((deviation / mean) ** 2))
        """Standard deviation of the natural logarithm of the values in SI, from their mean and standard deviation."""
        self.middle = log(mean) - self.deviation**2 / 2
        """Natural logarithm of the median of the values in SI, which is the mean of their logarithms."""

    def to_normal(self, values: ArrayLike) -> FloatArray:
        with np.errstate(divide="ignore"):
            logs = np.log(np.maximum(np.asarray(values, dtype=float), 0))
        return np.asarray((logs - self.middle) / self.deviation)

    def from_normal(self, normal: ArrayLike) -> FloatArray:
        return np.asarray(np.exp(self.middle + self.deviation * np.asarray(normal, dtype=float)))

    def cdf(self, values: ArrayLike) -> FloatArray:
        return np.asarray(scipy.special.ndtr(self.to_normal(values)))

    def sf(self, values: ArrayLike) -> FloatArray:
        return np.asarray(scipy.special.ndtr(-self.to_normal(values)))

    def ppf(self, shares: ArrayLike) -> FloatArray:
        return self.from_normal(scipy.special.ndtri(np.asarray(shares, dtype=float)))

    def isf(self, shares: ArrayLike) -> FloatArray:
        return self.from_normal(-scipy.special.ndtri(np.asarray(shares, dtype=float)))

    def log_density(self, values: ArrayLike) -> FloatArray:
        x = np.asarray(values, dtype=float)
        inside = np.where(x > 0, x, 1.0)
        found = -(self.to_normal(inside) ** 2) / 2 - log(2 * pi) / 2 - log(self.deviation) - np.log(inside)
        return np.where(x > 0, found, -inf)


@register_variation
@dataclass(frozen=True, kw_only=True)
class Lognormal(Variation):
    """Lognormal variation of a parameter, by mean and deviation of the values themselves, not of their logarithms.

    With limits, values beyond them are left out and the rest keeps its proportions.

    Examples
    --------
    >>> Lognormal(mean="460 N*m/rad", deviation="10 %").to_data()
    {'mean': '460 N*m/rad', 'deviation': '10 %'}
    """

    kind: ClassVar[str] = "lognormal"

    mean: Number | None = entry(MEAN, None)
    deviation: Number = entry(DEVIATION)
    low: Number | None = entry(LOW, None)
    high: Number | None = entry(HIGH, None)

    @property
    def words(self) -> str:
        return self.kind if self.low is None and self.high is None else f"{self.kind}, truncated"

    def sizes(self, reader: NominalReader) -> dict[str, float]:
        mean = reader.value(self.mean, "mean")
        ends = ((LOWEST_VALUE, "low", self.low), (HIGHEST_VALUE, "high", self.high))
        limits = {what: reader.value(one, key) for what, key, one in ends if one is not None}
        return {MIDDLE: mean, SPREAD: reader.spread(self.deviation, mean, "deviation"), **limits}

    def bound(self, reader: NominalReader) -> Marginal | None:
        mean = reader.value(self.mean, "mean")
        deviation = reader.spread(self.deviation, mean, "deviation")
        if mean <= 0:
            text = f"lognormal values are above 0, but the mean of {reader.nominal.name} is {mean:g}"
            reader.fault(f"{text}; take another type", "mean")
        if reader.faults:
            return None
        limited = truncated(LognormalMarginal(mean, deviation), self.low, self.high, reader)
        return None if reader.faults else limited
