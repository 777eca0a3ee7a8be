"""Worst case, an answer of a study, the largest and smallest value of a quantity within the tolerances."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any, ClassVar

import numpy as np

from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, OneOf, Text, entry
from torsionnet.base.errors import Fault, SolveError
from torsionnet.base.table import Column, Table
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer import (
    QUANTITY,
    AnswerCase,
    AskedStudy,
    OfPoints,
    PlainConclusion,
    StudyAnswer,
    VariantValues,
    answer_cases,
    measure_of,
    quantity_faults,
    register_answer,
    units_of,
)
from torsionnet.study.space.space import COVERAGE

# Global search of the largest value of a function in the unit cube, checked against random points.

MOST_WITH_ALL_CORNERS = 10
"""Most parameters with which all corners of the cube are tried, 1024 for ten, as each further one doubles them."""
RANDOM_CORNERS = 1024
"""Number of random corners of the cube that are tried if there are too many for all, as many as ten parameters have."""
POPULATION, GENERATIONS = 10, 150
"""Members for each parameter, and most generations, of the differential evolution that seeks the worst case."""
SLOPE_STEP = 1e-5
"""Step of slopes by differences in the unit cube, and the distance below which two points count as one."""
POLISHED = 6
"""Number of the best points from which slopes are followed, as more find further maxima and take longer."""
AT_BOUND = 1e-6
"""Distance from a bound in the unit cube within which a parameter is said to lie at the bound."""
MOST_ROUNDS = 5
"""Most rounds of the worst-case search in which a random point beats the best found, before it is given up."""
BETTER_BY = 1e-9
"""Share of the range of values by which a random point must be better to count, as less is rounding."""


@dataclass(frozen=True, eq=False)
class Extreme:
    """Largest value of a function that the search found, and its point in the unit cube.

    ``point`` (d,) is in the unit cube, ``tried_at_random`` the number of random points none of which is better,
    ``best_at_random`` the best of them.
    """

    point: FloatArray
    value: float
    evaluations: int
    tried_at_random: int
    best_at_random: float
    at_lower: tuple[int, ...]
    at_upper: tuple[int, ...]


def largest(function: OfPoints, n_parameters: int, *, seed: int, tried: int = 10_000) -> Extreme:
    """Search the largest value of a function in the unit cube, leaving out points without a value (NaN).

    Corners, a differential evolution, and from the best points along slopes and into bounds; then ``tried`` random
    points: where one of them is better the search goes on from there.

    Raises
    ------
    SolveError
        No point has a value, or random points beat the search again and again.
    """
    search = _Search(function, n_parameters, np.random.default_rng(seed))
    search.corners()
    search.evolve()
    for _ in range(MOST_ROUNDS):
        search.polish()
        points = search.numbers.random((tried, n_parameters))
        values = search.values(points)
        best = int(values.argmax())
        if values[best] <= search.best + BETTER_BY * search.range:
            return search.result(tried, float(values[best]))
        search.offer(points, values)
    raise SolveError(
        f"random points beat the search {MOST_ROUNDS} times; the function is too rough for it", kind="no-solution"
    )


class _Search:
    """Best points in the unit cube so far, best first, and the methods that find better ones."""

    def __init__(self, function: OfPoints, d: int, numbers: np.random.Generator) -> None:
        self.function, self.d, self.numbers = function, d, numbers
        self.evaluations = 0
        self.points, self.reached = np.zeros((0, d)), np.zeros(0)
        self.lowest = np.inf

    @property
    def best(self) -> float:
        return float(self.reached[0])

    @property
    def range(self) -> float:
        return max(self.best - self.lowest, abs(self.best) * 1e-6)

    def values(self, points: FloatArray) -> FloatArray:
        values = self.function(points)
        self.evaluations += len(points)
        finite = values[np.isfinite(values)]
        self.lowest = min(self.lowest, float(finite.min(initial=np.inf)))
        return np.where(np.isnan(values), -np.inf, values)

    def offer(self, points: FloatArray, values: FloatArray) -> None:
        """Keep the best of the points given and those found before, each once."""
        points, values = np.concatenate([self.points, points]), np.concatenate([self.reached, values])
        order = np.argsort(-values, kind="stable")
        kept: list[int] = []
        for index in order[: 50 * POLISHED]:
            if all(np.abs(points[index] - points[other]).max() > SLOPE_STEP for other in kept):
                kept.append(int(index))
            if len(kept) == POLISHED:
                break
        self.points, self.reached = points[kept], values[kept]

    def corners(self) -> None:
        """Try the middle and all corners of the unit cube, or random corners where there are too many."""
        # Quantities that rise or fall with every parameter have their extremes in corners.
        if self.d <= MOST_WITH_ALL_CORNERS:
            points = np.array(list(product((0.0, 1.0), repeat=self.d)))
        else:
            points = self.numbers.integers(0, 2, size=(RANDOM_CORNERS, self.d)).astype(float)
        points = np.concatenate([points, np.full((1, self.d), 0.5)])
        self.offer(points, self.values(points))
        if not np.isfinite(self.best):
            raise SolveError(
                "none of the corners of the tolerances has a value; narrow the tolerances, or try one corner alone",
                kind="no-solution",
            )
        if self.d > MOST_WITH_ALL_CORNERS:
            self._into_bounds()

    def evolve(self) -> None:
        from scipy.optimize import Bounds, differential_evolution

        def negative(columns: FloatArray) -> Any:
            values = self.values(columns.T)
            # A variant without a value is worse than all others, but by a finite number.
            return -np.where(np.isfinite(values), values, self.lowest - self.range)

        population = differential_evolution(
            negative, Bounds(np.zeros(self.d), np.ones(self.d)), vectorized=True, updating="deferred", polish=False,
            rng=self.numbers, popsize=POPULATION, maxiter=GENERATIONS, init="sobol", tol=1e-6,
        )  # fmt: skip
        self.offer(population.population, -population.population_energies)

    def polish(self) -> None:
        from scipy.optimize import minimize

        for point in self.points:
            solution = minimize(self._with_slopes, point, jac=True, method="L-BFGS-B", bounds=[(0.0, 1.0)] * self.d)
            self.offer(solution.x[None], self.values(solution.x[None]))
        self._into_bounds()

    def _with_slopes(self, point: FloatArray) -> tuple[float, FloatArray]:
        """Negative value of the function at a point (d,) of the unit cube, and its slopes (d,) by differences."""
        # At a bound the difference is one-sided.
        above, below = np.minimum(point + SLOPE_STEP, 1), np.maximum(point - SLOPE_STEP, 0)
        moved = [np.where(np.eye(self.d, dtype=bool), side, point) for side in (above, below)]
        values = self.values(np.concatenate([point[None], *moved]))
        slopes = np.nan_to_num((values[1 : self.d + 1] - values[self.d + 1 :]) / (above - below))
        return float(-values[0] if np.isfinite(values[0]) else self.range - self.lowest), -slopes

    def _into_bounds(self) -> None:
        """Move parameters of the best point to a bound, one at a time, as long as the value rises."""
        for _ in range(2 * self.d):
            moved = [np.where(np.eye(self.d, dtype=bool), side, self.points[0]) for side in (0.0, 1.0)]
            points = np.concatenate(moved)
            values = self.values(points)
            if values.max() <= self.best:
                return
            self.offer(points, values)

    def result(self, tried: int, best_at_random: float) -> Extreme:
        point = self.points[0]
        lower, upper = np.flatnonzero(point <= AT_BOUND), np.flatnonzero(point >= 1 - AT_BOUND)
        return Extreme(
            point, self.best, self.evaluations, tried, best_at_random, tuple(lower.tolist()), tuple(upper.tolist())
        )


CONFIRMED_DIFFERENCE = 1e-6
"""Largest relative difference of the worst value from that of the same variant as a single model, to be confirmed."""


@dataclass(frozen=True, eq=False)
class WorstVariant:
    """Variant of one configuration in which a quantity is largest or smallest, with the bounds that it lies on.

    Attributes
    ----------
    configuration, direction : str
    value, nominal : float
        Value of the quantity in this variant and in the model as given.
    variant, tolerance : mapping
        Values of the parameters, and the bounds of their tolerances.
    at_lower, at_upper : tuple of str
        Parameters at a bound of their tolerance.
    singly : float
        Value of this variant built and solved as a single model.
    best_at_random : float
        The worst value among ``tried`` random variants.
    evaluations : int
        Variants calculated.
    """

    configuration: str
    direction: str
    value: float
    variant: Mapping[str, float]
    tolerance: Mapping[str, tuple[float, float]]
    nominal: float
    at_lower: tuple[str, ...]
    at_upper: tuple[str, ...]
    singly: float
    best_at_random: float
    tried: int
    evaluations: int

    @property
    def confirmed(self) -> bool:
        """Whether the worst variant, solved as a single model, gives the same value."""
        return abs(self.singly - self.value) <= CONFIRMED_DIFFERENCE * abs(self.value)


@dataclass(frozen=True, eq=False, repr=False)
class WorstCaseResult(PlainConclusion):
    """Worst variants of a quantity in all configurations, with units.

    ``correlated`` are the pairs of parameters that a study correlates.
    """

    drawing: ClassVar[str] = "torsionnet.plot.study.distributions:worst_variants"

    title: str
    quantity: str
    unit: str
    parameter_units: Mapping[str, str]
    variants: tuple[WorstVariant, ...]
    correlated: tuple[tuple[str, str], ...] = ()

    @property
    def sentences(self) -> tuple[str, ...]:
        said = [text for worst in self.variants for text in self._about(worst)]
        if self.correlated:
            pairs = ", ".join(" and ".join(pair) for pair in self.correlated)
            said.append(
                f"correlation is left out ({pairs}): each parameter lies anywhere within its tolerance, whatever the "
                "others are, so that a worst case may be a variant that hardly occurs"
            )
        return tuple(said)

    def _about(self, worst: WorstVariant) -> list[str]:
        values = f"{worst.value:.5g} {self.unit}".rstrip() + f" (as given {worst.nominal:.5g})"
        inside = [name for name in worst.variant if name not in worst.at_lower + worst.at_upper]
        places = [("at the lower bound", worst.at_lower), ("at the upper bound", worst.at_upper), ("between", inside)]
        where = ", ".join(f"{' and '.join(names)} {place}" for place, names in places if names)
        said = [f"{worst.direction} {self.quantity}, {worst.configuration}: {values}, {where}"]
        text = f"none of {worst.tried} random variants beats it; their best is {worst.best_at_random:.5g}"
        said.append(f"{worst.configuration}: {text}")
        if not worst.confirmed:
            text = f"solved as a model of its own this variant has {worst.singly:.8g}: not confirmed"
            said.append(f"{worst.configuration}: {text}")
        return said

    def table(self) -> Table:
        columns = (
            Column("configuration"), Column("sought"), Column(self.quantity, self.unit), Column("as given", self.unit),
            *(Column(name, unit, digits=5) for name, unit in self.parameter_units.items()),
            Column("best at random", self.unit), Column("singly", self.unit), Column("variants"),
        )  # fmt: skip
        rows = tuple(
            (worst.configuration, worst.direction, worst.value, worst.nominal,
             *(worst.variant[name] for name in self.parameter_units), worst.best_at_random, worst.singly,
             worst.evaluations)
            for worst in self.variants
        )  # fmt: skip
        return Table.of(self.title, f"worst case of {self.quantity}", columns, rows, self.sentences)


BOTH = "both"
SIGNS = {"largest": (1,), "smallest": (-1,), BOTH: (1, -1)}


@register_answer
@dataclass(frozen=True, kw_only=True)
class WorstCase(StudyAnswer):
    """Largest and smallest value of a quantity within the tolerances of all parameters, in each configuration.

    Tolerances are the limits of distributions, lists and ranges; a distribution without limits ends where all but the
    share ``coverage`` of its values lies within. Correlation is left out. Sought in corners, by differential evolution
    and along slopes; what is found is solved again as a model of its own, and random variants are tried to beat it.
    """

    kind: ClassVar[str] = "worst_case"
    of_variants: ClassVar[bool] = False
    naming: ClassVar[Mapping[str, str]] = {"quantity": QUANTITY}

    quantity: str = entry(Text("quantity"))
    direction: str = entry(OneOf("which value is sought", tuple(SIGNS)), BOTH)
    coverage: float = entry(
        Value(
            "share of the values within the tolerance, where a distribution has no limits", "1", exclusive=True, below=1
        ),
        COVERAGE,
    )
    tried: int = entry(Count("random variants that try to beat what was found", upper=10**9), 10_000)
    seed: int = entry(Count("another seed searches otherwise", lower=0, upper=2**32 - 1), 1)

    def study_faults(self, study: AskedStudy) -> Iterator[Fault]:
        yield from quantity_faults(study, (self.quantity,), "quantity")

    def conclude(self, study: AskedStudy, result: VariantValues | None = None) -> WorstCaseResult:
        del result
        variants = [self._of_case(case, sign) for case in answer_cases(study) for sign in SIGNS[self.direction]]
        unit, pairs = measure_of(study, self.quantity).unit, study.space.entries.correlation
        correlated = tuple((str(first), str(second)) for first, second in (pair.between for pair in pairs))
        return WorstCaseResult(study.title, self.quantity, unit, units_of(study), tuple(variants), correlated)

    def _of_case(self, case: AnswerCase, sign: int) -> WorstVariant:
        box = case.space.box(self.coverage)
        low, high = (np.array(side) for side in zip(*box.values(), strict=True))

        def values(points: FloatArray) -> dict[str, FloatArray]:
            return dict(zip(box, (low + points * (high - low)).T, strict=True))

        def signed(points: FloatArray) -> FloatArray:
            return sign * case.calculated(values(points), (self.quantity,))[self.quantity]

        worst = largest(signed, len(box), seed=self.seed, tried=self.tried)
        variant = {name: float(column[0]) for name, column in values(worst.point[None]).items()}
        nominal = sign * float(signed(self._nominal(case, low, high))[0])
        return WorstVariant(
            case.label, "largest" if sign > 0 else "smallest", sign * worst.value, variant, box, nominal,
            tuple(list(box)[place] for place in worst.at_lower), tuple(list(box)[place] for place in worst.at_upper),
            case.singly(variant, self.quantity), sign * worst.best_at_random, worst.tried_at_random, worst.evaluations,
        )  # fmt: skip

    def _nominal(self, case: AnswerCase, low: FloatArray, high: FloatArray) -> FloatArray:
        """Point (1, d) of the unit cube at which the d parameters have the model's own values.

        0.5 where a parameter has no value.
        """
        own = np.array([case.space.nominal[name] for name in case.space.names])
        return np.where(np.isnan(own), 0.5, (own - low) / np.where(high > low, high - low, 1.0))[None]
