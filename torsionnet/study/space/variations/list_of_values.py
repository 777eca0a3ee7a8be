"""Variation of a parameter over a list of given values, one after the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Number
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.study.space.variations.nominal import NominalReader
from torsionnet.study.space.variations.variation import (
    HIGHEST_VALUE,
    LOWEST_VALUE,
    GridAxis,
    ParameterValue,
    Variation,
    register_variation,
)


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
        return [] if self.values else [Fault("the list holds no value", ("values",))]

    @property
    def words(self) -> str:
        return "one value" if len(self.values) == 1 else f"{len(self.values)} values"

    def sizes(self, reader: NominalReader) -> dict[str, float]:
        values = [reader.value(one, "values", place) for place, one in enumerate(self.values)]
        return {LOWEST_VALUE: min(values), HIGHEST_VALUE: max(values)}

    def bound(self, reader: NominalReader) -> GridAxis | None:
        found = [reader.value(number, "values", index) for index, number in enumerate(self.values)]
        for index, value in enumerate(found):
            if value in found[:index]:
                reader.fault(f"{value:g} stands twice in the list", "values", index)
        return None if reader.faults else GridAxis(len(found), ValueTable(np.array(found)), min(found), max(found))


@dataclass(frozen=True, eq=False)
class ValueTable:
    """Function from indices (n,) to the values (n,) of a list in SI."""

    values: FloatArray

    def __call__(self, indices: Any) -> FloatArray:
        return np.asarray(self.values[indices])
