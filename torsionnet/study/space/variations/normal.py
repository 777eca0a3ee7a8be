"""Normal variation of a parameter, with normally distributed values."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, log, log1p, pi, sqrt
from typing import Any, ClassVar

import numpy as np
import scipy
from numpy.typing import ArrayLike

from torsionnet.base.entries.spec import entry
from torsionnet.base.expressions import Number
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.study.space.variations.variation import (
    HIGHEST_VALUE,
    LOWEST_VALUE,
    MIDDLE,
    SPREAD,
    Marginal,
    NominalReader,
    ParameterValue,
    Variation,
    register_variation,
)

# Truncated distributions of a parameter, of which only the values between two limits are left.

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
        # By the side where shares are small, as their difference keeps its digits there.
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


def truncated_distribution(whole: Marginal, low: Number | None, high: Number | None, reader: NominalReader) -> Marginal:
    """Distribution between the limits of a variation, the whole one if there are no limits."""
    if low is None and high is None:
        return whole
    ends: Any = [
        default if number is None else reader.value(number, key)
        for key, number, default in (("low", low, -np.inf), ("high", high, np.inf))
    ]
    if ends[0] >= ends[1]:
        reader.fault(
            f"low ({ends[0]:g}) must be below high ({ends[1]:g})",
            "low" if low is not None else "high",
            kind="unordered-rows",
        )
    if reader.faults:
        return whole
    limited = TruncatedMarginal(whole, *ends)
    # Shares and densities are divided by what is left of the whole: of hardly anything they have no digits.
    if not limited.share >= LEAST_SHARE_LEFT:
        key = "low" if low is not None else "high"
        reader.fault(
            f"hardly any value of {reader.nominal.name} is left from {ends[0]:g} to {ends[1]:g}",
            key,
            kind="out-of-range",
        )
    return limited


MEAN = ParameterValue("mean; by default the value in the model")
DEVIATION = ParameterValue("standard deviation; in percent it is a share of the mean")
LOW = ParameterValue("no value is below; by default there is no such limit")
HIGH = ParameterValue("no value is above; by default there is no such limit")


class NormalMarginal(Marginal):
    """Normal distribution of a parameter by mean and standard deviation in SI."""

    low, high = -inf, inf

    def __init__(self, mean: float, deviation: float) -> None:
        self.mean, self.deviation = mean, deviation

    def to_normal(self, values: ArrayLike) -> FloatArray:
        return (np.asarray(values, dtype=float) - self.mean) / self.deviation

    def from_normal(self, normal: ArrayLike) -> FloatArray:
        return self.mean + self.deviation * np.asarray(normal, dtype=float)

    def cdf(self, values: ArrayLike) -> FloatArray:
        return np.asarray(scipy.special.ndtr(self.to_normal(values)))

    def sf(self, values: ArrayLike) -> FloatArray:
        return np.asarray(scipy.special.ndtr(-self.to_normal(values)))

    def ppf(self, shares: ArrayLike) -> FloatArray:
        return self.from_normal(scipy.special.ndtri(np.asarray(shares, dtype=float)))

    def isf(self, shares: ArrayLike) -> FloatArray:
        return self.from_normal(-scipy.special.ndtri(np.asarray(shares, dtype=float)))

    def log_density(self, values: ArrayLike) -> FloatArray:
        return -(self.to_normal(values) ** 2) / 2 - log(2 * pi) / 2 - log(self.deviation)


@register_variation
@dataclass(frozen=True, kw_only=True)
class Normal(Variation):
    """Normal variation of a parameter, with limits beyond which values are left out and the rest keeps its proportions.

    Mean and deviation are those before anything is left out.

    Examples
    --------
    >>> Normal(deviation="5 %", low=0).to_data()
    {'deviation': '5 %', 'low': 0}
    """

    kind: ClassVar[str] = "normal"

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
        limits = {what: reader.value(limit, key) for what, key, limit in ends if limit is not None}
        return {MIDDLE: mean, SPREAD: reader.spread(self.deviation, mean, "deviation"), **limits}

    def bound(self, reader: NominalReader) -> Marginal | None:
        mean = reader.value(self.mean, "mean")
        whole = NormalMarginal(mean, reader.spread(self.deviation, mean, "deviation"))
        limited = truncated_distribution(whole, self.low, self.high, reader)
        return None if reader.faults else limited


# Lognormal variation of a parameter, with values above 0 whose logarithms are normally distributed.


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
        density = -(self.to_normal(inside) ** 2) / 2 - log(2 * pi) / 2 - log(self.deviation) - np.log(inside)
        return np.where(x > 0, density, -inf)


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
        limits = {what: reader.value(limit, key) for what, key, limit in ends if limit is not None}
        return {MIDDLE: mean, SPREAD: reader.spread(self.deviation, mean, "deviation"), **limits}

    def bound(self, reader: NominalReader) -> Marginal | None:
        mean = reader.value(self.mean, "mean")
        deviation = reader.spread(self.deviation, mean, "deviation")
        if mean <= 0:
            text = f"lognormal values are above 0, but the mean of {reader.nominal.name} is {mean:g}"
            reader.fault(f"{text}; take another type", "mean", kind="out-of-range")
        if reader.faults:
            return None
        limited = truncated_distribution(LognormalMarginal(mean, deviation), self.low, self.high, reader)
        return None if reader.faults else limited
