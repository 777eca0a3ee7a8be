"""Uniform variation of a parameter, with values between two limits, all equally likely."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.spec import OneOf, entry
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Number
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.study.space.samples import Many
from torsionnet.study.space.variations.variation import (
    HIGHEST_VALUE,
    LOWEST_VALUE,
    MOST_FREQUENT,
    GridAxis,
    Marginal,
    NominalReader,
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
            reader.fault(f"low ({low:g}) must be below high ({high:g})", "low", kind="unordered-rows")
        return None if reader.faults else UniformMarginal(low, high)


# Triangular variation of a parameter, between two limits with a most frequent value.


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
        # f = 2 (x - a)/((b - a)(c - a)) from the low end a to the mode c, and likewise from the high end b.
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
            reader.fault(f"low ({low:g}) must be below high ({high:g})", "low", kind="unordered-rows")
        elif mode < low or mode > high:
            text = f"the most frequent value ({mode:g}) must lie between low ({low:g}) and high ({high:g})"
            if self.mode is None:
                text += "; it is the value in the model where mode: is not given"
            reader.fault(text, *(() if self.mode is None else ("mode",)), kind="out-of-range")
        return None if reader.faults else TriangularMarginal(low, mode, high)


# Variation of a parameter over a range, at equal steps or equal ratios between two ends.

LOG = "log"
OTHER_ENDS = ("from", "to", "start", "stop")
"""Keys that other tools use for the ends of a range, which are refused with the right names."""


@register_variation
@dataclass(frozen=True, kw_only=True)
class ValueRange(Variation):
    """Variation of a parameter from the lowest to the highest value, both included, crossed with whatever else varies.

    Examples
    --------
    >>> ValueRange(low="1 mm", high="3 mm", count=20).to_data()
    {'low': '1 mm', 'high': '3 mm', 'count': 20}
    """

    kind: ClassVar[str] = "range"
    is_random: ClassVar[bool] = False

    low: Number = entry(LOWEST)
    high: Number = entry(HIGHEST)
    count: int = entry(Many("number of values", lower=2, upper=10**9))
    spacing: str = entry(OneOf("equal steps, or equal ratios of one value to the next", ("linear", LOG)), "linear")

    @classmethod
    def key_faults(cls, raw: Mapping[Any, Any], name: str = "") -> list[Fault]:
        return [
            replace(fault, message=f'unknown key "{fault.about}"; the ends of a range are low and high')
            if fault.kind == "unknown-entry" and fault.about in OTHER_ENDS
            else fault
            for fault in super().key_faults(raw, name)
        ]

    @property
    def words(self) -> str:
        return f"{self.count} values at equal {'ratios' if self.spacing == LOG else 'steps'}"

    def sizes(self, reader: NominalReader) -> dict[str, float]:
        return {LOWEST_VALUE: reader.value(self.low, "low"), HIGHEST_VALUE: reader.value(self.high, "high")}

    def bound(self, reader: NominalReader) -> GridAxis | None:
        low, high = reader.value(self.low, "low"), reader.value(self.high, "high")
        if low >= high:
            reader.fault(f"low ({low:g}) must be below high ({high:g})", "low", kind="unordered-rows")
        in_ratios = self.spacing == LOG
        if in_ratios and low <= 0:
            reader.fault(
                f"equal ratios need values above 0, got {low:g}; take spacing: linear", "low", kind="out-of-range"
            )
        return None if reader.faults else GridAxis(self.count, Steps(low, high, self.count, in_ratios), low, high)


@dataclass(frozen=True)
class Steps:
    """Function from indices (n,) to values (n,) in SI at equal steps or ratios between two ends.

    Both ends are exact.
    """

    low: float
    high: float
    count: int
    in_ratios: bool

    def __call__(self, indices: Any) -> FloatArray:
        share = np.asarray(indices) / (self.count - 1)
        if self.in_ratios:
            values = self.low * (self.high / self.low) ** share
        else:
            values = self.low * (1 - share) + self.high * share
        # The end is as given, without rounding.
        return np.where(indices == self.count - 1, self.high, values)


# Variation of a parameter over a list of given values, one after the other.


@register_variation
@dataclass(frozen=True, kw_only=True)
class ListOfValues(Variation):
    """Variation of a parameter over a list of values, each crossed with whatever else varies.

    Examples
    --------
    >>> ListOfValues(values=["-10 %", "0 %", "+10 %"]).to_data()
    {'values': ['-10 %', '0 %', '+10 %']}
    """

    kind: ClassVar[str] = "list"
    is_random: ClassVar[bool] = False

    values: tuple[Number, ...] = entry(Listed("the values", ParameterValue("a value"), form="a list of values"))

    def contradictions(self) -> list[Fault]:
        return [] if self.values else [Fault("the list holds no value", ("values",), kind="missing-entry")]

    @property
    def words(self) -> str:
        return "one value" if len(self.values) == 1 else f"{len(self.values)} values"

    def sizes(self, reader: NominalReader) -> dict[str, float]:
        values = [reader.value(number, "values", place) for place, number in enumerate(self.values)]
        return {LOWEST_VALUE: min(values), HIGHEST_VALUE: max(values)}

    def bound(self, reader: NominalReader) -> GridAxis | None:
        numbers = [reader.value(number, "values", index) for index, number in enumerate(self.values)]
        for index, value in enumerate(numbers):
            if value in numbers[:index]:
                reader.fault(f"{value:g} stands twice in the list", "values", index, kind="repeated-name")
        if reader.faults:
            return None
        return GridAxis(len(numbers), ValueTable(np.array(numbers)), min(numbers), max(numbers))


@dataclass(frozen=True, eq=False)
class ValueTable:
    """Function from indices (n,) to the values (n,) of a list in SI."""

    values: FloatArray

    def __call__(self, indices: Any) -> FloatArray:
        return np.asarray(self.values[indices])
