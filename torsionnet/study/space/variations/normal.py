"""Normal variation of a parameter, with normally distributed values."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, log, pi
from typing import ClassVar

import numpy as np
import scipy
from numpy.typing import ArrayLike

from torsionnet.base.entries.spec import entry
from torsionnet.base.expressions import Number
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.study.space.variations.nominal import NominalReader
from torsionnet.study.space.variations.truncated import truncated
from torsionnet.study.space.variations.variation import (
    HIGHEST_VALUE,
    LOWEST_VALUE,
    MIDDLE,
    SPREAD,
    Marginal,
    ParameterValue,
    Variation,
    register_variation,
)

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
        limits = {what: reader.value(one, key) for what, key, one in ends if one is not None}
        return {MIDDLE: mean, SPREAD: reader.spread(self.deviation, mean, "deviation"), **limits}

    def bound(self, reader: NominalReader) -> Marginal | None:
        mean = reader.value(self.mean, "mean")
        found = NormalMarginal(mean, reader.spread(self.deviation, mean, "deviation"))
        limited = truncated(found, self.low, self.high, reader)
        return None if reader.faults else limited
