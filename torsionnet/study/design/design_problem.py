"""A design to be sought, in the unit cube of its parameters: what it asks, and derivatives of the answers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.errors import UsageError
from torsionnet.response.damper_optimum import DesignParameter
from torsionnet.solve.design.levels import Levels
from torsionnet.solve.design.minimax import Box
from torsionnet.study.design.design_goals import DesignGoals, Found

Evaluate = Callable[[Mapping[str, FloatArray]], Mapping[str, FloatArray]]
"""Values (n,) of parameters by name -> values (n,) or (n, n_points) of quantities by name; NaN where there is none."""
Slopes = Callable[[Mapping[str, float]], Mapping[str, FloatArray]]
"""Value of every parameter -> exact derivatives (n_points, n_p) of some quantities to the parameters, SI."""

STEP = 1e-3
"""Of the unit cube, between the five points of a numerical derivative: truncated at 1e-12 of a smooth function."""
FEASIBLE = 1e-9
"""Excess over limits, relative to them, that is rounding."""
LARGE = 1e6
"""Stands for a quantity that a design does not have."""
STENCIL = np.arange(5) - 2.0


Rank = tuple[float, float]
"""Violation of limits, then merit: the smaller the better."""


@dataclass(frozen=True, eq=False)
class DesignProblem:
    """Goals over the unit cube of parameters; positive ones are searched by equal factors.

    Attributes
    ----------
    parameters : tuple of DesignParameter
        With bounds; their ``value`` is not used.
    goals : DesignGoals
    evaluate : Evaluate
        Of many designs at once.
    slopes : Slopes, optional
        Derivatives that are known exactly; the others are taken numerically.
    curves : mapping
        Curves over frequency of quantities that are their largest peak: smooth where the largest changes place.
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
        """Quantities with a curve that are made small."""
        sought = [name for one in self.goals.objectives[:1] if one.sign > 0 for name in one.quantities]
        return tuple(name for name in sought if name in self.curves)

    @property
    def peak_limits(self) -> dict[str, float]:
        """Upper limits of quantities with a curve."""
        below = {name: limit.below for name, limit in self.goals.limits.items() if name in self.curves}
        return {name: bound for name, bound in below.items() if bound is not None and bound > 0}

    @property
    def evaluations(self) -> int:
        """Designs calculated so far."""
        return sum(self._asked)

    @cached_property
    def box(self) -> Box:
        return Box(np.array([one.lower for one in self.parameters]), np.array([one.upper for one in self.parameters]))

    @cached_property
    def start(self) -> FloatArray:
        """Place where the search begins."""
        return self.box.place(np.array([one.start for one in self.parameters]))

    def values(self, place: FloatArray) -> dict[str, float]:
        """Values of the parameters at one place."""
        return dict(zip(self.names, map(float, self.box.inside(np.asarray(place))), strict=True))

    def at(self, places: FloatArray) -> Found:
        """Quantities (n, n_points) of the goals at places (n, n_p)."""
        inside = self.box.inside(np.atleast_2d(places))
        self._asked.append(len(inside))
        found = self.evaluate({name: inside[:, index] for index, name in enumerate(self.names)})
        self.goals.check(found)
        return {name: np.asarray(found[name], float).reshape(len(inside), -1) for name in self.goals.quantities}

    def ranks(self, found: Found) -> list[Rank]:
        """Of every design."""
        over, merit = self.goals.violation(found), self.goals.merit(found)
        return [(0.0 if v <= FEASIBLE else v, m) for v, m in zip(over.tolist(), merit.tolist(), strict=True)]

    def jacobian(self, place: FloatArray) -> Found:
        """Derivatives (n_points, n_p) of the quantities to the place; 0 where one cannot be taken."""
        exact = {} if self.slopes is None else self.slopes(self.values(place))
        rates = self.box.rates(place)
        known = {
            name: np.atleast_2d(slope) * rates for name, slope in exact.items() if np.isfinite(np.asarray(slope)).all()
        }
        missing = [name for name in self.goals.quantities if name not in known]
        return {**known, **(self._differences(place, missing) if missing else {})}

    def _differences(self, place: FloatArray, names: Sequence[str]) -> Found:
        """From five points along every parameter, moved inward at bounds."""
        size = len(place)
        centre = np.clip(place, -STEP * STENCIL[0], 1 - STEP * STENCIL[-1])
        points = np.repeat(np.asarray(place, float)[None, None, :], size * len(STENCIL), axis=0).reshape(size, -1, size)
        for index in range(size):
            points[index, :, index] = centre[index] + STEP * STENCIL
        found = self.at(points.reshape(-1, size))
        weights = np.array([_weights((place[i] - centre[i]) / STEP) for i in range(size)]) / STEP
        slopes = {name: np.einsum("pk,pkm->mp", weights, found[name].reshape(size, len(STENCIL), -1)) for name in names}
        return {name: np.where(np.isfinite(one), one, 0.0) for name, one in slopes.items()}


def _weights(at: float) -> FloatArray:
    """Weights of the values at the stencil for the derivative of their polynomial at a point.

    >>> (12 * _weights(1.0)).round(9).tolist()
    [-1.0, 6.0, -18.0, 10.0, 3.0]
    """
    powers = np.arange(len(STENCIL))
    with np.errstate(divide="ignore", invalid="ignore"):
        wanted = np.where(powers > 0, powers * float(at) ** np.maximum(powers - 1, 0), 0.0)
    return np.linalg.solve(STENCIL[None, :] ** powers[:, None], wanted)
