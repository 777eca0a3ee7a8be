"""How the values of a quantity lie about its limits."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.answers.answer import AskedStudy
from torsionnet.study.answers.asking import measure_of
from torsionnet.study.answers.conclusion_data import IN_WORDS

MOST_BINS, FEWEST_BINS = 60, 10
ALIKE = 1e-9
"""Of themselves: values that spread less are one value, and rounding."""


@dataclass(frozen=True, eq=False)
class LimitedValues:
    """Histogram of a quantity in one configuration: ``edges`` (n + 1,) in SI, ``counts`` (n,), and the limits."""

    configuration: str
    quantity: str
    unit: str
    edges: FloatArray
    counts: FloatArray
    below: float | None
    above: float | None
    curve: str = field(default="", metadata=IN_WORDS)
    """The quantity that these are the largest or smallest values of."""

    @property
    def constant(self) -> float | None:
        """The one value that all variants have; None where they differ, or have none."""
        return float(self.edges[[0, -1]].mean()) if np.count_nonzero(self.counts) == 1 else None


def limited_values(study: AskedStudy, label: str, name: str, values: FloatArray) -> tuple[LimitedValues, ...]:
    """Of values (n,), or for each limit of a curve of its smallest or largest ones, which are given as (n, 2)."""
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
    """Edges and counts of values that are there; of many without those beyond the 0.01st and 99.99th percentile."""
    known = values[np.isfinite(values)]
    ends = np.array([0.0, 1.0])
    if len(known):
        ends = np.array([np.percentile(known, 0.01, method="lower"), np.percentile(known, 99.99, method="higher")])
    size = float(np.abs(ends).max()) or 1.0
    if ends[1] - ends[0] < ALIKE * size:
        ends = ends + np.array([-1, 1]) * size * 1e-3
    bins = int(np.clip(2 * np.cbrt(len(known)), FEWEST_BINS, MOST_BINS))
    counts, edges = np.histogram(known, bins, range=(float(ends[0]), float(ends[1])))
    return edges, counts.astype(float)
