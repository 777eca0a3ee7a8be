"""Design problem in the unit cube of its parameters, with goals, quantities and their derivatives."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.machinery.design.damper_optimum import DesignParameter
from torsionnet.machinery.design.levels import Levels
from torsionnet.machinery.design.minimax import Box
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
            raise UsageError("say which parameters may change")
        for one in self.parameters:
            if not (np.isfinite([one.lower, one.upper]).all() and one.lower < one.upper):
                raise UsageError(
                    f"{one.name}: bounds are a lower and a higher value, got {one.lower:g} and {one.upper:g}"
                )

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(one.name for one in self.parameters)

    @property
    def peak_objectives(self) -> tuple[str, ...]:
        """Names of the minimised quantities that have a curve over frequency."""
        sought = [name for one in self.goals.objectives[:1] if one.sign > 0 for name in one.quantities]
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
        return Box(np.array([one.lower for one in self.parameters]), np.array([one.upper for one in self.parameters]))

    @cached_property
    def start(self) -> FloatArray:
        """Point of the unit cube (n_p,) of the given design, where the search begins."""
        return self.box.place(np.array([one.start for one in self.parameters]))

    def values(self, place: FloatArray) -> dict[str, float]:
        """Value in SI of each parameter at one point of the unit cube, by its name."""
        return dict(zip(self.names, map(float, self.box.inside(np.asarray(place))), strict=True))

    def at(self, places: FloatArray) -> Found:
        """Values (n, n_points) in SI of each quantity, by its name, at points (n, n_p) of the unit cube."""
        inside = self.box.inside(np.atleast_2d(places))
        self._asked.append(len(inside))
        found = self.evaluate({name: inside[:, index] for index, name in enumerate(self.names)})
        self.goals.check(found)
        return {name: np.asarray(found[name], float).reshape(len(inside), -1) for name in self.goals.quantities}

    def ranks(self, found: Found) -> list[Rank]:
        """Rank of each of n designs, its violation of limits, then its merit."""
        over, merit = self.goals.violation(found), self.goals.merit(found)
        return [(0.0 if v <= FEASIBLE_EXCESS else v, m) for v, m in zip(over.tolist(), merit.tolist(), strict=True)]

    def jacobian(self, place: FloatArray) -> Found:
        """Derivatives (n_points, n_p) of each quantity, by its name, to the coordinates of the unit cube at a point.

        0 where they do not exist.
        """
        exact = {} if self.slopes is None else self.slopes(self.values(place))
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
        found = self.at(points.reshape(-1, size))
        weights = np.array([_weights((place[i] - centre[i]) / SLOPE_STEP) for i in range(size)]) / SLOPE_STEP
        slopes = {name: np.einsum("pk,pkm->mp", weights, found[name].reshape(size, len(STENCIL), -1)) for name in names}
        return {name: np.where(np.isfinite(one), one, 0.0) for name, one in slopes.items()}


def _weights(at: float) -> FloatArray:
    """Weights (5,) of values at five points that give the derivative of their polynomial at a point.

    >>> (12 * _weights(1.0)).round(9).tolist()
    [-1.0, 6.0, -18.0, 10.0, 3.0]
    """
    powers = np.arange(len(STENCIL))
    with np.errstate(divide="ignore", invalid="ignore"):
        wanted = np.where(powers > 0, powers * float(at) ** np.maximum(powers - 1, 0), 0.0)
    return np.linalg.solve(STENCIL[None, :] ** powers[:, None], wanted)
