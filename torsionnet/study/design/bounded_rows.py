"""What programming keeps small or within limits: columns of quantities, and points of curves over frequency."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.design.bounded_points import BoundedPoints, finite, objective
from torsionnet.study.design.design_goals import Found
from torsionnet.study.design.design_problem import DesignProblem

TINY = 1e-300


def _objective_slopes(problem: DesignProblem, found: Found, moved: Found) -> FloatArray:
    goals = problem.goals
    if goals.objectives:
        return goals.objectives[0].sign * np.concatenate([moved[name] for name in goals.objectives[0].quantities])
    deviations = goals.deviations(found)[0]
    slopes = np.concatenate([one.scale * moved[one.quantity] for one in goals.targets])
    return np.asarray(2 * deviations[None, :] @ slopes)


@dataclass(frozen=True, eq=False)
class BoundedRows:
    """Chosen rows of the objective and of limits at places of the unit cube, with derivatives.

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
        """What is to be small (n,)."""
        parts = [self._scaled(self._levels(name, place)) for name in self.problem.peak_objectives]
        if self.chosen.columns.any():
            columns = objective(self.problem, self._at(place))[0, self.chosen.columns]
            parts.append(finite(columns / self._scale))
        return np.concatenate(parts)

    def size_slopes(self, place: FloatArray) -> FloatArray:
        """Derivatives (n, n_p) of :meth:`sizes`."""
        parts = [
            self._slopes(name, place) / (self._levels(name, place)[:, None] + TINY if self._in_logs else self._scale)
            for name in self.problem.peak_objectives
        ]
        if self.chosen.columns.any():
            slopes = _objective_slopes(self.problem, self._at(place), self.at(place))
            parts.append(slopes[self.chosen.columns] / self._scale)
        return np.concatenate(parts)

    def excess(self, place: FloatArray) -> FloatArray:
        """What is to stay below 0 (n,)."""
        parts = [np.log((self._levels(name, place) + TINY) / bound) for name, bound in self.problem.peak_limits.items()]
        if self.chosen.limits.any():
            parts.append(finite(self.problem.goals.excess(self._at(place))[0, self.chosen.limits]))
        return np.concatenate([np.zeros(0), *parts])

    def excess_slopes(self, place: FloatArray) -> FloatArray:
        """Derivatives (n, n_p) of :meth:`excess`."""
        parts = [
            self._slopes(name, place) / (self._levels(name, place)[:, None] + TINY) for name in self.problem.peak_limits
        ]
        if self.chosen.limits.any():
            parts.append(self.problem.goals.excess_slopes(self.at(place))[self.chosen.limits])
        return np.concatenate([np.zeros((0, len(place))), *parts])

    def hold(self, highest: BoundedPoints, place: FloatArray) -> bool:
        """Whether nothing that is highest at a place is higher than what is chosen."""
        new = (highest.columns & ~self.chosen.columns).any() or (highest.limits & ~self.chosen.limits).any()
        return not new and not any(self._surpassed(name, points, place) for name, points in highest.peaks.items())

    def _surpassed(self, name: str, points: FloatArray, place: FloatArray) -> bool:
        curve = self.problem.curves[name]
        top = curve.at(self.problem.box.inside(place), points).max()
        return bool(top > self._levels(name, place).max() * (1 + curve.precision))

    def _scaled(self, levels: FloatArray) -> FloatArray:
        return np.log(levels + TINY) if self._in_logs else levels / self._scale

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
