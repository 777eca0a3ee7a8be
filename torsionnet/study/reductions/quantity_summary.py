"""Statistics of a quantity over all variants of one configuration, as numbers and for JSON."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, TypeAlias

from numpy.typing import ArrayLike

from torsionnet.base.entries.spec import Schema
from torsionnet.base.result_rows import NUMBER, NUMBER_ROWS, NUMBERS, Out
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.quantity import QuantityForm
from torsionnet.study.reductions.histogram import Histogram
from torsionnet.study.reductions.moments import Moments

OVER: Schema = {"enum": ["frequency", "speed"]}
"""JSON Schema of what a curve runs over, frequency or speed."""
NUMBER_OR_CURVE: Schema = {"anyOf": [NUMBER, NUMBERS], "description": "of a curve one for each point"}
"""JSON Schema of a statistic of a quantity, a number, or an array with one for each point of a curve."""
OverPoints: TypeAlias = Annotated[Any, Out(schema=NUMBER_OR_CURVE)]
"""Type of a statistic of a quantity, a number, or (n_points,) for a curve."""


@dataclass(frozen=True, eq=False)
class QuantityRow:
    """Statistics in SI of a quantity over all variants of one configuration, as they are written to JSON."""

    quantity: str
    configuration: str
    unit: str
    over: Annotated[str | None, Out(optional=True, schema=OVER)]
    points: Annotated[FloatArray | None, Out(optional=True, schema=NUMBERS)]
    variants: OverPoints
    mean: OverPoints
    standard_deviation: OverPoints
    smallest: OverPoints
    smallest_at: OverPoints
    largest: OverPoints
    largest_at: OverPoints
    percentiles: Annotated[Any, Out(schema={"anyOf": [NUMBERS, NUMBER_ROWS]})]


@dataclass(frozen=True, eq=False)
class Summary:
    """Statistics of a quantity over all variants of one configuration, ``measure`` being its unit and points."""

    measure: QuantityForm
    moments: Moments
    histogram: Histogram

    def percentiles(self, shares: ArrayLike) -> FloatArray:
        """Percentiles (n_shares, n_points) in SI at shares in per cent, within 0.2 % of themselves."""
        return self.histogram.percentiles(shares, len(self.measure.points))

    def row(self, name: str, configuration: str, percentiles: FloatArray) -> QuantityRow:
        """Statistics of the quantity in SI as plain data for JSON, with percentiles (n_shares, n_points)."""
        moments, is_curve = self.moments, self.measure.is_curve

        def shown(array: Any) -> Any:
            return array if is_curve else array[0]

        return QuantityRow(
            name, configuration, self.measure.unit,
            self.measure.over if is_curve else None, self.measure.points if is_curve else None,
            shown(moments.count), shown(moments.mean), shown(moments.deviation), shown(moments.smallest),
            shown(moments.smallest_at), shown(moments.largest), shown(moments.largest_at),
            percentiles if is_curve else percentiles[:, 0],
        )  # fmt: skip
