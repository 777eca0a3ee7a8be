"""Number of draws beyond limits, from the values of all variants, or from counts where a study has very many."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer import AskedStudy
from torsionnet.study.answers.answer_inputs import measure_of
from torsionnet.study.answers.conclusion_data import IN_WORDS
from torsionnet.study.reductions.limit_counts import LimitTotals

MOST_BINS, FEWEST_BINS = 60, 10
"""Most and fewest bins of the histogram of a limited quantity: more are narrower than a pixel, fewer show no shape."""
ROUNDING_SPREAD = 1e-9
"""Relative spread of a quantity's values below which they count as one value with rounding errors."""


@dataclass(frozen=True, eq=False)
class LimitedValues:
    """Histogram of a limited quantity in one configuration, ``edges`` (n + 1,) in SI, ``counts`` (n,), and limits."""

    configuration: str
    quantity: str
    unit: str
    edges: FloatArray
    counts: FloatArray
    below: float | None
    above: float | None
    curve: str = field(default="", metadata=IN_WORDS)
    """Name of the curve whose largest or smallest values the histogram counts, empty if the quantity is a number."""

    @property
    def constant(self) -> float | None:
        """Value in SI of the only bin with counts, if all variants have the same.

        None where they differ, or have none.
        """
        return float(self.edges[[0, -1]].mean()) if np.count_nonzero(self.counts) == 1 else None


def limited_values(study: AskedStudy, label: str, name: str, values: FloatArray) -> tuple[LimitedValues, ...]:
    """Histograms of a limited quantity, one of values (n,), or of smallest and largest values (n, 2) of a curve."""
    limit, unit = study.limits[name], measure_of(study, name).unit
    if values.ndim == 1:
        return (LimitedValues(label, name, unit, *_histogram(values), limit.below, limit.above),)
    found = []
    if limit.above is not None:
        found.append(LimitedValues(label, f"smallest {name}", unit, *_histogram(values[:, 0]), None, limit.above, name))
    if limit.below is not None:
        found.append(LimitedValues(label, f"largest {name}", unit, *_histogram(values[:, 1]), limit.below, None, name))
    return tuple(found)


def _histogram(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Histogram edges (n + 1,) and counts (n,) of the finite values between the 0.01st and 99.99th percentile."""
    known = values[np.isfinite(values)]
    ends = np.array([0.0, 1.0])
    if len(known):
        ends = np.array([np.percentile(known, 0.01, method="lower"), np.percentile(known, 99.99, method="higher")])
    size = float(np.abs(ends).max()) or 1.0
    if ends[1] - ends[0] < ROUNDING_SPREAD * size:
        ends = ends + np.array([-1, 1]) * size * 1e-3
    bins = int(np.clip(2 * np.cbrt(len(known)), FEWEST_BINS, MOST_BINS))
    counts, edges = np.histogram(known, bins, range=(float(ends[0]), float(ends[1])))
    return edges, counts.astype(float)


Weights = Mapping[str, float]
"""Mapping of each configuration to its weight in a mean over configurations."""


class DrawsBeyond(Protocol):
    """Counter of the draws that are beyond any limit of some quantities.

    One beyond at some points of a grid counts in part.
    """

    def in_case(self, names: Sequence[str], configuration: str) -> float: ...
    def in_any(self, names: Sequence[str]) -> float: ...
    def on_average(self, names: Sequence[str], weights: Weights) -> float: ...


@dataclass(frozen=True, eq=False)
class KeptBeyond:
    """Counter of draws by booleans (n_grid, n_draws) of every configuration and quantity, true beyond its limit."""

    beyond: Mapping[str, Mapping[str, NDArray[np.bool_]]]

    def in_case(self, names: Sequence[str], configuration: str) -> float:
        """Number of draws in one configuration beyond any of the limits of the quantities ``names``."""
        return _draws(self._any_limit(names, configuration))

    def in_any(self, names: Sequence[str]) -> float:
        """Number of draws beyond any of the limits of the quantities ``names`` in at least one configuration."""
        return _draws(self._each(names).any(axis=0))

    def on_average(self, names: Sequence[str], weights: Weights) -> float:
        """Weighted mean over configurations of the number of draws beyond any of the limits of ``names``."""
        shares = np.array([weights.get(case, 0.0) for case in self.beyond])
        return _draws(np.tensordot(shares / shares.sum(), self._each(names), axes=1))

    def _any_limit(self, names: Sequence[str], case: str) -> NDArray[np.bool_]:
        return np.asarray(np.any([self.beyond[case][name] for name in names], axis=0))

    def _each(self, names: Sequence[str]) -> NDArray[np.bool_]:
        return np.array([self._any_limit(names, case) for case in self.beyond])


def _draws(beyond: Any) -> float:
    """Number of draws beyond a limit, each counted by its mean over the points of the grid."""
    return float(np.asarray(beyond, dtype=float).mean(axis=0).sum())


@dataclass(frozen=True, eq=False)
class CountedBeyond:
    """Counter of draws by the number of variants beyond limits, each draw being ``n_grid`` variants."""

    totals: LimitTotals
    n_grid: int

    def in_case(self, names: Sequence[str], configuration: str) -> float:
        """Number of draws in one configuration beyond any of the limits of the quantities ``names``."""
        return self.totals.beyond(names, configuration) / self.n_grid

    def in_any(self, names: Sequence[str]) -> float:
        """Number of draws beyond any of the limits of the quantities ``names`` in at least one configuration."""
        return self.totals.beyond_in_any(names) / self.n_grid

    def on_average(self, names: Sequence[str], weights: Weights) -> float:
        """Weighted mean over configurations of the number of draws beyond any of the limits of ``names``."""
        total = sum(weight * self.in_case(names, case) for case, weight in weights.items())
        return total / sum(weights.values())
