"""Statistics of a quantity over all variants of one configuration."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.entries.spec import Json
from torsionnet.study.quantities.quantity import QuantityForm
from torsionnet.study.reductions.histogram import Histogram
from torsionnet.study.reductions.moments import Moments


@dataclass(frozen=True, eq=False)
class Summary:
    """Statistics of a quantity in one configuration: ``measure`` (unit, points), ``moments``, ``histogram``."""

    measure: QuantityForm
    moments: Moments
    histogram: Histogram

    def percentiles(self, shares: ArrayLike) -> FloatArray:
        """Percentiles (n_shares, n_points) at shares in per cent, within 0.2 % of themselves."""
        return self.histogram.percentiles(shares, len(self.measure.points))

    def to_data(self, percentiles: FloatArray) -> dict[str, Json]:
        """Statistics as JSON data in full precision, with percentiles (n_shares, n_points)."""
        moments, is_curve = self.moments, self.measure.is_curve
        known = {
            "variants": moments.count,
            "mean": moments.mean,
            "standard_deviation": moments.deviation,
            "smallest": moments.smallest,
            "smallest_at": moments.smallest_at,
            "largest": moments.largest,
            "largest_at": moments.largest_at,
        }
        said = {key: array.tolist() if is_curve else array.tolist()[0] for key, array in known.items()}
        said["percentiles"] = percentiles.tolist() if is_curve else percentiles[:, 0].tolist()
        points = {"over": self.measure.over, "points": self.measure.points.tolist()} if is_curve else {}
        return {"unit": self.measure.unit, **points, **said}
