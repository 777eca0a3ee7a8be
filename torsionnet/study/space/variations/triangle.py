"""Triangular variation of a parameter, between two limits with a most frequent value."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.entries.spec import entry
from torsionnet.base.expressions import Number
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.study.space.variations.nominal import NominalReader
from torsionnet.study.space.variations.uniform import HIGHEST, LOWEST
from torsionnet.study.space.variations.variation import (
    HIGHEST_VALUE,
    LOWEST_VALUE,
    MOST_FREQUENT,
    Marginal,
    ParameterValue,
    Variation,
    register_variation,
)


class TriangularMarginal(Marginal):
    """Triangular distribution of a parameter by lowest, most frequent and highest value in SI."""

    def __init__(self, low: float, mode: float, high: float) -> None:
        self.low, self.mode, self.high = low, mode, high
        self._rising, self._falling = (high - low) * (mode - low), (high - low) * (high - mode)
        self._share = (mode - low) / (high - low)

    def cdf(self, values: ArrayLike) -> FloatArray:
        return self._shares(values)[0]

    def sf(self, values: ArrayLike) -> FloatArray:
        return self._shares(values)[1]

    def _shares(self, values: ArrayLike) -> tuple[FloatArray, FloatArray]:
        x = np.clip(np.asarray(values, dtype=float), self.low, self.high)
        # One of the sides may have no width; nothing lies on it then.
        below = (x - self.low) ** 2 / (self._rising or 1.0)
        above = (self.high - x) ** 2 / (self._falling or 1.0)
        rises = x < self.mode if self._falling else np.ones_like(x, dtype=bool)
        return np.where(rises, below, 1 - above), np.where(rises, 1 - below, above)

    def ppf(self, shares: ArrayLike) -> FloatArray:
        p = np.asarray(shares, dtype=float)
        return self._at(p, 1 - p)

    def isf(self, shares: ArrayLike) -> FloatArray:
        p = np.asarray(shares, dtype=float)
        return self._at(1 - p, p)

    def _at(self, below: FloatArray, above: FloatArray) -> FloatArray:
        rising = self.low + np.sqrt(below * self._rising)
        falling = self.high - np.sqrt(above * self._falling)
        return np.clip(np.where(below < self._share, rising, falling), self.low, self.high)

    def log_density(self, values: ArrayLike) -> FloatArray:
        x = np.asarray(values, dtype=float)
        rising, falling = x - self.low, self.high - x
        side = np.where((x < self.mode) | (self._falling == 0), rising / (self._rising or 1.0), 1.0)
        side = np.where((x >= self.mode) & (self._falling > 0), falling / (self._falling or 1.0), side)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where((rising >= 0) & (falling >= 0), np.log(2 * side), -np.inf)


@register_variation
@dataclass(frozen=True, kw_only=True)
class Triangular(Variation):
    """Triangular variation of a parameter, by lowest, most frequent and highest value.

    Examples
    --------
    >>> Triangular(low="-20 %", high="+5 %").to_data()
    {'low': '-20 %', 'high': '+5 %'}
    """

    kind: ClassVar[str] = "triangular"

    low: Number = entry(LOWEST)
    mode: Number | None = entry(ParameterValue("most frequent value; by default the value in the model"), None)
    high: Number = entry(HIGHEST)

    def sizes(self, reader: NominalReader) -> dict[str, float]:
        ends = {LOWEST_VALUE: reader.value(self.low, "low"), HIGHEST_VALUE: reader.value(self.high, "high")}
        return ends | {MOST_FREQUENT: reader.value(self.mode, "mode")}

    def bound(self, reader: NominalReader) -> Marginal | None:
        low, high = reader.value(self.low, "low"), reader.value(self.high, "high")
        mode = reader.value(self.mode, "mode")
        if low >= high:
            reader.fault(f"low ({low:g}) must be below high ({high:g})", "low")
        elif mode < low or mode > high:
            text = f"the most frequent value ({mode:g}) must lie between low ({low:g}) and high ({high:g})"
            if self.mode is None:
                text += "; it is the value in the model where mode: is not given"
            reader.fault(text, *(() if self.mode is None else ("mode",)))
        return None if reader.faults else TriangularMarginal(low, mode, high)
