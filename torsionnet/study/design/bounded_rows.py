"""Objective and constraints of a design's nonlinear programme, made of quantities and points of their curves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.responses.peaks import inner_maxima
from torsionnet.study.design.design_goals import Found
from torsionnet.study.design.design_problem import MISSING_VALUE, DesignProblem

Chosen = NDArray[np.bool_]

INITIAL_CURVE_POINTS = 40
"""Points of a curve over frequency that are constraints from the beginning, as with fewer a search may miss a peak."""


def finite(values: FloatArray) -> FloatArray:
    """Values of quantities with a large number in place of missing ones."""
    return np.where(np.isfinite(values), values, MISSING_VALUE)


def objective(problem: DesignProblem, found: Found) -> FloatArray:
    """Columns (n, n_columns) of the objective of n designs, the largest of which is minimised."""
    goals = problem.goals
    return goals.objectives[0].columns(found) if goals.objectives else goals.merit(found)[:, None]


@dataclass(frozen=True, eq=False)
class BoundedPoints:
    """Columns of the objective, limits, and points of curves over frequency, active in a nonlinear programme."""

    columns: Chosen
    limits: Chosen
    peaks: Mapping[str, FloatArray]

    @classmethod
    def highest(cls, problem: DesignProblem, place: FloatArray) -> BoundedPoints:
        """Objective columns, limits and curve points that are local maxima or ends at one point of the unit cube."""
        found, values = problem.at(place), problem.box.inside(place)
        return cls(
            _maxima(objective(problem, found)[0], _smooth_columns(problem, found)),
            _maxima(problem.goals.excess(found)[0], _smooth_limits(problem, found)),
            {name: problem.curves[name].maxima(values) for name in (*problem.peak_objectives, *problem.peak_limits)},
        )

    def with_curve_points(self, problem: DesignProblem, place: FloatArray) -> BoundedPoints:
        """Active points together with some all over each curve, so that a search sees all of it from its first step."""
        grids = {name: problem.curves[name].grid(problem.box.inside(place)) for name in self.peaks}
        spread = {name: grid[:: max(len(grid) // INITIAL_CURVE_POINTS, 1)] for name, grid in grids.items()}
        return self.joined(BoundedPoints(self.columns, self.limits, spread))

    def joined(self, more: BoundedPoints) -> BoundedPoints:
        """Active columns, limits and points of curves together with those of another place in the unit cube."""
        peaks = {name: np.union1d(points, more.peaks[name]) for name, points in self.peaks.items()}
        return BoundedPoints(self.columns | more.columns, self.limits | more.limits, peaks)


def _maxima(values: FloatArray, among: Chosen) -> Chosen:
    places, chosen = np.flatnonzero(among), np.zeros(len(values), dtype=bool)
    if len(places):
        chosen[places[[0, -1]]] = True
        chosen[places[inner_maxima(finite(values[places]))]] = True
    return chosen


def _smooth_columns(problem: DesignProblem, found: Found) -> Chosen:
    """Whether each column of the objective, (n_columns,), is not a peak with a curve that replaces its kinks."""
    if problem.goals.targets:
        return np.ones(1, dtype=bool)
    names = problem.goals.objectives[0].quantities
    return np.concatenate([np.full(found[name].shape[1], name not in problem.peak_objectives) for name in names])


def _smooth_limits(problem: DesignProblem, found: Found) -> Chosen:
    """Whether each limit, (n_limits,), is not that of a peak with a curve."""
    parts = [
        np.full(found[name].shape[1], not (sign > 0 and name in problem.peak_limits))
        for name, sign, _ in problem.goals.bounds()
    ]
    return np.concatenate([np.zeros(0, dtype=bool), *parts])


TINY_LEVEL = 1e-300
"""Level added before logarithms and divisions, so that a level of 0 stays finite."""


def _objective_slopes(problem: DesignProblem, found: Found, moved: Found) -> FloatArray:
    goals = problem.goals
    if goals.objectives:
        return goals.objectives[0].sign * np.concatenate([moved[name] for name in goals.objectives[0].quantities])
    deviations = goals.deviations(found)[0]
    slopes = np.concatenate([one.scale * moved[one.quantity] for one in goals.targets])
    return np.asarray(2 * deviations[None, :] @ slopes)


@dataclass(frozen=True, eq=False)
class BoundedRows:
    """Active objectives and limits as rows at a place of the unit cube, with derivatives.

    Peaks that alone are made small are rows by their logarithms, as are peaks against their limits: a level that
    grows without bound where damping ends is nearly straight so.
    """

    problem: DesignProblem
    chosen: BoundedPoints
    start: FloatArray
    _known: dict[bytes, Found] = field(default_factory=dict)
    _moved: dict[bytes, Found] = field(default_factory=dict)
    _heights: dict[tuple[str, bytes], FloatArray] = field(default_factory=dict)

    @property
    def is_limited(self) -> bool:
        return bool(self.chosen.limits.any() or self.problem.peak_limits)

    @cached_property
    def _in_logs(self) -> bool:
        return not self.chosen.columns.any()

    @cached_property
    def _scale(self) -> float:
        return float(np.abs(finite(objective(self.problem, self._at(self.start))[0])).max()) or 1.0

    def sizes(self, place: FloatArray) -> FloatArray:
        """Objective rows (n,) at a place of the unit cube, the largest of which is minimised."""
        parts = [self._scaled(self._levels(name, place)) for name in self.problem.peak_objectives]
        if self.chosen.columns.any():
            columns = objective(self.problem, self._at(place))[0, self.chosen.columns]
            parts.append(finite(columns / self._scale))
        return np.concatenate(parts)

    def size_slopes(self, place: FloatArray) -> FloatArray:
        """Derivatives (n, n_p) of :meth:`sizes` to the n_p coordinates of the unit cube."""
        parts = [
            self._slopes(name, place)
            / (self._levels(name, place)[:, None] + TINY_LEVEL if self._in_logs else self._scale)
            for name in self.problem.peak_objectives
        ]
        if self.chosen.columns.any():
            slopes = _objective_slopes(self.problem, self._at(place), self.at(place))
            parts.append(slopes[self.chosen.columns] / self._scale)
        return np.concatenate(parts)

    def excess(self, place: FloatArray) -> FloatArray:
        """Rows (n,) of the limits at a place of the unit cube, each of which must stay below 0."""
        parts = [
            np.log((self._levels(name, place) + TINY_LEVEL) / bound) for name, bound in self.problem.peak_limits.items()
        ]
        if self.chosen.limits.any():
            parts.append(finite(self.problem.goals.excess(self._at(place))[0, self.chosen.limits]))
        return np.concatenate([np.zeros(0), *parts])

    def excess_slopes(self, place: FloatArray) -> FloatArray:
        """Derivatives (n, n_p) of :meth:`excess` to the n_p coordinates of the unit cube."""
        parts = [
            self._slopes(name, place) / (self._levels(name, place)[:, None] + TINY_LEVEL)
            for name in self.problem.peak_limits
        ]
        if self.chosen.limits.any():
            parts.append(self.problem.goals.excess_slopes(self.at(place))[self.chosen.limits])
        return np.concatenate([np.zeros((0, len(place))), *parts])

    def include(self, highest: BoundedPoints, place: FloatArray) -> bool:
        """Whether the active rows include the highest ones at a place of the unit cube."""
        new = (highest.columns & ~self.chosen.columns).any() or (highest.limits & ~self.chosen.limits).any()
        return not new and not any(self._surpassed(name, points, place) for name, points in highest.peaks.items())

    def _surpassed(self, name: str, points: FloatArray, place: FloatArray) -> bool:
        curve = self.problem.curves[name]
        top = curve.at(self.problem.box.inside(place), points).max()
        return bool(top > self._levels(name, place).max() * (1 + curve.precision))

    def _scaled(self, levels: FloatArray) -> FloatArray:
        return np.log(levels + TINY_LEVEL) if self._in_logs else levels / self._scale

    def _levels(self, name: str, place: FloatArray) -> FloatArray:
        key = (name, place.tobytes())
        if key not in self._heights:
            values = self.problem.box.inside(place)
            self._heights[key] = self.problem.curves[name].at(values, self.chosen.peaks[name])
        return self._heights[key]

    def _slopes(self, name: str, place: FloatArray) -> FloatArray:
        values, points = self.problem.box.inside(place), self.chosen.peaks[name]
        return np.asarray(self.problem.curves[name].slopes(values, points) * self.problem.box.rates(place))

    def _at(self, place: FloatArray) -> Found:
        key = place.tobytes()
        if key not in self._known:
            self._known[key] = self.problem.at(place)
        return self._known[key]

    def at(self, place: FloatArray) -> Found:
        key = place.tobytes()
        if key not in self._moved:
            self._moved[key] = self.problem.jacobian(place)
        return self._moved[key]
