"""Yield, an answer of a study, the share of the variants that are beyond a limit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from types import ModuleType
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.composite import Listed, Named
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Text, entry
from torsionnet.base.errors import Fault
from torsionnet.base.table import Column, Table
from torsionnet.study.answers.answer import AskedStudy, StudyAnswer, VariantValues, register_answer
from torsionnet.study.answers.answer_inputs import CONFIGURATION, LIMIT, case_label, limit_faults, limit_words
from torsionnet.study.answers.conclusion_data import IN_WORDS, PlainConclusion
from torsionnet.study.answers.draws_beyond import CountedBeyond, DrawsBeyond, KeptBeyond, LimitedValues, limited_values
from torsionnet.study.answers.share_interval import Share, counted_share

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ANY_LIMIT = "any limit"
ALL_CASES, MEAN = "in any of them", "weighted mean"


@dataclass(frozen=True)
class LimitShare:
    """Share of the variants beyond a limit, in one configuration, in any of them, or in their weighted mean."""

    configuration: str
    limit: str
    share: Share


@dataclass(frozen=True, eq=False)
class YieldResult(PlainConclusion):
    """Shares of the variants beyond each limit and beyond any limit, with histograms of the limited quantities.

    ``missing`` variants have no value and count as beyond; ``exhaustive``: all variants were calculated and intervals
    do not apply. ``distributions`` has histograms of each quantity in each configuration, of the ``part`` of the
    variants that is kept where it is not empty; shares are always of all.
    """

    title: str
    shares: tuple[LimitShare, ...]
    confidence: float
    missing: int
    method: str
    exhaustive: bool
    distributions: tuple[LimitedValues, ...]
    part: str = field(default="", metadata=IN_WORDS)

    def of(self, configuration: str, limit: str = ANY_LIMIT) -> Share:
        """Share of the variants beyond a limit, chosen by configuration and by the words of the limit in the table."""
        return next(one.share for one in self.shares if (one.configuration, one.limit) == (configuration, limit))

    @property
    def sentences(self) -> tuple[str, ...]:
        said = [f"{self._share_words(one.share)}: {one.limit}, {one.configuration}" for one in self._headline]
        if self.missing:
            said.append(f"{self.missing} variants have no value and count as beyond the limit")
        if self.method in ("sobol", "latin_hypercube"):
            said.append("draws of this kind spread more evenly than the interval supposes: it is wider than needed")
        if self.part:
            said.append(f"all variants are counted; the values of {self.part} are drawn")
        return tuple(said)

    @property
    def _headline(self) -> list[LimitShare]:
        over_all = [one for one in self.shares if one.configuration == ALL_CASES]
        return over_all or [one for one in self.shares if len(self.shares) > 2 or one.limit != ANY_LIMIT]

    def _share_words(self, share: Share) -> str:
        return (
            f"{100 * share.value:.4g} % of all variants"
            if self.exhaustive
            else f"{share.percent} of {share.count} draws"
        )

    def table(self) -> Table:
        columns = (
            Column("configuration"), Column("beyond"), Column("share", "%", digits=4), Column("from", "%", digits=4),
            Column("to", "%", digits=4), Column("kept", "%", digits=6), Column("draws"),
        )  # fmt: skip
        rows = tuple(
            (one.configuration, one.limit, 100 * one.share.value,
             None if self.exhaustive else 100 * one.share.low, None if self.exhaustive else 100 * one.share.high,
             100 * (1 - one.share.value), one.share.count)
            for one in self.shares
        )  # fmt: skip
        notes = [f"intervals of Clopper and Pearson, {100 * self.confidence:g} %"] if not self.exhaustive else []
        return Table.of(self.title, "yield", columns, rows, (*notes, *self.sentences[len(self._headline) :]))

    def figure(self, plot: ModuleType, **look: Any) -> Figure:
        return plot.limit_shares(self, **look)  # type: ignore[no-any-return]


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

    def study_faults(self, study: AskedStudy) -> Iterator[Fault]:
        yield from limit_faults(study)
        left = [name for name in study.configurations if name not in self.weights]
        if self.weights and left:
            yield Fault(
                f"every configuration needs a weight, 0 where it does not count; not: {', '.join(left)}", ("weights",)
            )
        if self.weights and not sum(self.weights.values()) > 0:
            yield Fault("weights are shares of configurations; at least one of them is above 0", ("weights",))

    def conclude(self, study: AskedStudy, result: VariantValues) -> YieldResult:
        names = self.limits or tuple(study.limits)
        distributions = [
            one
            for case in study.configurations
            for name in names
            for one in limited_values(study, case_label(case), name, result.kept_values(name, case))
        ]
        beyond, missing = self._counted(study, result, names)
        method = study.space.sampling.method if study.space.sampling and study.space.random_names else ""
        return YieldResult(
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
        """Counter of the draws that are beyond limits, and the number of missing values."""
        draws = study.space.draws
        if result.beyond is not None:
            result.beyond.require_same_limits(study.limits, names)
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
