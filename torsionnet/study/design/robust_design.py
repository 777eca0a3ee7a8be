"""The design that is best when its parameters scatter, beside the one that is best on paper."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import ModuleType
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from scipy.stats import binomtest

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.entries.spec import Json
from torsionnet.core.errors import UsageError
from torsionnet.response.table import Column, Table
from torsionnet.study.design.design_goals import in_words
from torsionnet.study.design.design_optimum import DesignOptimum
from torsionnet.study.design.design_problem import DesignProblem
from torsionnet.study.design.design_tolerances import Tolerances
from torsionnet.study.design.optimise import Single, optimise
from torsionnet.study.design.robust_problem import EXCESS, Robustly, RobustMeasure, robust_problem

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CONFIDENCE = 0.95
GENERATIONS = 20
"""Of a population whose every member is many samples."""
FRESH = 1000
"""Added to the seed for the draws by which designs are compared in the end."""


@dataclass(frozen=True, eq=False)
class ScatteredDesign:
    """A design under tolerances, by draws on which it was not chosen.

    Attributes
    ----------
    label : str
    values : mapping
        SI.
    measures : mapping
        What was made small under tolerances, and what limits hold for.
    mean, deviation : mapping
        Of objectives, over samples.
    kept : int
        Samples that keep all limits.
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
        """Share of samples that keep all limits, and its interval of 95 % confidence (Clopper and Pearson)."""
        interval = binomtest(self.kept, self.count).proportion_ci(CONFIDENCE, method="exact")
        return self.kept / self.count, float(interval.low), float(interval.high)


@dataclass(frozen=True, eq=False)
class RobustOptimum:
    """The best design under tolerances.

    Attributes
    ----------
    robust : DesignOptimum
        Its quantities are measures over samples.
    nominal : DesignOptimum or None
        The best design without tolerances; None where only rejects are made few.
    designs : tuple of ScatteredDesign
        As given, nominal, robust.
    limited : bool
        Whether there are limits.
    samples, seed : int
        By which the design was chosen.
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
        """Value by parameter, SI."""
        return self.robust.values

    @property
    def sentences(self) -> tuple[str, ...]:
        """What was found."""
        said = []
        for name in self.robust.after:
            unit = self._unit(name)
            sizes = ", ".join(f"{one.label} {in_words(one.measures[name], unit)}" for one in self.designs)
            said.append(f"{name}: {sizes}")
        if self.limited:
            for one in self.designs:
                share, low, high = one.share_kept
                said.append(
                    f"{one.label}: {100 * share:.4g} % keep all limits ({100 * low:.4g} to {100 * high:.4g} %, "
                    f"{100 * CONFIDENCE:g} % confidence)"
                )
        said.append(f"chosen on {self.samples} samples (seed {self.seed}), compared on {self.designs[0].count} others")
        return (*said, *map(_on_samples, self.robust.sentences[1:]))

    def _unit(self, name: str) -> str:
        return self.robust.goals.units.get(name, "")

    def table(self) -> Table:
        """A row for each parameter and measure, a column for each design."""
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
        return Table(f"{self.title}: robust optimum".removeprefix(": "), columns, tuple(rows), self.sentences)

    def figure(self, plot: ModuleType, **look: Any) -> Figure:
        """As a picture, by :mod:`torsionnet.plot`."""
        return cast("Figure", plot.robust_optimum(self, **look))

    def to_data(self) -> dict[str, Json]:
        """In full precision, for JSON."""
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
    """Search the design that is best under tolerances.

    Parameters
    ----------
    problem : DesignProblem
        With one objective, with targets (whose mean squared deviation is made small), or with limits alone for
        :class:`~torsionnet.study.design.robust_problem.Rejects`.
    tolerances : DesignTolerances or SpaceTolerances
    measure : RobustMeasure
    samples : int
        Draws around every design, the same for all, rounded up to a power of two.
    compared : int
        Independent draws by which the designs are compared in the end.
    single : callable, optional
        Recomputes the nominal optimum by one model.
    seed : int
    title : str

    Raises
    ------
    UsageError
        Tolerances, measure or goals that make no sense, or several objectives.
    """
    if len(problem.goals.objectives) > 1:
        raise UsageError("a robust design has one objective; of several ask for the front of compromises")
    drawn = tolerances.evenly(samples, seed)
    asked = robust_problem(problem, drawn, measure)
    nominal = None
    if problem.goals.targets or problem.goals.objectives:
        nominal = optimise(problem, single=single, seed=seed, title=title)
        asked = _from_nominal(asked, nominal)
    robust = optimise(asked, seed=seed, generations=GENERATIONS, title=title)
    judged = Robustly(problem, tolerances.randomly(compared, seed + FRESH), measure)
    given = {one.name: one.start for one in problem.parameters}
    labelled = {"as given": given, "nominal": nominal.values if nominal else None, "robust": robust.values}
    designs = tuple(_judged(judged, label, values) for label, values in labelled.items() if values is not None)
    return RobustOptimum(robust, nominal, designs, bool(problem.goals.limits), drawn.count, seed, title)


def _on_samples(said: str) -> str:
    """What is said of limits holds for the samples that the design was chosen on; on others they may be exceeded."""
    of_limits = said.startswith(("limits are kept", "no design within the bounds"))
    return f"on the samples it was chosen on, {said}" if of_limits else said


def _from_nominal(asked: DesignProblem, nominal: DesignOptimum) -> DesignProblem:
    """Searched from the nominal optimum, so that what is found is never worse than that on the same samples."""
    begun = tuple(replace(one, start=nominal.values[one.name]) for one in asked.parameters)
    return replace(asked, parameters=begun)


def _judged(judged: Robustly, label: str, values: dict[str, float]) -> ScatteredDesign:
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
