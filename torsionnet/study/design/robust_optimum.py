"""Robust optimum, an answer of a study, the best design under the study's tolerances."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import scipy

from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, Json, OneOf, entry
from torsionnet.base.errors import Fault, UsageError
from torsionnet.base.table import Column, Table
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer import AskedStudy, DrawnConclusion, VariantValues, register_answer
from torsionnet.study.design.design_goals import DesignOptimum, with_unit
from torsionnet.study.design.design_problem import DesignProblem
from torsionnet.study.design.optimise import Single, optimise
from torsionnet.study.design.optimum import SingleDesign
from torsionnet.study.design.robust_problem import (
    EXCESS,
    MeanAndDeviation,
    Rejects,
    RobustMeasure,
    RobustQuantities,
    SamplePercentile,
    Tolerances,
    even_shares,
    random_shares,
    robust_problem,
)
from torsionnet.study.space.space import Space

# Search of a robust design, the best under tolerances, and its comparison with the nominal optimum.

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


@dataclass(frozen=True, eq=False, repr=False)
class RobustOptimum(DrawnConclusion):
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

    drawing: ClassVar[str] = "torsionnet.plot.study.designs:robust_optimum"

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
            sizes = ", ".join(f"{design.label} {with_unit(design.measures[name], unit)}" for design in self.designs)
            said.append(f"{name}: {sizes}")
        if self.limited:
            for design in self.designs:
                share, low, high = design.share_kept
                said.append(
                    f"{design.label}: {100 * share:.4g} % keep all limits ({100 * low:.4g} to {100 * high:.4g} %, "
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
        columns = (Column(""), Column("unit"), *(Column(design.label) for design in self.designs))
        rows: list[tuple[object, ...]] = [
            (parameter.name, parameter.unit, *(design.values[parameter.name] for design in self.designs))
            for parameter in self.robust.parameters
        ]
        for what in ("mean", "deviation"):
            for name in getattr(self.designs[0], what):
                word = "mean of" if what == "mean" else "standard deviation of"
                rows.append(
                    (f"{word} {name}", self._unit(name), *(getattr(design, what)[name] for design in self.designs))
                )
        rows += [
            (name, self._unit(name), *(design.measures[name] for design in self.designs)) for name in self.robust.after
        ]
        if self.limited:
            rows.append(("share that keeps all limits", "", *(design.share_kept[0] for design in self.designs)))
        return Table.of(self.title, "robust optimum", columns, tuple(rows), self.sentences)

    def to_data(self) -> dict[str, Json]:
        """Robust design and the statistics of the designs as JSON data in SI and full precision."""
        return {
            "values": self.values,
            "samples": self.samples,
            "seed": self.seed,
            "designs": [
                {
                    "label": design.label,
                    "values": design.values,
                    "measures": design.measures,
                    "mean": design.mean,
                    "deviation": design.deviation,
                    "kept": design.kept,
                    "count": design.count,
                }
                for design in self.designs
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
    tolerances : Tolerances
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
        raise UsageError(
            "a robust design has one objective; of several ask for the front of compromises",
            kind="contradicting-entries",
        )
    # The search draws evenly; the comparison takes random draws that no design was chosen on.
    drawn = tolerances.even_draws(samples, seed)
    asked = robust_problem(problem, drawn, measure)
    nominal = None
    if problem.goals.targets or problem.goals.objectives:
        nominal = optimise(problem, single=single, seed=seed, title=title)
        # From the nominal optimum on, so that the robust one is never worse.
        begun = tuple(replace(parameter, start=nominal.values[parameter.name]) for parameter in asked.parameters)
        asked = replace(asked, parameters=begun)
    robust = optimise(asked, seed=seed, generations=ROBUST_GENERATIONS, title=title)
    judged = RobustQuantities(problem, tolerances.random_draws(compared, seed + COMPARISON_SEED_OFFSET), measure)
    given = {parameter.name: parameter.start for parameter in problem.parameters}
    labelled = {"as given": given, "nominal": nominal.values if nominal else None, "robust": robust.values}
    designs = tuple(_judged(judged, label, values) for label, values in labelled.items() if values is not None)
    return RobustOptimum(robust, nominal, designs, bool(problem.goals.limits), drawn.count, seed, title)


def _judged(judged: RobustQuantities, label: str, values: dict[str, float]) -> ScatteredDesign:
    design = {name: np.array([value]) for name, value in values.items()}
    samples = judged.samples(design)
    shown = [name for name, _, _ in judged.wanted() if name != EXCESS]
    kept: FloatArray = samples[EXCESS][0] if EXCESS in samples else np.full(judged.tolerances.count, -1.0)
    return ScatteredDesign(
        label,
        values,
        {name: float(own[0]) for name, own in judged(design).items()},
        {name: float(samples[name].mean()) for name in shown},
        {name: float(samples[name].std()) for name in shown},
        int(np.sum(kept <= 0)),
        judged.tolerances.count,
    )


@dataclass(frozen=True, eq=False)
class SpaceDraws:
    """Draws of the tolerances of a study for a robust design; those of a designed parameter are scaled with its value.

    Attributes
    ----------
    drawn : mapping
        Parameter -> values (count,) around the model as it stands.
    nominal : mapping
        Parameter -> value in the model.
    """

    drawn: Mapping[str, FloatArray]
    nominal: Mapping[str, float]

    @property
    def count(self) -> int:
        """Number of samples drawn around each design."""
        return len(next(iter(self.drawn.values())))

    def around(self, designs: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """Values (n * count,) in SI of each parameter, by name, around n designs, the first design's samples first."""
        size = len(next(iter(designs.values())))
        samples = {name: np.repeat(values, self.count) for name, values in designs.items()}
        for name, drawn in self.drawn.items():
            if name in designs:
                # A tolerance scales with the design: draws are about the value of the model.
                samples[name] = np.outer(designs[name] / self.nominal[name], drawn).ravel()
            else:
                samples[name] = np.tile(drawn, size)
        return samples


