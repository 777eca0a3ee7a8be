"""Failure probability, an answer of a study, the small probability that a limit is exceeded."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, OneOf, Text, entry
from torsionnet.base.errors import Fault
from torsionnet.base.table import Column, Table
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer import (
    LIMIT,
    AnswerCase,
    AskedStudy,
    OfPoints,
    PlainConclusion,
    StudyAnswer,
    VariantValues,
    answer_cases,
    distribution_faults,
    limit_faults,
    limit_words,
    register_answer,
)
from torsionnet.study.answers.importance_sampling import FEWEST_VARIANTS, importance_sampling
from torsionnet.study.answers.subset_sampling import CHAIN_LENGTH, RareEvent, subset_sampling
from torsionnet.study.quantities.quantity import QuantityLimit


def failure_margin(case: AnswerCase, limits: dict[str, QuantityLimit]) -> OfPoints:
    """Function from points (n, d) in standard normal space to safety margins (n,), the smallest distance to a limit."""
    names = tuple(limits)

    def margin(points: FloatArray) -> FloatArray:
        values = case.calculated(case.space.from_standard_normal(points), names)
        # Limits in series: a variant fails where it passes any of them.
        return np.asarray(np.min([limit_distance(limits[name], values[name]) for name in names], axis=0))

    return margin


def limit_distance(limit: QuantityLimit, values: FloatArray) -> FloatArray:
    """Relative distance (n,) of values (n,), or of the worst point of curves (n, n_points), to their nearer limit.

    Negative beyond the limit, NaN without a value.

    Examples
    --------
    >>> import numpy as np
    >>> limit_distance(QuantityLimit(below=4.0, above=1.0), np.array([2.0, 5.0])).tolist()
    [0.25, -0.25]
    """
    sides = [(1, limit.above), (-1, limit.below)]
    size = max(abs(side) for _, side in sides if side is not None) or 1.0
    distances = np.min([sign * (values - side) / size for sign, side in sides if side is not None], axis=0)
    return np.asarray(distances if distances.ndim == 1 else distances.min(axis=1))


IMPORTANCE, SUBSET = "importance", "subset"
DEFAULT_COUNT = {IMPORTANCE: 100_000, SUBSET: 1000}
"""Number of variants by sampling method, for "importance" the most of all, for "subset" those of a level in a run."""


@register_answer
@dataclass(frozen=True, kw_only=True)
class FailureProbability(StudyAnswer):
    """Probability that any of the limits is exceeded, however small, in each configuration.

    Importance sampling draws around the points where failures are most likely, and suits up to some tens of parameters
    and limits that are crossed in few places; it says when it finds itself wrong there. Subset sampling assumes nothing
    but takes more variants, about 20 times ``count`` for every power of ten.
    """

    kind: ClassVar[str] = "failure_probability"
    of_variants: ClassVar[bool] = False
    naming: ClassVar[Mapping[str, str]] = {"limits": LIMIT}

    limits: tuple[str, ...] = entry(Listed("quantities whose limits count; default: all", Text("quantity")), None)
    method: str = entry(OneOf("how variants are chosen", (IMPORTANCE, SUBSET)), IMPORTANCE)
    count: int | None = entry(
        Count("most variants (importance; default: 100000), or those of a level in each of 20 runs (subset; 1000)",
              lower=200, upper=10**9), None,
    )  # fmt: skip
    accuracy: float = entry(
        Value("standard error over the probability at which importance sampling stops", "1", exclusive=True, below=1),
        0.01,
    )
    seed: int = entry(Count("another seed draws other variants", lower=0, upper=2**32 - 1), 1)
    confidence: float = entry(Value("of the interval", "1", exclusive=True, below=1), 0.95)

    def contradictions(self) -> list[Fault]:
        if self.count is None:
            return []
        if self.method == IMPORTANCE and self.count < FEWEST_VARIANTS:
            return [
                Fault(
                    f"importance sampling needs {FEWEST_VARIANTS} variants or more, got {self.count}",
                    ("count",),
                    kind="out-of-range",
                )
            ]
        if self.method == SUBSET and self.count % CHAIN_LENGTH:
            return [
                Fault(
                    f"the variants of a level are a multiple of {CHAIN_LENGTH}, got {self.count}",
                    ("count",),
                    kind="out-of-range",
                )
            ]
        return []

    def study_faults(self, study: AskedStudy) -> Iterator[Fault]:
        yield from limit_faults(study)
        yield from distribution_faults(study)

    def conclude(self, study: AskedStudy, result: VariantValues | None = None) -> FailureProbabilityResult:
        del result
        names = self.limits or tuple(study.limits)
        events = {}
        for case in answer_cases(study):
            margin = failure_margin(case, {name: study.limits[name] for name in names})
            events[case.label] = self._sampled(margin, len(case.space.random_names))
        return FailureProbabilityResult(
            study.title, " or ".join(limit_words(study, name) for name in names), events, self.confidence
        )

    def _sampled(self, margin: OfPoints, n_parameters: int) -> RareEvent:
        count = self.count or DEFAULT_COUNT[self.method]
        if self.method == SUBSET:
            return subset_sampling(margin, n_parameters, count=count, seed=self.seed, confidence=self.confidence)
        return importance_sampling(
            margin, n_parameters, count=count, seed=self.seed, accuracy=self.accuracy, confidence=self.confidence
        )


@dataclass(frozen=True, eq=False, repr=False)
class FailureProbabilityResult(PlainConclusion):
    """Failure probability with its interval in each configuration."""

    drawing: ClassVar[str] = "torsionnet.plot.study.distributions:failure_probabilities"

    title: str
    beyond: str
    events: Mapping[str, RareEvent]
    confidence: float

    @property
    def sentences(self) -> tuple[str, ...]:
        said = []
        for case, event in self.events.items():
            said.append(f"{self.beyond}, {case}: probability {event.words}")
            said += [f"{case}: not to be trusted: {reason}" for reason in event.doubts]
        return tuple(said)

    def table(self) -> Table:
        columns = (
            Column("configuration"), Column("probability", digits=4), Column("from", digits=4), Column("to", digits=4),
            Column("reliability index", digits=4), Column("variants"), Column("method"), Column("trusted"),
        )  # fmt: skip
        rows = tuple(
            (case, event.probability, event.low, event.high, event.index if event.probability else None,
             event.evaluations, event.method, "no" if event.doubts else "yes")
            for case, event in self.events.items()
        )  # fmt: skip
        note = f"that {self.beyond}; intervals {100 * self.confidence:g} %"
        return Table.of(self.title, "failure probability", columns, rows, (note, *self.sentences))
