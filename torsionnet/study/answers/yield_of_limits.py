"""The answer ``type: yield``: how many variants keep the limits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.core.entries.composite import Listed, Named
from torsionnet.core.entries.scalars import Value
from torsionnet.core.entries.spec import entry
from torsionnet.core.entries.words import Text
from torsionnet.core.errors import Fault
from torsionnet.study.answers.answer import AskedStudy, StudyAnswer, VariantValues, register_answer
from torsionnet.study.answers.answer_names import CONFIGURATION, LIMIT
from torsionnet.study.answers.asking import case_label, limit_faults, limit_words
from torsionnet.study.answers.draws_beyond import CountedBeyond, DrawsBeyond, KeptBeyond
from torsionnet.study.answers.limited_values import limited_values
from torsionnet.study.answers.share_interval import counted_share
from torsionnet.study.answers.yield_found import ALL_CASES, ANY_LIMIT, MEAN, LimitShare, YieldFound


@register_answer
@dataclass(frozen=True, kw_only=True)
class Yield(StudyAnswer):
    """Share of the variants that are beyond a limit, in each configuration and in any, with its confidence interval.

    The interval is that of Clopper and Pearson for independent draws. What is counted is the draw: one that is beyond
    a limit in two configurations counts once for all of them. A curve is beyond its limit where its largest value is
    above, or its smallest one below.
    """

    kind: ClassVar[str] = "yield"
    naming: ClassVar[Mapping[str, str]] = {"limits": LIMIT, "weights": CONFIGURATION}

    limits: tuple[str, ...] = entry(Listed("quantities whose limits count; default: all", Text("quantity")), None)
    weights: Mapping[str, float] = entry(
        Named(
            "shares of configurations, for a mean over them", Value("a weight", "1"), form="weights, {II: 0.2, V: 0.8}"
        ),
        None,
    )
    confidence: float = entry(Value("of the interval", "1", exclusive=True, below=1), 0.95)

    def unfit(self, study: AskedStudy) -> Iterator[Fault]:
        yield from limit_faults(study)
        left = [name for name in study.configurations if name not in self.weights]
        if self.weights and left:
            yield Fault(
                f"every configuration needs a weight, 0 where it does not count; not: {', '.join(left)}", ("weights",)
            )
        if self.weights and not sum(self.weights.values()) > 0:
            yield Fault("weights are shares of configurations; at least one of them is above 0", ("weights",))

    def found(self, study: AskedStudy, result: VariantValues) -> YieldFound:
        names = self.limits or tuple(study.limits)
        distributions = [
            one
            for case in study.configurations
            for name in names
            for one in limited_values(study, case_label(case), name, result.kept_values(name, case))
        ]
        beyond, missing = self._counted(study, result, names)
        method = study.space.sampling.method if study.space.sampling and study.space.random_names else ""
        return YieldFound(
            study.title,
            tuple(self._shares(study, beyond, names)),
            self.confidence,
            missing,
            method,
            not study.space.random_names,
            tuple(distributions),
            result.kept.words(study.count),
        )

    def _counted(self, study: AskedStudy, result: VariantValues, names: tuple[str, ...]) -> tuple[DrawsBeyond, int]:
        """What is beyond, and how many values there are none of."""
        draws = study.space.draws
        if result.beyond is not None:
            result.beyond.agree_with(study.limits, names)
            return CountedBeyond(result.beyond, study.space.count // draws), result.beyond.missing(names)
        beyond: dict[str, dict[str, NDArray[np.bool_]]] = {}
        missing = 0
        for case in study.configurations:
            beyond[case] = {}
            for name in names:
                values = result.kept_values(name, case)
                beyond[case][name] = study.limits[name].beyond(values).reshape(-1, draws)
                missing += int(np.isnan(values.reshape(len(values), -1)).any(axis=1).sum())
        return KeptBeyond(beyond), missing

    def _shares(self, study: AskedStudy, beyond: DrawsBeyond, names: tuple[str, ...]) -> Iterator[LimitShare]:
        cases = study.configurations
        asked = [(limit_words(study, name), (name,)) for name in names] + [(ANY_LIMIT, names)]
        draws = study.space.draws
        for case in cases:
            for words, limits in asked:
                yield self._share(case_label(case), words, beyond.in_case(limits, case), draws)
        if len(cases) == 1:
            return
        for words, limits in asked:
            yield self._share(ALL_CASES, words, beyond.in_any(limits), draws)
            if self.weights:
                yield self._share(MEAN, words, beyond.on_average(limits, self.weights), draws)

    def _share(self, case: str, limit: str, hits: float, draws: int) -> LimitShare:
        return LimitShare(case, limit, counted_share(min(hits, draws), draws, self.confidence))
