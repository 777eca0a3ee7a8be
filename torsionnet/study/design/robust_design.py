"""Search of a robust design, the best under tolerances, and its comparison with the nominal optimum."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import ModuleType
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import scipy

from torsionnet.base.entries.spec import Json
from torsionnet.base.errors import UsageError
from torsionnet.base.table import Column, Table
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.design.design_goals import with_unit
from torsionnet.study.design.design_optimum import DesignOptimum
from torsionnet.study.design.design_problem import DesignProblem
from torsionnet.study.design.design_tolerances import Tolerances
from torsionnet.study.design.optimise import Single, optimise
from torsionnet.study.design.robust_problem import EXCESS, RobustMeasure, RobustQuantities, robust_problem

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CONFIDENCE = 0.95
"""Confidence of the interval of the share of samples that keeps all limits, the usual choice."""
ROBUST_GENERATIONS = 20
"""Most generations of a population of robust designs, few because each member takes many samples."""
COMPARISON_SEED_OFFSET = 1000
"""Number added to the seed for the draws of the final comparison, which must differ from those of the search."""


@dataclass(frozen=True, eq=False)
class ScatteredDesign:
    """Statistics of a design under tolerances, by draws on which the design was not chosen.

    Attributes
    ----------
    label : str
    values : mapping
        Parameter -> value, SI.
    measures : mapping
        Name of a robust measure (minimised or limited) -> its value.
    mean, deviation : mapping
        Objective -> mean and standard deviation over samples.
    kept : int
        Number of samples that keep all limits.
    count : int
    """

    label: str
    values: dict[str, float]
    measures: dict[str, float]
    mean: dict[str, float]
    deviation: dict[str, float]
    kept: int
    count: int

    @property
    def share_kept(self) -> tuple[float, float, float]:
        """Share of samples that keep all limits, and low and high end of its interval of 95 % confidence."""
        interval = scipy.stats.binomtest(self.kept, self.count).proportion_ci(CONFIDENCE, method="exact")
        return self.kept / self.count, float(interval.low), float(interval.high)


@dataclass(frozen=True, eq=False)
class RobustOptimum:
    """Best design under tolerances, with the nominal optimum for comparison.

    Attributes
    ----------
    robust : DesignOptimum
        Robust design, whose quantities are measures over samples.
    nominal : DesignOptimum or None
        Best design without tolerances; None where only rejects are minimised.
    designs : tuple of ScatteredDesign
        Statistics of the designs as given, nominal and robust.
    limited : bool
        Whether there are limits.
    samples, seed : int
        Number of samples on which the design was chosen, and their seed.
    title : str
    """

    robust: DesignOptimum
    nominal: DesignOptimum | None
    designs: tuple[ScatteredDesign, ...]
    limited: bool
    samples: int
    seed: int
    title: str = ""

    @property
    def values(self) -> dict[str, float]:
        """Value in SI of each parameter of the robust design, by its name."""
        return self.robust.values

    @property
    def sentences(self) -> tuple[str, ...]:
        """Result of the search in sentences, on measures of the designs, shares that keep limits, and samples."""
        said = []
        for name in self.robust.after:
            unit = self._unit(name)
            sizes = ", ".join(f"{one.label} {with_unit(one.measures[name], unit)}" for one in self.designs)
            said.append(f"{name}: {sizes}")
        if self.limited:
            for one in self.designs:
                share, low, high = one.share_kept
                said.append(
                    f"{one.label}: {100 * share:.4g} % keep all limits ({100 * low:.4g} to {100 * high:.4g} %, "
                    f"{100 * CONFIDENCE:g} % confidence)"
                )
        said.append(f"chosen on {self.samples} samples (seed {self.seed}), compared on {self.designs[0].count} others")
        for about, sentence in self.robust.conclusions[1:]:
            said.append(f"on the samples it was chosen on, {sentence}" if about == "limits" else sentence)
        return tuple(said)

    def _unit(self, name: str) -> str:
        return self.robust.goals.units.get(name, "")

    def table(self) -> Table:
        """Table of a robust design with a row for each parameter and measure, a column for each design compared."""
        columns = (Column(""), Column("unit"), *(Column(one.label) for one in self.designs))
        rows: list[tuple[object, ...]] = [
            (one.name, one.unit, *(design.values[one.name] for design in self.designs))
            for one in self.robust.parameters
        ]
        for what in ("mean", "deviation"):
            for name in getattr(self.designs[0], what):
                word = "mean of" if what == "mean" else "standard deviation of"
                rows.append(
                    (f"{word} {name}", self._unit(name), *(getattr(design, what)[name] for design in self.designs))
                )
        rows += [(name, self._unit(name), *(one.measures[name] for one in self.designs)) for name in self.robust.after]
        if self.limited:
            rows.append(("share that keeps all limits", "", *(one.share_kept[0] for one in self.designs)))
        return Table.of(self.title, "robust optimum", columns, tuple(rows), self.sentences)

    def figure(self, plot: ModuleType, **look: Any) -> Figure:
        """Draw the compared designs as a figure by :mod:`torsionnet.plot`."""
        return cast("Figure", plot.robust_optimum(self, **look))

    def to_data(self) -> dict[str, Json]:
        """Robust design and the statistics of the designs as JSON data in SI and full precision."""
        return {
            "values": self.values,
            "samples": self.samples,
            "seed": self.seed,
            "designs": [
                {
                    "label": one.label,
                    "values": one.values,
                    "measures": one.measures,
                    "mean": one.mean,
                    "deviation": one.deviation,
                    "kept": one.kept,
                    "count": one.count,
                }
                for one in self.designs
            ],
            "robust": self.robust.to_data(),
            "nominal": None if self.nominal is None else self.nominal.to_data(),
            "sentences": list(self.sentences),
        }


def robust_optimum(
    problem: DesignProblem,
    tolerances: Tolerances,
    measure: RobustMeasure,
    *,
    samples: int = 256,
    compared: int = 4096,
    single: Single | None = None,
    seed: int = 0,
    title: str = "",
) -> RobustOptimum:
    """Find the design that is best under tolerances, and compare it with the nominal optimum.

    Parameters
    ----------
    problem : DesignProblem
        Problem with one objective, with targets (whose mean squared deviation is minimised), or with limits alone for
        :class:`~torsionnet.study.design.robust_problem.Rejects`.
    tolerances : DesignTolerances or SpaceTolerances
    measure : RobustMeasure
    samples : int
        Draws around every design, the same for all, rounded up to a power of two.
    compared : int
        Number of independent draws of the final comparison of the designs.
    single : callable, optional
        Recomputes the nominal optimum by a single model.
    seed : int
    title : str

    Raises
    ------
    UsageError
        Tolerances, measure or goals that make no sense, or several objectives.
    """
    if len(problem.goals.objectives) > 1:
        raise UsageError("a robust design has one objective; of several ask for the front of compromises")
    drawn = tolerances.even_draws(samples, seed)
    asked = robust_problem(problem, drawn, measure)
    nominal = None
    if problem.goals.targets or problem.goals.objectives:
        nominal = optimise(problem, single=single, seed=seed, title=title)
        asked = _from_nominal(asked, nominal)
    robust = optimise(asked, seed=seed, generations=ROBUST_GENERATIONS, title=title)
    judged = RobustQuantities(problem, tolerances.random_draws(compared, seed + COMPARISON_SEED_OFFSET), measure)
    given = {one.name: one.start for one in problem.parameters}
    labelled = {"as given": given, "nominal": nominal.values if nominal else None, "robust": robust.values}
    designs = tuple(_judged(judged, label, values) for label, values in labelled.items() if values is not None)
    return RobustOptimum(robust, nominal, designs, bool(problem.goals.limits), drawn.count, seed, title)


def _from_nominal(asked: DesignProblem, nominal: DesignOptimum) -> DesignProblem:
    """Copy of the robust design problem that starts at the nominal optimum, so that its solution is never worse."""
    begun = tuple(replace(one, start=nominal.values[one.name]) for one in asked.parameters)
    return replace(asked, parameters=begun)


def _judged(judged: RobustQuantities, label: str, values: dict[str, float]) -> ScatteredDesign:
    design = {name: np.array([value]) for name, value in values.items()}
    samples = judged.samples(design)
    shown = [name for name, _, _ in judged.wanted() if name != EXCESS]
    kept: FloatArray = samples[EXCESS][0] if EXCESS in samples else np.full(judged.tolerances.count, -1.0)
    return ScatteredDesign(
        label,
        values,
        {name: float(one[0]) for name, one in judged(design).items()},
        {name: float(samples[name].mean()) for name in shown},
        {name: float(samples[name].std()) for name in shown},
        int(np.sum(kept <= 0)),
        judged.tolerances.count,
    )
