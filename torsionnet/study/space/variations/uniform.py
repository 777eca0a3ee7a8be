"""Uniform variation of a parameter, with values between two limits, all equally likely."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.entries.spec import entry
from torsionnet.base.expressions import Number
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.study.space.variations.nominal import NominalReader
from torsionnet.study.space.variations.variation import (
    HIGHEST_VALUE,
    LOWEST_VALUE,
    Marginal,
    ParameterValue,
    Variation,
    register_variation,
)

LOWEST = ParameterValue("lowest value; -10 % is relative to the value in the model")
HIGHEST = ParameterValue("highest value; +10 % is relative to the value in the model")


class UniformMarginal(Marginal):
    """Uniform distribution of a parameter by lowest and highest value in SI."""

    def __init__(self, low: float, high: float) -> None:
        self.low, self.high = low, high

    def cdf(self, values: ArrayLike) -> FloatArray:
        return np.clip((np.asarray(values, dtype=float) - self.low) / (self.high - self.low), 0, 1)

    def sf(self, values: ArrayLike) -> FloatArray:
        return np.clip((self.high - np.asarray(values, dtype=float)) / (self.high - self.low), 0, 1)

    def ppf(self, shares: ArrayLike) -> FloatArray:
        return self._inside(self.low + (self.high - self.low) * np.asarray(shares, dtype=float))

    def isf(self, shares: ArrayLike) -> FloatArray:
        return self._inside(self.high - (self.high - self.low) * np.asarray(shares, dtype=float))

    def _inside(self, values: FloatArray) -> FloatArray:
        """Values in SI clipped to the limits, beyond which rounding must not lead."""
        return np.clip(values, self.low, self.high)

    def log_density(self, values: ArrayLike) -> FloatArray:
        x = np.asarray(values, dtype=float)
        return np.where((x >= self.low) & (x <= self.high), -np.log(self.high - self.low), -np.inf)


@register_variation
@dataclass(frozen=True, kw_only=True)
class Uniform(Variation):
    """Uniform variation of a parameter, by lowest and highest value.

    Examples
    --------
    >>> Uniform(low="-10 %", high="+10 %").to_data()
    {'low': '-10 %', 'high': '+10 %'}
    """

    kind: ClassVar[str] = "uniform"

    low: Number = entry(LOWEST)
    high: Number = entry(HIGHEST)

    def sizes(self, reader: NominalReader) -> dict[str, float]:
        return {LOWEST_VALUE: reader.value(self.low, "low"), HIGHEST_VALUE: reader.value(self.high, "high")}

    def bound(self, reader: NominalReader) -> Marginal | None:
        low, high = reader.value(self.low, "low"), reader.value(self.high, "high")
        if low >= high:
            reader.fault(f"low ({low:g}) must be below high ({high:g})", "low")
        return None if reader.faults else UniformMarginal(low, high)
