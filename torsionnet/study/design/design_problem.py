"""Design problem in the unit cube of its parameters, with goals, quantities and their derivatives."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.responses.grid import inner_maxima
from torsionnet.machinery.design.damper_optimum import DesignParameter
from torsionnet.machinery.design.level_minimax import Box, Levels
from torsionnet.study.design.design_goals import DesignGoals, Found

Evaluate = Callable[[Mapping[str, FloatArray]], Mapping[str, FloatArray]]
"""Function from parameters (n,) by name to quantities (n,) or (n, n_points) by name, all in SI; NaN where missing."""
Slopes = Callable[[Mapping[str, float]], Mapping[str, FloatArray]]
"""Function from the value of every parameter to exact derivatives (n_points, n_p) in SI of some quantities."""

SLOPE_STEP = 1e-3
"""Step in the unit cube between the five points of a numerical derivative, with 1e-12 error for a smooth function."""
FEASIBLE_EXCESS = 1e-9
"""Largest excess over limits, relative to them, that counts as rounding and not as a violation."""
MISSING_VALUE = 1e6
"""Number in place of a quantity that a design does not have, which must be worse than any real value."""
STENCIL = np.arange(5) - 2.0
"""Positions of the five points of a numerical derivative around its middle, in steps of :data:`SLOPE_STEP`."""


Rank = tuple[float, float]
"""Rank of a design, the violation of limits, then the merit, of which smaller ones are better."""


@dataclass(frozen=True, eq=False)
class DesignProblem:
    """Design problem with goals over the unit cube of its parameters, positive ones on a logarithmic scale.

    Attributes
    ----------
    parameters : tuple of DesignParameter
        Parameters with bounds; their ``value`` is not used.
    goals : DesignGoals
    evaluate : Evaluate
        Quantities of many designs at once.
    slopes : Slopes, optional
        Exact derivatives of some quantities; the others are numerical.
    curves : mapping
        Quantity that is a largest peak -> its curve over frequency, smooth where another peak becomes the largest.
    """

    parameters: tuple[DesignParameter, ...]
    goals: DesignGoals
    evaluate: Evaluate
    slopes: Slopes | None = None
    curves: Mapping[str, Levels] = field(default_factory=dict)
    _asked: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        if not self.parameters:
            raise UsageError("say which parameters may change", kind="missing-entry")
        for parameter in self.parameters:
            low, high = parameter.lower, parameter.upper
            if not (np.isfinite([low, high]).all() and low < high):
                raise UsageError(
                    f"{parameter.name}: bounds are a lower and a higher value, got {low:g} and {high:g}",
                    kind="unordered-rows",
                )

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(parameter.name for parameter in self.parameters)

    @property
    def peak_objectives(self) -> tuple[str, ...]:
        """Names of the minimised quantities that have a curve over frequency."""
        sought = [name for goal in self.goals.objectives[:1] if goal.sign > 0 for name in goal.quantities]
        return tuple(name for name in sought if name in self.curves)

    @property
    def peak_limits(self) -> dict[str, float]:
        """Upper limit in SI of each limited quantity that has a curve over frequency, by its name."""
        below = {name: limit.below for name, limit in self.goals.limits.items() if name in self.curves}
        return {name: bound for name, bound in below.items() if bound is not None and bound > 0}

    @property
    def evaluations(self) -> int:
        """Number of designs whose quantities were calculated so far."""
        return sum(self._asked)

    @cached_property
    def box(self) -> Box:
        return Box(np.array([p.lower for p in self.parameters]), np.array([p.upper for p in self.parameters]))

    @cached_property
    def start(self) -> FloatArray:
        """Point of the unit cube (n_p,) of the given design, where the search begins."""
        return self.box.place(np.array([parameter.start for parameter in self.parameters]))

    def values(self, place: FloatArray) -> dict[str, float]:
        """Value in SI of each parameter at one point of the unit cube, by its name."""
        return dict(zip(self.names, map(float, self.box.inside(np.asarray(place))), strict=True))

    def at(self, places: FloatArray) -> Found:
        """Values (n, n_points) in SI of each quantity, by its name, at points (n, n_p) of the unit cube."""
        inside = self.box.inside(np.atleast_2d(places))
        self._asked.append(len(inside))
        values = self.evaluate({name: inside[:, index] for index, name in enumerate(self.names)})
        self.goals.check(values)
        return {name: np.asarray(values[name], float).reshape(len(inside), -1) for name in self.goals.quantities}

    def ranks(self, values: Found) -> list[Rank]:
        """Rank of each of n designs, its violation of limits, then its merit."""
        over, merit = self.goals.violation(values), self.goals.merit(values)
        return [(0.0 if v <= FEASIBLE_EXCESS else v, m) for v, m in zip(over.tolist(), merit.tolist(), strict=True)]

    def jacobian(self, place: FloatArray) -> Found:
        """Derivatives (n_points, n_p) of each quantity, by its name, to the coordinates of the unit cube at a point.

        0 where they do not exist.
        """
        exact = {} if self.slopes is None else self.slopes(self.values(place))
        # Chain rule: slopes in SI times the slope of the value over its coordinate, logarithmic or not.
        rates = self.box.rates(place)
        known = {
            name: np.atleast_2d(slope) * rates for name, slope in exact.items() if np.isfinite(np.asarray(slope)).all()
        }
        missing = [name for name in self.goals.quantities if name not in known]
        return {**known, **(self._differences(place, missing) if missing else {})}

    def _differences(self, place: FloatArray, names: Sequence[str]) -> Found:
        """Numerical derivatives of quantities from five points along every parameter, moved inward at bounds."""
        size = len(place)
        centre = np.clip(place, -SLOPE_STEP * STENCIL[0], 1 - SLOPE_STEP * STENCIL[-1])
        points = np.repeat(np.asarray(place, float)[None, None, :], size * len(STENCIL), axis=0).reshape(size, -1, size)
        for index in range(size):
            points[index, :, index] = centre[index] + SLOPE_STEP * STENCIL
        values = self.at(points.reshape(-1, size))
        # Weights of the five points for a slope at the place, which near a bound is not their middle.
        weights = np.array([_weights((place[i] - centre[i]) / SLOPE_STEP) for i in range(size)]) / SLOPE_STEP
        slopes = {
            name: np.einsum("pk,pkm->mp", weights, values[name].reshape(size, len(STENCIL), -1)) for name in names
        }
        return {name: np.where(np.isfinite(slope), slope, 0.0) for name, slope in slopes.items()}


def _weights(at: float) -> FloatArray:
    """Weights (5,) of values at five points that give the derivative of their polynomial at a point.

    >>> (12 * _weights(1.0)).round(9).tolist()
    [-1.0, 6.0, -18.0, 10.0, 3.0]
    """
    # sum w_i x_i^n = n at^(n - 1) for n from 0 to 4: exact for the polynomial through the five points.
    powers = np.arange(len(STENCIL))
    with np.errstate(divide="ignore", invalid="ignore"):
        wanted = np.where(powers > 0, powers * float(at) ** np.maximum(powers - 1, 0), 0.0)
    return np.linalg.solve(STENCIL[None, :] ** powers[:, None], wanted)


# Objective and constraints of a design's nonlinear programme, made of quantities and points of their curves.

Chosen = NDArray[np.bool_]

INITIAL_CURVE_POINTS = 40
"""Points of a curve over frequency that are constraints from the beginning, as with fewer a search may miss a peak."""


def finite(values: FloatArray) -> FloatArray:
    """Values of quantities with a large number in place of missing ones."""
    return np.where(np.isfinite(values), values, MISSING_VALUE)


def objective(problem: DesignProblem, values: Found) -> FloatArray:
    """Columns (n, n_columns) of the objective of n designs, the largest of which is minimised."""
    goals = problem.goals
    return goals.objectives[0].columns(values) if goals.objectives else goals.merit(values)[:, None]


@dataclass(frozen=True, eq=False)
class BoundedPoints:
    """Columns of the objective, limits, and points of curves over frequency, active in a nonlinear programme."""

    columns: Chosen
    limits: Chosen
    peaks: Mapping[str, FloatArray]

    @classmethod
    def highest(cls, problem: DesignProblem, place: FloatArray) -> BoundedPoints:
        """Objective columns, limits and curve points that are local maxima or ends at one point of the unit cube."""
        quantities, values = problem.at(place), problem.box.inside(place)
        return cls(
            _maxima(objective(problem, quantities)[0], _smooth_columns(problem, quantities)),
            _maxima(problem.goals.excess(quantities)[0], _smooth_limits(problem, quantities)),
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
        # An end may be the highest point without being a maximum inside.
        chosen[places[[0, -1]]] = True
        chosen[places[inner_maxima(finite(values[places]))]] = True
    return chosen


def _smooth_columns(problem: DesignProblem, values: Found) -> Chosen:
    """Whether each column of the objective, (n_columns,), is not a peak with a curve that replaces its kinks."""
    if problem.goals.targets:
        return np.ones(1, dtype=bool)
    names = problem.goals.objectives[0].quantities
    return np.concatenate([np.full(values[name].shape[1], name not in problem.peak_objectives) for name in names])


def _smooth_limits(problem: DesignProblem, values: Found) -> Chosen:
    """Whether each limit, (n_limits,), is not that of a peak with a curve."""
    parts = [
        np.full(values[name].shape[1], not (sign > 0 and name in problem.peak_limits))
        for name, sign, _ in problem.goals.bounds()
    ]
    return np.concatenate([np.zeros(0, dtype=bool), *parts])


TINY_LEVEL = 1e-300
"""Level added before logarithms and divisions, so that a level of 0 stays finite."""


def _objective_slopes(problem: DesignProblem, values: Found, moved: Found) -> FloatArray:
    goals = problem.goals
    if goals.objectives:
        return goals.objectives[0].sign * np.concatenate([moved[name] for name in goals.objectives[0].quantities])
    # Merit sum r^2, so that its slope is 2 r.dr.
    deviations = goals.deviations(values)[0]
    slopes = np.concatenate([target.scale * moved[target.quantity] for target in goals.targets])
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
            # Over the objective at the start, a row is about 1 and has no unit.
            columns = objective(self.problem, self._at(place))[0, self.chosen.columns]
            parts.append(finite(columns / self._scale))
        return np.concatenate(parts)

    def size_slopes(self, place: FloatArray) -> FloatArray:
        """Derivatives (n, n_p) of :meth:`sizes` to the n_p coordinates of the unit cube."""
        # d(ln L) = dL/L where rows are logarithms of levels.
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
        # ln(L/bound) is below 0 where the peak keeps its limit.
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
        top = curve.sizes_at(self.problem.box.inside(place), points).max()
        return bool(top > self._levels(name, place).max() * (1 + curve.precision))

    def _scaled(self, levels: FloatArray) -> FloatArray:
        return np.log(levels + TINY_LEVEL) if self._in_logs else levels / self._scale

    def _levels(self, name: str, place: FloatArray) -> FloatArray:
        key = (name, place.tobytes())
        if key not in self._heights:
            values = self.problem.box.inside(place)
            self._heights[key] = self.problem.curves[name].sizes_at(values, self.chosen.peaks[name])
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
