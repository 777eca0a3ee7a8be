"""Pareto front of a search with several objectives, its designs, their objectives and checks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from torsionnet.base.entries.spec import Json
from torsionnet.base.registers import settle
from torsionnet.base.table import Column, Table
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.machinery.design.damper_optimum import DesignParameter
from torsionnet.study.design.design_goals import DesignObjective, with_unit
from torsionnet.study.design.design_optimum import SAME_QUANTITY

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class ParetoFront:
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
        return np.asarray(self.values * np.array([one.sign for one in self.objectives]))

    def design(self, index: int) -> Mapping[str, float]:
        """Value in SI of each parameter of one design, by its name, for :meth:`torsionnet.Drivetrain.configured`."""
        return {one.name: float(value) for one, value in zip(self.parameters, self.designs[index], strict=True)}

    @property
    def sentences(self) -> tuple[str, ...]:
        """Result of the search in sentences, on the size of the front, best designs, compromise and verification."""
        said = [f"{len(self.designs)} designs by {self.method}, {self.evaluations} calculated, seed {self.seed}"]
        if len(self.designs) == 1:
            return (*said, "one design is the best in every objective: they do not contradict each other")
        for place, one in enumerate(self.objectives):
            at = self.values[self.extremes[place]]
            rest = ", ".join(text for other, text in enumerate(self._value_words(at)) if other != place)
            said.append(f"the best {one.name} is {with_unit(at[place], self.units[place])}, with {rest}")
        said.append(f"a compromise near the best of all: {', '.join(self._value_words(self.values[self.compromise]))}")
        if np.isfinite(self.disagreement):
            same = self.disagreement <= SAME_QUANTITY
            said.append(f"recomputed singly: {'the same' if same else f'different by {self.disagreement:.2g}'}")
        return tuple(said)

    def _value_words(self, values: FloatArray) -> list[str]:
        """Words for the values of each objective with their units."""
        return [
            f"{one.name} {with_unit(value, unit)}"
            for one, value, unit in zip(self.objectives, values, self.units, strict=True)
        ]

    def table(self) -> Table:
        """Table of the designs on the Pareto front, a row each, with parameter values and objectives in SI."""
        columns = (
            *(Column(one.name, one.unit) for one in self.parameters),
            *(Column(one.name, unit) for one, unit in zip(self.objectives, self.units, strict=True)),
        )
        rows = tuple(
            (*design, *values) for design, values in zip(self.designs.tolist(), self.values.tolist(), strict=True)
        )
        return Table.of(self.title, "best compromises", columns, rows, self.sentences)

    def figure(self, plot: ModuleType, **look: Any) -> Figure:
        """Draw the Pareto front as a figure by :mod:`torsionnet.plot`."""
        return cast("Figure", plot.pareto_front(self, **look))

    def to_data(self) -> dict[str, Json]:
        """Pareto front as JSON data in SI and full precision."""
        return {
            "parameters": [one.name for one in self.parameters],
            "objectives": [{"quantities": list(one.quantities), "sense": one.sense} for one in self.objectives],
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
