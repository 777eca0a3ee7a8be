"""Robust optimum, an answer of a study, the best design under the study's tolerances."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, OneOf, entry
from torsionnet.base.errors import Fault, UsageError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer import AskedStudy, VariantValues, register_answer
from torsionnet.study.design.design_tolerances import even_shares, random_shares
from torsionnet.study.design.optimum import SingleDesign
from torsionnet.study.design.robust_design import RobustOptimum
from torsionnet.study.design.robust_problem import MeanAndDeviation, Rejects, RobustMeasure, SamplePercentile
from torsionnet.study.space.space import Space


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
        found = {name: np.repeat(values, self.count) for name, values in designs.items()}
        for name, drawn in self.drawn.items():
            if name in designs:
                found[name] = np.outer(designs[name] / self.nominal[name], drawn).ravel()
            else:
                found[name] = np.tile(drawn, size)
        return found


@dataclass(frozen=True, eq=False)
class SpaceTolerances:
    """Tolerances of a study, its distributions around the model, with their correlation."""

    space: Space
    designed: tuple[str, ...]

    def __post_init__(self) -> None:
        if not self.space.random_names:
            raise UsageError("a robust design needs the tolerance of a parameter: a distribution under vary")
        for name in self.designed:
            if name in self.space.random_names and not self.space.nominal[name] > 0:
                raise UsageError(
                    f"{name} is {self.space.nominal[name]:g} in the model, and a tolerance scales with "
                    "it; give it a value above 0"
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
                faults.append(Fault(f"{name} belongs to measure: {owner}", (name,), on_key=True))
        if self.percentile is not None and not self.percentile < 1:
            faults.append(Fault("a percentile lies between 0 and 100 %", ("percentile",)))
        return faults

    def study_faults(self, study: AskedStudy) -> Iterator[Fault]:
        yield from super().study_faults(study)
        if not self.design:
            yield Fault("say which parameters are chosen, as design: {k_1: [low, high]}", on_key=True)
        if not study.space.random_names:
            yield Fault("a robust design needs a parameter with a distribution under vary", on_key=True)
        if self.measure == REJECTS and not (self.limits or study.limits):
            yield Fault("rejects are what exceeds limits: give limits", ("measure",))
        for name in self.design:
            if name in study.space.random_names and not study.space.nominal[name] > 0:
                text = f"{name} is not above 0 in the model, and a tolerance scales with it"
                yield Fault(f"{text}; give it a value above 0, or leave it out of design", ("design", name))

    def conclude(self, study: AskedStudy, result: VariantValues) -> RobustOptimum:
        del result
        from torsionnet.study.design.robust_design import robust_optimum

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