@dataclass(frozen=True, eq=False)
class SpaceTolerances:
    """Tolerances of a study, its distributions around the model, with their correlation."""

    space: Space
    designed: tuple[str, ...]

    def __post_init__(self) -> None:
        if not self.space.random_names:
            raise UsageError(
                "a robust design needs the tolerance of a parameter: a distribution under vary", kind="nothing-varies"
            )
        for name in self.designed:
            if name in self.space.random_names and not self.space.nominal[name] > 0:
                raise UsageError(
                    f"{name} is {self.space.nominal[name]:g} in the model, and a tolerance scales with "
                    "it; give it a value above 0",
                    kind="out-of-range",
                )

    def even_draws(self, count: int, seed: int) -> SpaceDraws:
        """Quasi-random draws of the study's tolerances by a scrambled Sobol sequence.

        ``count`` is rounded up to a power of two.
        """
        return self._drawn(even_shares(len(self.space.random_names), count, seed))

    def random_draws(self, count: int, seed: int) -> SpaceDraws:
        """Independent random draws of the study's tolerances."""
        return self._drawn(random_shares(len(self.space.random_names), count, seed))

    def _drawn(self, shares: FloatArray) -> SpaceDraws:
        return SpaceDraws(self.space.from_unit(shares), self.space.nominal)


DEVIATION, PERCENTILE, REJECTS = "mean and deviation", "percentile", "rejects"
DEFAULT_K, DEFAULT_PERCENTILE = 3.0, 0.95
"""Standard deviations added to the mean (3 by default), and share of samples within the percentile (0.95)."""


@register_answer
@dataclass(frozen=True, kw_only=True)
class RobustDesign(SingleDesign):
    """Values of parameters that are best when all that varies in the study scatters around them.

    The tolerance of a parameter that is chosen moves with it in proportion. Made small is the mean and ``k`` standard
    deviations of a quantity, its percentile, or the share of rejects, which exceed a limit.
    """

    kind: ClassVar[str] = "robust_optimum"

    measure: str = entry(OneOf("what is made small over samples", (DEVIATION, PERCENTILE, REJECTS)), DEVIATION)
    k: float | None = entry(Value("standard deviations that are added to the mean; default: 3", "1"), None)
    percentile: float | None = entry(
        Value("share of samples that must not be worse; default: 95 %", "1", exclusive=True), None
    )
    samples: int = entry(Count("of the tolerances around every design", lower=2, upper=1_000_000), 256)
    compared: int = entry(Count("samples by which designs are compared in the end", lower=2, upper=10_000_000), 4096)

    @property
    def needs_goal(self) -> bool:
        return self.measure != REJECTS

    def contradictions(self) -> list[Fault]:
        faults = super().contradictions()
        for name, owner in (("k", DEVIATION), ("percentile", PERCENTILE)):
            if getattr(self, name) is not None and self.measure != owner:
                faults.append(Fault(f"{name} belongs to measure: {owner}", (name,), on_key=True, kind="needless-entry"))
        if self.percentile is not None and not self.percentile < 1:
            faults.append(Fault("a percentile lies between 0 and 100 %", ("percentile",), kind="out-of-range"))
        return faults

    def study_faults(self, study: AskedStudy) -> Iterator[Fault]:
        yield from super().study_faults(study)
        if not self.design:
            yield Fault(
                "say which parameters are chosen, as design: {k_1: [low, high]}", on_key=True, kind="missing-entry"
            )
        if not study.space.random_names:
            yield Fault(
                "a robust design needs a parameter with a distribution under vary", on_key=True, kind="nothing-varies"
            )
        if self.measure == REJECTS and not (self.limits or study.limits):
            yield Fault("rejects are what exceeds limits: give limits", ("measure",), kind="missing-entry")
        for name in self.design:
            if name in study.space.random_names and not study.space.nominal[name] > 0:
                text = f"{name} is not above 0 in the model, and a tolerance scales with it"
                yield Fault(
                    f"{text}; give it a value above 0, or leave it out of design", ("design", name), kind="out-of-range"
                )

    def conclude(self, study: AskedStudy, result: VariantValues) -> RobustOptimum:
        del result

        problem, quantities = self.problem(study, study.space.names)
        return robust_optimum(
            problem,
            SpaceTolerances(study.space, problem.names),
            self._measure(),
            samples=self.samples,
            compared=self.compared,
            single=quantities.singly,
            seed=self.seed,
            title=study.title,
        )

    def _measure(self) -> RobustMeasure:
        if self.measure == DEVIATION:
            return MeanAndDeviation(DEFAULT_K if self.k is None else self.k)
        return (
            SamplePercentile(100 * (self.percentile or DEFAULT_PERCENTILE)) if self.measure == PERCENTILE else Rejects()
        )
