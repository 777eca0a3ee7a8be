"""Variation of a parameter over a range, at equal steps or equal ratios between two ends."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from torsionnet.base.entries.spec import OneOf, entry
from torsionnet.base.errors import UNKNOWN_KEY, Fault
from torsionnet.base.expressions import Number
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.study.space.many import Many
from torsionnet.study.space.variations.nominal import NominalReader
from torsionnet.study.space.variations.uniform import HIGHEST, LOWEST
from torsionnet.study.space.variations.variation import (
    HIGHEST_VALUE,
    LOWEST_VALUE,
    GridAxis,
    Variation,
    register_variation,
)

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
            if fault.kind == UNKNOWN_KEY and fault.about in OTHER_ENDS
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
            reader.fault(f"low ({low:g}) must be below high ({high:g})", "low")
        in_ratios = self.spacing == LOG
        if in_ratios and low <= 0:
            reader.fault(f"equal ratios need values above 0, got {low:g}; take spacing: linear", "low")
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
        return np.where(indices == self.count - 1, self.high, values)
