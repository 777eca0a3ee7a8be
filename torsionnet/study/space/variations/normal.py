"""Normal variation of a parameter, with normally distributed values."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, inf, log, log1p, nan, pi, sqrt
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.entries.spec import entry
from torsionnet.base.expressions import Number
from torsionnet.linear.assembly.rows import FloatArray
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
    share_below,
)

# Values of a standard normal variable by the share below them.

SQRT_TWO_PI = 2.50662827463100050242
"""Root of 2 pi, whose last bit in double precision is not that of ``sqrt(2 * pi)``."""
TAIL = exp(-2)
"""Share below which a standard normal variable is in the tail, where its values follow the logarithm of the share."""
CENTRE = (
    (-59.9633501014107895267, 98.0010754185999661536, -56.6762857469070293439, 13.9312609387279679503,
     -1.23916583867381258016),
    (1.0, 1.95448858338141759834, 4.67627912898881538453, 86.3602421390890590575, -225.462687854119370527,
     200.260212380060660359, -82.0372256168333339912, 15.9056225126211695515, -1.18331621121330003142),
)  # fmt: skip
NEAR_TAIL = (
    (4.05544892305962419923, 31.5251094599893866154, 57.1628192246421288162, 44.0805073893200834700,
     14.6849561928858024014, 2.18663306850790267539, -0.140256079171354495875, -0.0350424626827848203418,
     -8.57456785154685413611e-4),
    (1.0, 15.7799883256466749731, 45.3907635128879210584, 41.3172038254672030440, 15.0425385692907503408,
     2.50464946208309415979, -0.142182922854787788574, -0.0380806407691578277194, -9.33259480895457427372e-4),
)  # fmt: skip
FAR_TAIL = (
    (3.23774891776946035970, 6.91522889068984211695, 3.93881025292474443415, 1.33303460815807542389,
     0.201485389549179081538, 0.0123716634817820021358, 3.01581553508235416007e-4, 2.65806974686737550832e-6,
     6.23974539184983293730e-9),
    (1.0, 6.02427039364742014255, 3.67983563856160859403, 1.37702099489081330271, 0.216236993594496635890,
     0.0134204006088543189037, 3.28014464682127739104e-4, 2.89247864745380683936e-6, 6.79019408009981274425e-9),
)  # fmt: skip
"""Coefficients of polynomials P and Q in descending powers, for z below and above 8: S. L. Moshier, Cephes, ndtri.c."""


def normal_quantile(shares: ArrayLike) -> FloatArray:
    """Values of a standard normal variable with given shares below them, bit for bit those of scipy's ``ndtri``.

    Importing :mod:`scipy.special` for it would take half as long as all else of a study of few variants.

    >>> normal_quantile([0, 0.5, 0.975, 1]).round(6).tolist()
    [-inf, 0.0, 1.959964, inf]
    """
    p = np.asarray(shares, dtype=float)
    is_above = p > 1 - TAIL
    share = np.where(is_above, 1 - p, p)
    # sqrt(2 pi) (c + c^3 P(c^2)/Q(c^2)) with c = p - 1/2 in the middle ...
    c = share - 0.5
    P, Q = (np.polyval(part, c * c) for part in CENTRE)
    values = np.asarray((c + c * (c * c * P / Q)) * SQRT_TWO_PI)
    # ... and, with z = sqrt(-2 ln p), -(z - ln(z)/z - P(1/z)/(z Q(1/z))) in the lower tail.
    tail = share <= TAIL
    z = np.sqrt(-2 * _logarithms(share[tail]))
    near, far = (1 / z * np.polyval(P, 1 / z) / np.polyval(Q, 1 / z) for P, Q in (NEAR_TAIL, FAR_TAIL))
    values[tail] = np.where(z < 8, near, far) - (z - _logarithms(z) / z)
    values[share == 0] = -inf
    return np.where(is_above, -values, values)


def _logarithms(values: FloatArray) -> FloatArray:
    """Natural logarithms of the C library, as last bits of numpy's depend on the processor."""
    return np.array([log(value) if value > 0 else nan for value in values.tolist()])


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
        # As an array, as the ends are, so that shares at an end are equal to the last bit.
        inside = np.clip(np.atleast_1d(np.asarray(values, dtype=float)), self.low, self.high)
        below, above = self.whole.cdf(inside), self.whole.sf(inside)
        # A difference of shares keeps its digits on the side where these are small.
        lower = np.where(below < 0.5, below - self._below[0], self._above[0] - above) / self.share
        upper = np.where(above < 0.5, above - self._above[1], self._below[1] - below) / self.share
        shape = np.shape(values)
        return np.clip(lower, 0, 1).reshape(shape), np.clip(upper, 0, 1).reshape(shape)

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


