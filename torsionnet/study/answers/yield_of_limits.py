"""The answer ``type: yield``: how many variants keep the limits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.core.entries.composite import Listed, Named
from torsionnet.core.entries.scalars import Value
from torsionnet.core.entries.spec import entry
from torsionnet.core.entries.words import Text
from torsionnet.core.errors import Fault
from torsionnet.study.answer import AskedStudy, StudyAnswer, VariantValues, register_answer
from torsionnet.study.answer_names import CONFIGURATION, LIMIT
from torsionnet.study.answers.asking import limit_faults, limit_words
from torsionnet.study.answers.case_values import case_values
from torsionnet.study.answers.limited_values import LimitedValues, limited_values
from torsionnet.study.answers.share_interval import counted_share
from torsionnet.study.answers.yield_found import ALL_CASES, ANY_LIMIT, MEAN, LimitShare, YieldFound

Beyond = NDArray[np.bool_]
"""Which variants (n_grid, n_draws) are beyond a limit."""


@register_answer
@dataclass(frozen=True, kw_only=True)
class Yield(StudyAnswer):
    """Share of the variants that are beyond a limit, in each configuration and in any, with its confidence interval.

    The interval is that of Clopper and Pearson for independent draws. What is counted is the draw: one that is beyond
    a limit in two configurations counts once for all of them.
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
        yield from limit_faults(study, self.limits)

    def found(self, study: AskedStudy, result: VariantValues) -> YieldFound:
        names = self.limits or tuple(study.limits)
        draws = study.space.draws
        beyond: dict[tuple[str, str], Beyond] = {}
        distributions: list[LimitedValues] = []
        missing = 0
        for case in case_values(study, result, names):
            for name in names:
                values = case.quantities[name]
                missing += int(np.isnan(values).sum())
                distributions.append(limited_values(study, case.label, name, values))
                beyond[case.label, name] = study.limits[name].exceeded(values).reshape(-1, draws)
            beyond[case.label, ANY_LIMIT] = np.any([beyond[case.label, name] for name in names], axis=0)
        words = {name: limit_words(study, name) for name in names} | {ANY_LIMIT: ANY_LIMIT}
        labels = list(dict.fromkeys(case for case, _ in beyond))
        shares = [self._share(case, words[name], counts) for (case, name), counts in beyond.items()]
        if len(labels) > 1:
            for name in (*names, ANY_LIMIT):
                each = np.array([beyond[case, name] for case in labels])
                shares.append(self._share(ALL_CASES, words[name], each.any(axis=0)))
                if self.weights:
                    weights = np.array([self.weights.get(case, 0.0) for case in labels])
                    mean = np.tensordot(weights / weights.sum(), each, axes=1)
                    shares.append(self._share(MEAN, words[name], mean))
        method = study.space.sampling.method if study.space.sampling and study.space.random_names else ""
        return YieldFound(
            study.title,
            tuple(shares),
            self.confidence,
            missing,
            method,
            not study.space.random_names,
            tuple(distributions),
        )

    def _share(self, case: str, limit: str, beyond: Any) -> LimitShare:
        """Draws by the mean over the points of the grid."""
        per_draw = np.asarray(beyond, dtype=float).mean(axis=0)
        return LimitShare(
            case, limit, counted_share(min(float(per_draw.sum()), len(per_draw)), len(per_draw), self.confidence)
        )
