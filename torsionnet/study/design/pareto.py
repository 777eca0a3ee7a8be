"""Pareto front, an answer of a study, the designs that are compromises between several objectives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib.util import find_spec
from typing import Any, ClassVar

import numpy as np
import scipy

from torsionnet.base.entries.spec import Count, Json, entry
from torsionnet.base.errors import Fault, MissingExtraError, SolveError, UsageError
from torsionnet.base.registers import settle
from torsionnet.base.table import Column, Table
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.machinery.design.damper_optimum import DesignParameter
from torsionnet.study.answers.answer import AskedStudy, DrawnConclusion, VariantValues, register_answer
from torsionnet.study.design.design_goals import (
    NAMES,
    SAME_QUANTITY,
    DesignGoals,
    DesignObjective,
    Found,
    OneOrSeveral,
    with_unit,
)
from torsionnet.study.design.design_problem import FEASIBLE_EXCESS, MISSING_VALUE, DesignProblem
from torsionnet.study.design.optimise import Single, optimise
from torsionnet.study.design.optimum import DesignAnswer
from torsionnet.study.quantities.quantity import QuantityLimit

# Pareto front of a search with several objectives, its designs, their objectives and checks.


@dataclass(frozen=True, eq=False, repr=False)
class ParetoFront(DrawnConclusion):
    """Designs of a search none of which is better in every objective than another (Pareto front).

    Attributes
    ----------
    parameters : tuple of DesignParameter
        Parameters with bounds; ``value`` is that of the compromise nearest to the best of all objectives.
    objectives : tuple of DesignObjective
    designs : (n, n_p) array
        Parameter values in SI, ordered by the first objective.
    values : (n, n_objectives) array
        Values of the objectives' quantities.
    given : (n_objectives,) array
        Values of the objectives' quantities of the model as it stands.
    disagreement : float
        Largest relative difference of the recomputed designs to single models; nan where none was recomputed.
    evaluations, generations, seed : int
    method : str
    title : str
    units : tuple of str
        Units of the objectives, SI; empty where they are not known.
    """

    drawing: ClassVar[str] = "torsionnet.plot.study.designs:pareto_front"

    parameters: tuple[DesignParameter, ...]
    objectives: tuple[DesignObjective, ...]
    designs: FloatArray
    values: FloatArray
    given: FloatArray
    disagreement: float
    evaluations: int
    generations: int
    seed: int
    method: str
    title: str = ""
    units: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.units:
            settle(self, units=("",) * len(self.objectives))

    @property
    def compromise(self) -> int:
        """Index of the design nearest to the best of all objectives, each over its range on the front."""
        return nearest_to_best(self._sizes)

    @property
    def extremes(self) -> tuple[int, ...]:
        """Indices of the best design in each objective."""
        return tuple(int(best) for best in np.argmin(self._sizes, axis=0))

    @property
    def _sizes(self) -> FloatArray:
        return np.asarray(self.values * np.array([objective.sign for objective in self.objectives]))

    @property
    def sentences(self) -> tuple[str, ...]:
        """Result of the search in sentences, on the size of the front, best designs, compromise and verification."""
        said = [f"{len(self.designs)} designs by {self.method}, {self.evaluations} calculated, seed {self.seed}"]
        if len(self.designs) == 1:
            return (*said, "one design is the best in every objective: they do not contradict each other")
        for place, objective in enumerate(self.objectives):
            at = self.values[self.extremes[place]]
            rest = ", ".join(text for other, text in enumerate(self._value_words(at)) if other != place)
            said.append(f"the best {objective.name} is {with_unit(at[place], self.units[place])}, with {rest}")
        said.append(f"a compromise near the best of all: {', '.join(self._value_words(self.values[self.compromise]))}")
        if np.isfinite(self.disagreement):
            same = self.disagreement <= SAME_QUANTITY
            said.append(f"recomputed singly: {'the same' if same else f'different by {self.disagreement:.2g}'}")
        return tuple(said)

    def _value_words(self, values: FloatArray) -> list[str]:
        """Words for the values of each objective with their units."""
        return [
            f"{objective.name} {with_unit(value, unit)}"
            for objective, value, unit in zip(self.objectives, values, self.units, strict=True)
        ]

    def table(self) -> Table:
        """Table of the designs on the Pareto front, a row each, with parameter values and objectives in SI."""
        columns = (
            *(Column(parameter.name, parameter.unit) for parameter in self.parameters),
            *(Column(objective.name, unit) for objective, unit in zip(self.objectives, self.units, strict=True)),
        )
        rows = tuple(
            (*design, *values) for design, values in zip(self.designs.tolist(), self.values.tolist(), strict=True)
        )
        return Table.of(self.title, "best compromises", columns, rows, self.sentences)

    def to_data(self) -> dict[str, Json]:
        """Pareto front as JSON data in SI and full precision."""
        return {
            "parameters": [parameter.name for parameter in self.parameters],
            "objectives": [{"quantities": list(goal.quantities), "sense": goal.sense} for goal in self.objectives],
            "designs": self.designs.tolist(),
            "values": self.values.tolist(),
            "given": self.given.tolist(),
            "compromise": self.compromise,
            "method": self.method,
            "seed": self.seed,
            "evaluations": self.evaluations,
            "generations": self.generations,
            "sentences": list(self.sentences),
        }


def nearest_to_best(sizes: FloatArray) -> int:
    """Index of the row of an array (n, n_objectives) that is nearest to the smallest values, each over its range.

    >>> nearest_to_best(np.array([[0.0, 1.0], [0.3, 0.3], [1.0, 0.0]]))
    1
    """
    low, high = sizes.min(axis=0), sizes.max(axis=0)
    return int(np.argmin(np.linalg.norm((sizes - low) / np.where(high > low, high - low, 1.0), axis=1)))


PYMOO_NEEDED = 'fronts of compromises need pymoo: pip install "torsionnet[pareto]"'
MANY_OBJECTIVES = 3
"""Number of objectives from which reference directions (NSGA-III) spread a front better than crowding (NSGA-II)."""
MISSING_OBJECTIVE = MISSING_VALUE**2
"""Number in place of an objective that a design does not have, worse than any number in place of a quantity."""
VERIFIED_DESIGNS = 5
"""Number of designs along the front that a single model recomputes, each of which takes as long as one variant."""


def require_pymoo() -> None:
    """Raise :class:`~torsionnet.base.errors.MissingExtraError` where pymoo is not installed, without importing it."""
    if find_spec("pymoo") is None:
        raise MissingExtraError(PYMOO_NEEDED)


def pareto_front(
    problem: DesignProblem,
    *,
    population: int = 100,
    generations: int = 100,
    single: Single | None = None,
    seed: int = 0,
    title: str = "",
) -> ParetoFront:
    """Find the Pareto front of a design problem, the designs none of which another betters in every objective.

    Parameters
    ----------
    problem : DesignProblem
        Problem with two objectives or more.
    population, generations : int
        Designs in a generation, and generations; a generation is calculated as a whole.
    single : callable, optional
        Recomputes some designs by single models.
    seed : int
        Seed of the search; the same seed gives the same front.
    title : str

    Raises
    ------
    MissingExtraError
        pymoo is not installed.
    SolveError
        No design keeps the limits.
    UsageError
        Fewer than two objectives, or an unknown quantity.
    """
    if len(problem.goals.objectives) < 2:
        raise UsageError(
            "a front of compromises needs two objectives or more; for one ask for the optimum", kind="missing-entry"
        )
    if population < 4 or generations < 1:
        raise UsageError(
            f"a population of 4 or more for a generation or more, got {population} and {generations}",
            kind="out-of-range",
        )
    given = _sizes(problem, problem.at(problem.start))[0]
    # The front ends at the optima of each objective alone.
    ends = [_best_in(problem, objective, seed) for objective in problem.goals.objectives]
    method, places = _evolved(problem, ends, population, generations, seed)
    places = _best_of(problem, np.unique(np.vstack([*ends, places]), axis=0))
    # In order along the front, by the first objective.
    places = places[np.lexsort(_sizes(problem, problem.at(places)).T[::-1])]
    sizes = _sizes(problem, problem.at(places))
    signs = np.array([objective.sign for objective in problem.goals.objectives])
    designs = problem.box.inside(places)
    middle = designs[nearest_to_best(sizes)]
    return ParetoFront(
        tuple(replace(p, value=float(value)) for p, value in zip(problem.parameters, middle, strict=True)),
        problem.goals.objectives,
        designs,
        sizes * signs,
        given * signs,
        np.nan if single is None else _disagreement(problem, places, single),
        problem.evaluations,
        generations,
        seed,
        method,
        title,
        tuple(map(problem.goals.unit_of, problem.goals.objectives)),
    )


def _best_in(problem: DesignProblem, objective: DesignObjective, seed: int) -> FloatArray:
    """Point (n_p,) of the unit cube of the design that is best in one objective, an end of the Pareto front."""
    alone = replace(problem, goals=replace(problem.goals, objectives=(objective,)))
    return problem.box.place(np.array(list(optimise(alone, seed=seed).values.values())))


def _evolved(
    problem: DesignProblem, ends: list[FloatArray], population: int, generations: int, seed: int
) -> tuple[str, FloatArray]:
    """Name of the evolutionary method, and the points (n, n_p) of the unit cube on the front that it found."""
    try:
        from pymoo.algorithms.moo.nsga2 import NSGA2
        from pymoo.algorithms.moo.nsga3 import NSGA3
        from pymoo.core.problem import Problem
        from pymoo.optimize import minimize
        from pymoo.util.ref_dirs import get_reference_directions
    except ImportError:
        raise MissingExtraError(PYMOO_NEEDED) from None

    count, limited = len(problem.goals.objectives), problem.goals.excess(problem.at(problem.start)).shape[1]

    class Designs(Problem):  # type: ignore[misc]  # pymoo is not typed
        def _evaluate(self, x: FloatArray, out: dict[str, Any], *args: Any, **kwargs: Any) -> None:
            del args, kwargs
            values = problem.at(x)
            out["F"] = np.nan_to_num(_sizes(problem, values), nan=MISSING_OBJECTIVE, posinf=MISSING_OBJECTIVE)
            if limited:
                out["G"] = np.nan_to_num(problem.goals.excess(values), nan=MISSING_OBJECTIVE, posinf=MISSING_OBJECTIVE)

    size = len(problem.parameters)
    # At least as many even points as designs in the population, a power of two.
    spread = scipy.stats.qmc.Sobol(size, scramble=True, seed=seed).random(1 << population.bit_length())
    first = np.vstack([*ends, problem.start, spread])[:population]
    asked = Designs(n_var=size, n_obj=count, n_ieq_constr=limited, xl=np.zeros(size), xu=np.ones(size))
    method = "NSGA-III" if count >= MANY_OBJECTIVES else "NSGA-II"
    if count >= MANY_OBJECTIVES:
        directions = get_reference_directions("energy", count, population, seed=seed)
        algorithm = NSGA3(ref_dirs=directions, pop_size=population, sampling=first)
    else:
        algorithm = NSGA2(pop_size=population, sampling=first)
    front = minimize(asked, algorithm, ("n_gen", generations), seed=seed, verbose=False)
    if front.X is None or (np.atleast_2d(front.F) >= MISSING_OBJECTIVE).all():
        raise SolveError(
            "no design within the bounds was found that keeps all limits; widen the bounds, or relax a limit",
            kind="no-solution",
        )
    return method, np.atleast_2d(front.X)


def _best_of(problem: DesignProblem, places: FloatArray) -> FloatArray:
    """Points (k, n_p) of the designs among n that keep limits and are not dominated by another."""
    values = problem.at(places)
    kept = problem.goals.violation(values) <= FEASIBLE_EXCESS
    places, sizes = places[kept], _sizes(problem, values)[kept]
    # A design is dominated by one that is nowhere worse and somewhere better.
    no_worse = np.all(sizes[:, None] <= sizes[None], axis=2)
    better = no_worse & np.any(sizes[:, None] < sizes[None], axis=2)
    return np.asarray(places[~better.any(axis=0)])


def _sizes(problem: DesignProblem, values: Found) -> FloatArray:
    """Objectives (n, n_objectives) of n designs with signs such that all are to be small."""
    return np.stack([objective.columns(values).max(axis=1) for objective in problem.goals.objectives], axis=1)


def _disagreement(problem: DesignProblem, places: FloatArray, single: Single) -> float:
    chosen = np.unique(np.linspace(0, len(places) - 1, VERIFIED_DESIGNS).round().astype(int))
    values = problem.at(places[chosen])
    apart = 0.0
    for row, place in enumerate(places[chosen]):
        alone = single(problem.values(place))
        for name in problem.goals.quantities:
            own = np.atleast_1d(np.asarray(alone[name], float))
            apart = max(apart, float(np.max(np.abs(values[name][row] - own) / max(float(np.abs(own).max()), 1e-300))))
    return apart


@register_answer
@dataclass(frozen=True, kw_only=True)
class Pareto(DesignAnswer):
    """Designs none of which another betters in every quantity (Pareto front), by non-dominated sorting (pymoo)."""

    kind: ClassVar[str] = "pareto"

    minimise: tuple[str, ...] = entry(OneOrSeveral("what is to be small, each for itself", NAMES), ())
    maximise: tuple[str, ...] = entry(OneOrSeveral("what is to be large, each for itself", NAMES), ())
    population: int = entry(Count("designs of a generation", lower=4, upper=100_000), 100)
    generations: int = entry(Count("how often they evolve", lower=1, upper=100_000), 100)

    def require_extras(self) -> None:

        require_pymoo()

    def contradictions(self) -> list[Fault]:
        if len(self.minimise) + len(self.maximise) < 2:
            text = "a front needs two quantities or more under minimise and maximise; for one there is type: optimum"
            return [Fault(text, on_key=True, kind="missing-entry")]
        return []

    def goals(self, limits: Mapping[str, QuantityLimit]) -> DesignGoals:
        objectives = [DesignObjective((name,)) for name in self.minimise]
        objectives += [DesignObjective((name,), "maximise") for name in self.maximise]
        return DesignGoals(objectives=tuple(objectives), limits=limits)

    def conclude(self, study: AskedStudy, result: VariantValues) -> ParetoFront:
        del result

        problem, quantities = self.problem(study)
        return pareto_front(
            problem,
            population=self.population,
            generations=self.generations,
            single=quantities.singly,
            seed=self.seed,
            title=study.title,
        )
