"""How the values of a quantity lie about its limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.answer import AskedStudy
from torsionnet.study.answers.asking import measure_of

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


def limited_values(study: AskedStudy, label: str, name: str, values: FloatArray) -> tuple[LimitedValues, ...]:
    """Of values (n,), or for each limit of a curve of its smallest or largest ones, which are given as (n, 2)."""
    limit, unit = study.limits[name], measure_of(study, name).unit
    if values.ndim == 1:
        return (LimitedValues(label, name, unit, *_histogram(values), limit.below, limit.above),)
    found = []
    if limit.above is not None:
        found.append(LimitedValues(label, f"smallest {name}", unit, *_histogram(values[:, 0]), None, limit.above))
    if limit.below is not None:
        found.append(LimitedValues(label, f"largest {name}", unit, *_histogram(values[:, 1]), limit.below, None))
    return tuple(found)


def _histogram(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Edges and counts of the values that are there, without those beyond the 0.01st and 99.99th percentile."""
    known = values[np.isfinite(values)]
    ends = np.percentile(known, [0.01, 99.99]) if len(known) else np.array([0.0, 1.0])
    size = float(np.abs(ends).max()) or 1.0
    if ends[1] - ends[0] < ALIKE * size:
        ends = ends + np.array([-1, 1]) * size * 1e-3
    bins = int(np.clip(2 * np.cbrt(len(known)), FEWEST_BINS, MOST_BINS))
    counts, edges = np.histogram(known, bins, range=(float(ends[0]), float(ends[1])))
    return edges, counts.astype(float)
