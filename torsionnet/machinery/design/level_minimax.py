"""Vibration levels over frequency or speed, and the search for the parameter values with which the largest is smallest.

Search for parameter values within bounds for which the largest vibration level is smallest.

Parameter values within bounds for which the largest level is smallest.

Levels at some points become constraints, log level <= t with t to be made small, which sequential quadratic programming
solves; the maxima of the curve for its answer are new points, until none is higher than t.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Protocol

import numpy as np
import scipy
from numpy.typing import NDArray

from torsionnet.base.units import RPM
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.frequency_response import Channel, FloatArray
from torsionnet.linear.modes.natural_modes import modes
from torsionnet.linear.responses.grid import Adaptive, inner_maxima
from torsionnet.linear.sensitivity.parametric import ParametricResponse
from torsionnet.linear.sensitivity.unknowns import Unknowns
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.order_solution import orders_at_speeds
from torsionnet.machinery.orders.refined_response import ExaminedSpeeds
from torsionnet.machinery.orders.speed_refinement import refine_speeds, speeds_to_refine
from torsionnet.model.channels import Sensor

# Vibration levels that a damper is to make small, over frequency or speed, with derivatives to parameters.

REFINEMENT_ROUNDS, REFINEMENT_POINTS = 4, 21
"""Number of rounds that refine a maximum of a level, and points in each, so that every round divides the interval by
ten."""
SLOPE_STEP = 1e-4
"""Relative step of a parameter for the central difference that gives the slope of a half range, large enough that
rounding hardly counts."""


@dataclass(frozen=True, eq=False)
class VariedModel:
    """Drivetrain at varying values of its unknowns, of which what does not depend on them is worked out once."""

    unknowns: Unknowns

    @cached_property
    def _first(self) -> AssembledModel:
        return AssembledModel.from_definition(self.unknowns.definition)

    def with_values(self, values: FloatArray) -> AssembledModel:
        return self._first.configured(**dict(zip(self.unknowns.parameters, map(float, values), strict=True)))


class Levels(Protocol):
    """Protocol of vibration levels, which depend on parameters, over frequencies in Hz or speeds in rad/s."""

    @property
    def precision(self) -> float:
        """Relative precision of the vibration levels and of results derived from them."""

    def grid(self, values: FloatArray) -> FloatArray:
        """Frequencies (Hz) or speeds (rad/s), shape (n,), rising, that show every maximum of the level."""

    def sizes_at(self, values: FloatArray, points: FloatArray) -> FloatArray:
        """Levels (n,), amplitudes or half ranges to be made small, at frequencies or speeds ``points`` (n,)."""

    def slopes(self, values: FloatArray, points: FloatArray) -> FloatArray:
        """Derivatives (n, n_p) of the levels at ``points`` (n,) to the parameters in SI units."""

    def maxima(self, values: FloatArray) -> FloatArray:
        """Frequencies (Hz) or speeds (rad/s), shape (n,), of the local maxima of the level, the highest first.

        The ends of the range count.
        """

    def shown(self, points: FloatArray) -> FloatArray:
        """Frequencies or speeds ``points`` (n,) converted to the unit in which they are displayed, see ``of``."""

    @property
    def frequencies(self) -> FloatArray:
        """Frequencies in Hz that the levels are made of, at least the lowest and the highest."""

    @property
    def of(self) -> tuple[str, str]:
        """Name of the quantity over which levels are displayed, such as "frequency", and its unit, such as "Hz"."""

    @property
    def channel(self) -> Channel:
        """Name and unit of the vibration level."""


@dataclass(frozen=True, eq=False)
class ReceptanceLevels:
    """Magnitude of one transfer function over a band in Hz, with exact derivatives to the parameters."""

    response: ParametricResponse
    band: tuple[float, float]
    precision: ClassVar[float] = 1e-10

    @property
    def frequencies(self) -> FloatArray:
        return np.array(self.band)

    @property
    def of(self) -> tuple[str, str]:
        return "frequency", "Hz"

    @property
    def channel(self) -> Channel:
        output = self.response.request.outputs[0].channel
        measured = self.response.request.inputs[0].channel
        return Channel(f"{output.name}/{measured.name}", f"{output.unit}/({measured.unit})")

    def grid(self, values: FloatArray) -> FloatArray:
        return Adaptive(*self.band).frequencies(modes(self._model.with_values(values)))

    @cached_property
    def _model(self) -> VariedModel:
        return VariedModel(self.response.unknowns)

    def sizes_at(self, values: FloatArray, points: FloatArray) -> FloatArray:
        response = replace(self.response, frequencies=points).evaluation(values)
        return np.abs(response.values[:, 0, 0])

    def slopes(self, values: FloatArray, points: FloatArray) -> FloatArray:
        response = replace(self.response, frequencies=points).evaluation(values)
        y, dy = response.values[:, 0, 0], response.jacobian[:, 0, 0]
        # d|y|/dp = Re(conj(y) dy/dp)/|y|.
        return np.asarray((np.conj(y)[:, None] * dy).real / np.abs(y)[:, None])

    def maxima(self, values: FloatArray) -> FloatArray:
        grid = self.grid(values)
        levels = self.sizes_at(values, grid)
        places = _with_ends(levels)
        points = [
            self._refined(values, grid[place - 1], grid[place + 1]) if 0 < place < len(grid) - 1 else float(grid[place])
            for place in places
        ]
        return _highest_first(np.array(points), self.sizes_at(values, np.array(points)))

    def _refined(self, values: FloatArray, low: float, high: float) -> float:
        for _ in range(REFINEMENT_ROUNDS):
            fine = np.linspace(low, high, REFINEMENT_POINTS)
            best = int(np.argmax(self.sizes_at(values, fine)))
            low, high = fine[max(best - 1, 0)], fine[min(best + 1, REFINEMENT_POINTS - 1)]
        return float(fine[best])

    def shown(self, points: FloatArray) -> FloatArray:
        return points


@dataclass(frozen=True, eq=False)
class OrderLevels:
    """Half range of all orders of one output together, in its unit, at the speeds of a run in rad/s.

    With ``refine`` also between these speeds, near resonances and maxima of the model in question. Every response is
    exact; slopes are central differences of it, so that whatever excites the model may depend on its parameters in any
    way.
    """

    model: VariedModel
    output: str | Sensor
    excitations: Sequence[str] | None
    run: OrderResponse
    refine: bool = False
    precision: ClassVar[float] = 1e-5

    @property
    def frequencies(self) -> FloatArray:
        return np.abs(self.run.frequencies)

    @property
    def of(self) -> tuple[str, str]:
        return f"speed of {self.run.reference}", "r/min"

    @property
    def channel(self) -> Channel:
        first = self.run.outputs[0]
        return replace(first, name=f"half range of {first.name}")

    def grid(self, values: FloatArray) -> FloatArray:
        if not self.refine:
            return self.run.speeds
        changed, shaft = self.model.with_values(values), self.run.reference
        examined = ExaminedSpeeds.of(
            changed, self.run.speeds, speed_of=shaft, excitations=self.excitations, refine=True
        )
        return examined.first(np.empty(0))

    def sizes_at(self, values: FloatArray, points: FloatArray) -> FloatArray:
        changed, shaft = self.model.with_values(values), self.run.reference
        run = orders_at_speeds(changed, self.output, speeds=points, speed_of=shaft, excitations=self.excitations)
        return np.asarray(run.half_range[:, 0])

    def slopes(self, values: FloatArray, points: FloatArray) -> FloatArray:
        slopes = np.empty((len(points), len(values)))
        for place, value in enumerate(values):
            # Central differences, of which the error goes with the square of the step.
            step = SLOPE_STEP * (abs(value) or 1.0)
            above, below = (np.where(np.arange(len(values)) == place, values + sign * step, values) for sign in (1, -1))
            slopes[:, place] = (self.sizes_at(above, points) - self.sizes_at(below, points)) / (2 * step)
        return slopes

    def maxima(self, values: FloatArray) -> FloatArray:
        def with_more(known: FloatArray, more: FloatArray) -> FloatArray:
            both = np.concatenate([known, [more, self.sizes_at(values, more)]], axis=1)
            return both[:, np.argsort(both[0], kind="stable")]

        grid = self.grid(values)
        curve = np.array([grid, self.sizes_at(values, grid)])
        if self.refine:
            curve = refine_speeds(curve, lambda known: speeds_to_refine(known[0], known[1:].T), with_more)
        places = _with_ends(curve[1])
        return _highest_first(curve[0, places], curve[1, places])

    def shown(self, points: FloatArray) -> FloatArray:
        return points * RPM


def _with_ends(levels: FloatArray) -> list[int]:
    """Indices of the local maxima of levels (n,), and of ends that are higher than their neighbour."""
    if len(levels) < 2:
        return [0]
    first = [0] if levels[0] >= levels[1] else []
    last = [len(levels) - 1] if levels[-1] > levels[-2] else []
    return [*first, *inner_maxima(levels), *last]


def _highest_first(points: FloatArray, levels: FloatArray) -> FloatArray:
    return points[np.argsort(-levels, kind="stable")]


# Vibration levels over several conditions of one drivetrain, of which the largest counts.

CONDITION_OFFSET = 2.0
"""Offset between equal points of two conditions, in multiples of the highest point, so that conditions never
overlap."""


@dataclass(frozen=True, eq=False)
class WorstLevels:
    """Vibration levels of all conditions of a drivetrain at one set of values, one condition behind the other.

    Attributes
    ----------
    parts : tuple of Levels
        Of every condition, for the same values.
    highest : float
        No point is higher, of any condition.
    """

    parts: tuple[Levels, ...]
    highest: float

    @property
    def precision(self) -> float:
        """Relative precision of the levels in the least precise condition."""
        return max(part.precision for part in self.parts)

    @property
    def frequencies(self) -> FloatArray:
        return np.concatenate([part.frequencies.ravel() for part in self.parts])

    @property
    def of(self) -> tuple[str, str]:
        return self.parts[0].of

    @property
    def channel(self) -> Channel:
        return self.parts[0].channel

    @property
    def _room(self) -> float:
        return CONDITION_OFFSET * self.highest

    def condition(self, points: FloatArray) -> NDArray[np.intp]:
        """Index (n,) of the condition to which each point belongs."""
        return np.asarray(np.floor_divide(points, self._room), dtype=np.intp)

    def grid(self, values: FloatArray) -> FloatArray:
        return np.concatenate([part.grid(values) + at * self._room for at, part in enumerate(self.parts)])

    def sizes_at(self, values: FloatArray, points: FloatArray) -> FloatArray:
        levels = np.empty(len(points))
        for part, chosen, own in self._parts_of_points(points):
            levels[chosen] = part.sizes_at(values, own)
        return levels

    def slopes(self, values: FloatArray, points: FloatArray) -> FloatArray:
        slopes = np.empty((len(points), len(values)))
        for part, chosen, own in self._parts_of_points(points):
            slopes[chosen] = part.slopes(values, own)
        return slopes

    def maxima(self, values: FloatArray) -> FloatArray:
        points = np.concatenate([part.maxima(values) + at * self._room for at, part in enumerate(self.parts)])
        return points[np.argsort(-self.sizes_at(values, points), kind="stable")]

    def shown(self, points: FloatArray) -> FloatArray:
        return self.parts[0].shown(points - self._room * self.condition(points))

    def _parts_of_points(self, points: FloatArray) -> list[tuple[Levels, NDArray[np.bool_], FloatArray]]:
        """Levels of each condition that has some of the points, mask (n,) of these, and the points within it."""
        places = self.condition(points)
        return [
            (part, places == at, points[places == at] - at * self._room)
            for at, part in enumerate(self.parts)
            if (places == at).any()
        ]


# Search for parameter values within bounds for which the largest vibration level is smallest.

CONSTRAINT_ROUNDS, PROGRAMMING_STEPS = 40, 60
"""Most rounds that add constraint points in a minimax search, and most steps of quadratic programming in each, which
bound its time."""
SAMPLED_STARTS, SEARCHED_STARTS = 16, 2
"""Number of sampled starts of a minimax search, doubled for each parameter after the first, and how many of the best
are searched."""
FIRST_CONSTRAINTS = 40
"""Number of points of the range that are constraints of a minimax search from the beginning, as fewer cost more
rounds."""
WIDE_BOUNDS_RATIO = 3.0
"""Ratio of upper to lower bound above which a parameter is searched in equal factors and not in equal steps."""
SMALLEST_LEVEL = 1e-300
"""Level added before logarithms are taken, near the smallest double, so that a level of zero has one."""
GRADIENT_PRECISION, TOLERANCE_POWER = 1e-8, 1.3
"""Relative precision of levels up to which gradients are used, and power of it at which quadratic programming stops, as
less is rounding."""


@dataclass(frozen=True, eq=False)
class Box:
    """Bounds (n_p,) of the parameters in SI units, mapped to the unit cube in which the search runs.

    >>> Box(np.array([1.0, -1.0]), np.array([100.0, 1.0])).inside(np.array([0.5, 0.25])).tolist()
    [10.0, -0.5]
    """

    lower: FloatArray
    upper: FloatArray

    @property
    def _by_factors(self) -> NDArray[np.bool_]:
        return np.asarray((self.lower > 0) & (self.upper > WIDE_BOUNDS_RATIO * self.lower))

    def inside(self, place: FloatArray) -> FloatArray:
        """Parameter values (n_p,) in SI units at a place (n_p,) in the unit cube."""
        with np.errstate(divide="ignore", invalid="ignore"):
            factors = self.lower * (self.upper / self.lower) ** place
        values = np.where(self._by_factors, factors, self.lower + place * (self.upper - self.lower))
        return np.clip(values, self.lower, self.upper)

    def place(self, values: FloatArray) -> FloatArray:
        """Place (n_p,) in the unit cube of parameter values, or of the nearest ones within the bounds."""
        clipped = np.clip(values, self.lower, self.upper)
        with np.errstate(divide="ignore", invalid="ignore"):
            factors = np.log(clipped / self.lower) / np.log(self.upper / self.lower)
        return np.where(self._by_factors, factors, (clipped - self.lower) / (self.upper - self.lower))

    def rates(self, place: FloatArray) -> FloatArray:
        """Derivatives (n_p,) of the parameters, in SI units, to their places in the unit cube from 0 to 1."""
        with np.errstate(divide="ignore", invalid="ignore"):
            # v = lower (upper/lower)^x: dv/dx = v ln(upper/lower).
            factors = self.inside(place) * np.log(self.upper / self.lower)
        return np.where(self._by_factors, factors, self.upper - self.lower)


def smallest_maximum(levels: Levels, box: Box, start: FloatArray) -> FloatArray:
    """Parameter values (n_p,) in SI units for which the largest vibration level is smallest.

    The search starts from ``start`` and from samples of the box.
    """
    if len(start) == 1 and levels.precision > GRADIENT_PRECISION:
        return _along_one(levels, box, start)
    places = [
        box.place(start),
        *scipy.stats.qmc.Sobol(len(start), scramble=False).random(SAMPLED_STARTS * 2 ** (len(start) - 1)),
    ]
    # The largest level has several minima over the box: starts are sampled roughly, and only the best are searched
    # from.
    rough = [largest(levels, box.inside(place), refined=False) for place in places]
    optima = [search_from(levels, box, places[index]) for index in np.argsort(rough, kind="stable")[:SEARCHED_STARTS]]
    return box.inside(min(optima, key=lambda place: largest(levels, box.inside(place))))


def _along_one(levels: Levels, box: Box, start: FloatArray) -> FloatArray:
    """Value (1,) of a single parameter for which the largest level is smallest, found without slopes.

    The search goes by samples and parabolas.
    """
    places = np.union1d(np.linspace(0, 1, SAMPLED_STARTS + 1), box.place(start))

    def level(place: float) -> float:
        return largest(levels, box.inside(np.array([place])), refined=False)

    # Slopes by differences are too coarse to follow: samples bracket the minimum, parabolas refine it.
    rough = [level(place) for place in places]
    at = int(np.argmin(rough))
    ends = places[max(at - 1, 0)], places[min(at + 1, len(places) - 1)]
    search: Any = scipy.optimize.minimize_scalar
    optimum = search(level, bounds=ends, method="bounded", options={"xatol": 0.1 * np.sqrt(levels.precision)})
    best = optimum.x if optimum.fun < rough[at] else places[at]
    return box.inside(np.array([float(best)]))


def largest(levels: Levels, values: FloatArray, *, refined: bool = True) -> float:
    """Largest vibration level, in its unit, over all frequencies or speeds for these parameter values (n_p,)."""
    points = levels.maxima(values)[:1] if refined else levels.grid(values)
    return float(levels.sizes_at(values, points).max())


def search_from(levels: Levels, box: Box, place: FloatArray) -> FloatArray:
    """Best place (n_p,) in the unit cube that the minimax search reaches from a starting place.

    Maxima of every step become constraints of the next.
    """
    grid = levels.grid(box.inside(place))
    points = grid[:: max(len(grid) // FIRST_CONSTRAINTS, 1)]
    best, least = place, np.inf
    for _ in range(CONSTRAINT_ROUNDS):
        maxima = levels.maxima(box.inside(place))
        level = float(np.log(levels.sizes_at(box.inside(place), maxima[:1])[0] + SMALLEST_LEVEL))
        if level < least:
            best, least = place, level
        # Exchange of constraints: maxima of this curve are held down in the next step, too.
        points = np.union1d(points, maxima)
        place, bound = _lowest_highest_level(levels, box, points, place)
        top = float(np.log(largest(levels, box.inside(place)) + SMALLEST_LEVEL))
        if top < least:
            best, least = place, top
        # bound is the least maximum over the constraints alone: a curve nowhere higher is the minimax.
        if top <= bound + levels.precision:
            break
    return best


def _lowest_highest_level(levels: Levels, box: Box, points: FloatArray, start: FloatArray) -> tuple[FloatArray, float]:
    """Place (n_p,) in the unit cube where the largest level at ``points`` is smallest, and that level's logarithm."""

    def logs(x: FloatArray) -> FloatArray:
        return np.log(levels.sizes_at(box.inside(x[:-1]), points) + SMALLEST_LEVEL)

    def slopes(x: FloatArray) -> FloatArray:
        values = box.inside(x[:-1])
        by_value = levels.slopes(values, points) / (levels.sizes_at(values, points) + SMALLEST_LEVEL)[:, None]
        return np.column_stack([-by_value * box.rates(x[:-1]), np.ones(len(points))])

    search: Any = scipy.optimize.minimize  # its published types know no constraints that are functions
    # The smallest z with z >= ln level_i(x) for all points i, in the variables (x, z): smooth where the maximum is
    # not.
    optimum = search(
        lambda x: float(x[-1]),
        np.append(start, logs(np.append(start, 0.0)).max()),
        jac=lambda x: np.append(np.zeros(len(x) - 1), 1.0),
        method="SLSQP",
        bounds=[*((0.0, 1.0) for _ in start), (None, None)],
        constraints={"type": "ineq", "fun": lambda x: x[-1] - logs(x), "jac": slopes},
        options={"ftol": levels.precision**TOLERANCE_POWER, "maxiter": PROGRAMMING_STEPS},
    )
    place = np.clip(optimum.x[:-1], 0.0, 1.0)
    return place, float(logs(np.append(place, 0.0)).max())