class _OfNormal(Marginal):
    """Distribution of a parameter that is a function of one standard normal variable."""

    low, high = -inf, inf

    def cdf(self, values: ArrayLike) -> FloatArray:
        return share_below(self.to_normal(values))

    def sf(self, values: ArrayLike) -> FloatArray:
        return share_below(-self.to_normal(values))

    def ppf(self, shares: ArrayLike) -> FloatArray:
        return self.from_normal(normal_quantile(shares))

    def isf(self, shares: ArrayLike) -> FloatArray:
        return self.from_normal(-normal_quantile(shares))


class NormalMarginal(_OfNormal):
    """Normal distribution of a parameter by mean and standard deviation in SI."""

    def __init__(self, mean: float, deviation: float) -> None:
        self.mean, self.deviation = mean, deviation

    def to_normal(self, values: ArrayLike) -> FloatArray:
        return (np.asarray(values, dtype=float) - self.mean) / self.deviation

    def from_normal(self, normal: ArrayLike) -> FloatArray:
        return self.mean + self.deviation * np.asarray(normal, dtype=float)

    def log_density(self, values: ArrayLike) -> FloatArray:
        return -(self.to_normal(values) ** 2) / 2 - log(2 * pi) / 2 - log(self.deviation)


@dataclass(frozen=True, kw_only=True)
class _ByMeanAndDeviation(Variation):
    """Variation by mean and deviation, with limits beyond which values are left out."""

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


@register_variation
@dataclass(frozen=True, kw_only=True)
class Normal(_ByMeanAndDeviation):
    """Normal variation of a parameter, with limits beyond which values are left out and the rest keeps its proportions.

    Mean and deviation are those before anything is left out.

    Examples
    --------
    >>> Normal(deviation="5 %", low=0).to_data()
    {'deviation': '5 %', 'low': 0}
    """

    kind: ClassVar[str] = "normal"

    def bound(self, reader: NominalReader) -> Marginal | None:
        mean = reader.value(self.mean, "mean")
        whole = NormalMarginal(mean, reader.spread(self.deviation, mean, "deviation"))
        limited = truncated_distribution(whole, self.low, self.high, reader)
        return None if reader.faults else limited


# Lognormal variation of a parameter, with values above 0 whose logarithms are normally distributed.


class LognormalMarginal(_OfNormal):
    """Lognormal distribution by mean and standard deviation of the values, in SI."""

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

    def log_density(self, values: ArrayLike) -> FloatArray:
        x = np.asarray(values, dtype=float)
        inside = np.where(x > 0, x, 1.0)
        density = -(self.to_normal(inside) ** 2) / 2 - log(2 * pi) / 2 - log(self.deviation) - np.log(inside)
        return np.where(x > 0, density, -inf)


@register_variation
@dataclass(frozen=True, kw_only=True)
class Lognormal(_ByMeanAndDeviation):
    """Lognormal variation of a parameter, by mean and deviation of the values themselves, not of their logarithms.

    With limits, values beyond them are left out and the rest keeps its proportions.

    Examples
    --------
    >>> Lognormal(mean="460 N*m/rad", deviation="10 %").to_data()
    {'mean': '460 N*m/rad', 'deviation': '10 %'}
    """

    kind: ClassVar[str] = "lognormal"

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
