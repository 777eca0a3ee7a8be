"""Where quantities are bounds of a search: columns of curves, and points of peaks over frequency."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.rows import FloatArray
from torsionnet.solve.responses.peaks import inner_maxima
from torsionnet.study.design.design_goals import Found
from torsionnet.study.design.design_problem import LARGE, DesignProblem

Chosen = NDArray[np.bool_]

BEGUN = 40
"""Points of a curve over frequency that are bounds from the beginning."""


def finite(values: FloatArray) -> FloatArray:
    """With a large number in place of what a design does not have."""
    return np.where(np.isfinite(values), values, LARGE)


def objective(problem: DesignProblem, found: Found) -> FloatArray:
    """Columns (n, n_columns) of which the largest is made small."""
    goals = problem.goals
    return goals.objectives[0].columns(found) if goals.objectives else goals.merit(found)[:, None]


@dataclass(frozen=True, eq=False)
class BoundedPoints:
    """Which columns of the objective and which limits are bounds, and at which points curves over frequency are."""

    columns: Chosen
    limits: Chosen
    peaks: Mapping[str, FloatArray]

    @classmethod
    def highest(cls, problem: DesignProblem, place: FloatArray) -> BoundedPoints:
        """Those that may hold at a place: local maxima, and ends."""
        found, values = problem.at(place), problem.box.inside(place)
        return cls(
            _maxima(objective(problem, found)[0], _smooth_columns(problem, found)),
            _maxima(problem.goals.excess(found)[0], _smooth_limits(problem, found)),
            {name: problem.curves[name].maxima(values) for name in (*problem.peak_objectives, *problem.peak_limits)},
        )

    def begun(self, problem: DesignProblem, place: FloatArray) -> BoundedPoints:
        """With some points all over each curve, so that a search sees it whole from its first step."""
        grids = {name: problem.curves[name].grid(problem.box.inside(place)) for name in self.peaks}
        spread = {name: grid[:: max(len(grid) // BEGUN, 1)] for name, grid in grids.items()}
        return self.joined(BoundedPoints(self.columns, self.limits, spread))

    def joined(self, more: BoundedPoints) -> BoundedPoints:
        """Those of both."""
        peaks = {name: np.union1d(points, more.peaks[name]) for name, points in self.peaks.items()}
        return BoundedPoints(self.columns | more.columns, self.limits | more.limits, peaks)


def _maxima(values: FloatArray, among: Chosen) -> Chosen:
    places, chosen = np.flatnonzero(among), np.zeros(len(values), dtype=bool)
    if len(places):
        chosen[places[[0, -1]]] = True
        chosen[places[inner_maxima(finite(values[places]))]] = True
    return chosen


def _smooth_columns(problem: DesignProblem, found: Found) -> Chosen:
    """Which columns of the objective are not those of a peak that has a curve."""
    if problem.goals.targets:
        return np.ones(1, dtype=bool)
    names = problem.goals.objectives[0].quantities
    return np.concatenate([np.full(found[name].shape[1], name not in problem.peak_objectives) for name in names])


def _smooth_limits(problem: DesignProblem, found: Found) -> Chosen:
    """The same of limits."""
    parts = [
        np.full(found[name].shape[1], not (sign > 0 and name in problem.peak_limits))
        for name, sign, _ in problem.goals.bounds()
    ]
    return np.concatenate([np.zeros(0, dtype=bool), *parts])
