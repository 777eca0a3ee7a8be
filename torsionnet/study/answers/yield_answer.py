"""Yield and percentile bands, answers of a study: the share of variants beyond a limit, and how curves spread."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.composite import Listed, Named
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Text, entry
from torsionnet.base.errors import Fault
from torsionnet.base.table import Column, Table
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer import (
    CONFIGURATION,
    IN_WORDS,
    LIMIT,
    QUANTITY,
    AskedStudy,
    PlainConclusion,
    StudyAnswer,
    VariantValues,
    case_label,
    limit_faults,
    limit_words,
    measure_of,
    register_answer,
)
from torsionnet.study.answers.subset_sampling import Share, counted_share
from torsionnet.study.quantities.quantity import QuantityForm
from torsionnet.study.reductions.limit_counts import LimitTotals

# Yield, an answer of a study, the share of the variants that are beyond a limit.

# Number of draws beyond limits, from the values of all variants, or from counts where a study has very many.

MOST_BINS, FEWEST_BINS = 60, 10
"""Most and fewest bins of the histogram of a limited quantity: more are narrower than a pixel, fewer show no shape."""
ROUNDING_SPREAD = 1e-9
"""Relative spread of a quantity's values below which they count as one value with rounding errors."""


@dataclass(frozen=True, eq=False)
class LimitedValues:
    """Histogram of a limited quantity in one configuration, ``edges`` (n + 1,) in SI, ``counts`` (n,), and limits."""

    configuration: str
    quantity: str
    unit: str
    edges: FloatArray
    counts: FloatArray
    below: float | None
    above: float | None
    curve: str = field(default="", metadata=IN_WORDS)
    """Name of the curve whose largest or smallest values the histogram counts, empty if the quantity is a number."""

    @property
    def constant(self) -> float | None:
        """Value in SI of the only bin with counts, if all variants have the same.

        None where they differ, or have none.
        """
        return float(self.edges[[0, -1]].mean()) if np.count_nonzero(self.counts) == 1 else None


def limited_values(study: AskedStudy, label: str, name: str, values: FloatArray) -> tuple[LimitedValues, ...]:
    """Histograms of a limited quantity, one of values (n,), or of smallest and largest values (n, 2) of a curve."""
    limit, unit = study.limits[name], measure_of(study, name).unit
    if values.ndim == 1:
        return (LimitedValues(label, name, unit, *_histogram(values), limit.below, limit.above),)
    # A curve leaves a lower limit with its smallest value, an upper one with its largest.
    histograms = []
    if limit.above is not None:
        histograms.append(
            LimitedValues(label, f"smallest {name}", unit, *_histogram(values[:, 0]), None, limit.above, name)
        )
    if limit.below is not None:
        histograms.append(
            LimitedValues(label, f"largest {name}", unit, *_histogram(values[:, 1]), limit.below, None, name)
        )
    return tuple(histograms)


def _histogram(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Histogram edges (n + 1,) and counts (n,) of the finite values between the 0.01st and 99.99th percentile."""
    known = values[np.isfinite(values)]
    ends = np.array([0.0, 1.0])
    if len(known):
        ends = np.array([np.percentile(known, 0.01, method="lower"), np.percentile(known, 99.99, method="higher")])
    size = float(np.abs(ends).max()) or 1.0
    # Values that differ by rounding alone get an axis with some width.
    if ends[1] - ends[0] < ROUNDING_SPREAD * size:
        ends = ends + np.array([-1, 1]) * size * 1e-3
    # Rice's rule: 2 n^(1/3) bins.
    bins = int(np.clip(2 * np.cbrt(len(known)), FEWEST_BINS, MOST_BINS))
    counts, edges = np.histogram(known, bins, range=(float(ends[0]), float(ends[1])))
    return edges, counts.astype(float)


Weights = Mapping[str, float]
"""Mapping of each configuration to its weight in a mean over configurations."""


class DrawsBeyond(Protocol):
    """Counter of the draws that are beyond any limit of some quantities.

    One beyond at some points of a grid counts in part.
    """

    def in_case(self, names: Sequence[str], configuration: str) -> float: ...
    def in_any(self, names: Sequence[str]) -> float: ...
    def on_average(self, names: Sequence[str], weights: Weights) -> float: ...


@dataclass(frozen=True, eq=False)
class KeptBeyond:
    """Counter of draws by booleans (n_grid, n_draws) of every configuration and quantity, true beyond its limit."""

    beyond: Mapping[str, Mapping[str, NDArray[np.bool_]]]

    def in_case(self, names: Sequence[str], configuration: str) -> float:
        """Number of draws in one configuration beyond any of the limits of the quantities ``names``."""
        return _draws(self._any_limit(names, configuration))

    def in_any(self, names: Sequence[str]) -> float:
        """Number of draws beyond any of the limits of the quantities ``names`` in at least one configuration."""
        return _draws(self._each(names).any(axis=0))

    def on_average(self, names: Sequence[str], weights: Weights) -> float:
        """Weighted mean over configurations of the number of draws beyond any of the limits of ``names``."""
        shares = np.array([weights.get(case, 0.0) for case in self.beyond])
        return _draws(np.tensordot(shares / shares.sum(), self._each(names), axes=1))

    def _any_limit(self, names: Sequence[str], case: str) -> NDArray[np.bool_]:
        return np.asarray(np.any([self.beyond[case][name] for name in names], axis=0))

    def _each(self, names: Sequence[str]) -> NDArray[np.bool_]:
        return np.array([self._any_limit(names, case) for case in self.beyond])


def _draws(beyond: Any) -> float:
    """Number of draws beyond a limit, each counted by its mean over the points of the grid."""
    return float(np.asarray(beyond, dtype=float).mean(axis=0).sum())


@dataclass(frozen=True, eq=False)
class CountedBeyond:
    """Counter of draws by the number of variants beyond limits, each draw being ``n_grid`` variants."""

    totals: LimitTotals
    n_grid: int

    def in_case(self, names: Sequence[str], configuration: str) -> float:
        """Number of draws in one configuration beyond any of the limits of the quantities ``names``."""
        return self.totals.beyond(names, configuration) / self.n_grid

    def in_any(self, names: Sequence[str]) -> float:
        """Number of draws beyond any of the limits of the quantities ``names`` in at least one configuration."""
        return self.totals.beyond_in_any(names) / self.n_grid

    def on_average(self, names: Sequence[str], weights: Weights) -> float:
        """Weighted mean over configurations of the number of draws beyond any of the limits of ``names``."""
        total = sum(weight * self.in_case(names, case) for case, weight in weights.items())
        return total / sum(weights.values())


ANY_LIMIT = "any limit"
ALL_CASES, MEAN = "in any of them", "weighted mean"


@dataclass(frozen=True)
class LimitShare:
    """Share of the variants beyond a limit, in one configuration, in any of them, or in their weighted mean."""

    configuration: str
    limit: str
    share: Share


@dataclass(frozen=True, eq=False, repr=False)
class YieldResult(PlainConclusion):
    """Shares of the variants beyond each limit and beyond any limit, with histograms of the limited quantities.

    ``missing`` variants have no value and count as beyond; ``exhaustive``: all variants were calculated and intervals
    do not apply. ``distributions`` has histograms of each quantity in each configuration, of the ``part`` of the
    variants that is kept where it is not empty; shares are always of all.
    """

    drawing: ClassVar[str] = "torsionnet.plot.study.distributions:limit_shares"

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
        return next(row.share for row in self.shares if (row.configuration, row.limit) == (configuration, limit))

    @property
    def sentences(self) -> tuple[str, ...]:
        said = [f"{self._share_words(share.share)}: {share.limit}, {share.configuration}" for share in self._headline]
        if self.missing:
            said.append(f"{self.missing} variants have no value and count as beyond the limit")
        if self.method in ("sobol", "latin_hypercube"):
            said.append("draws of this kind spread more evenly than the interval supposes: it is wider than needed")
        if self.part:
            said.append(f"all variants are counted; the values of {self.part} are drawn")
        return tuple(said)

    @property
    def _headline(self) -> list[LimitShare]:
        over_all = [share for share in self.shares if share.configuration == ALL_CASES]
        return over_all or [share for share in self.shares if len(self.shares) > 2 or share.limit != ANY_LIMIT]

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
            (share.configuration, share.limit, 100 * share.share.value,
             None if self.exhaustive else 100 * share.share.low, None if self.exhaustive else 100 * share.share.high,
             100 * (1 - share.share.value), share.share.count)
            for share in self.shares
        )  # fmt: skip
        notes = [f"intervals of Clopper and Pearson, {100 * self.confidence:g} %"] if not self.exhaustive else []
        return Table.of(self.title, "yield", columns, rows, (*notes, *self.sentences[len(self._headline) :]))


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
                f"every configuration needs a weight, 0 where it does not count; not: {', '.join(left)}",
                ("weights",),
                kind="missing-entry",
            )
        if self.weights and not sum(self.weights.values()) > 0:
            yield Fault(
                "weights are shares of configurations; at least one of them is above 0",
                ("weights",),
                kind="out-of-range",
            )

    def conclude(self, study: AskedStudy, result: VariantValues) -> YieldResult:
        names = self.limits or tuple(study.limits)
        distributions = [
            limited
            for case in study.configurations
            for name in names
            for limited in limited_values(study, case_label(case), name, result.kept_values(name, case))
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


# Percentile bands, an answer of a study, the percentiles of a curve over frequency or speed.

DEFAULT_PERCENTILES = (2.5, 25.0, 50.0, 75.0, 97.5)
"""Percentiles of a curve that are drawn unless others are asked for, the median and the middle half and 95 %."""


@register_answer
@dataclass(frozen=True, kw_only=True)
class PercentileBands(StudyAnswer):
    """Percentiles of a curve over the variants, at each of its frequencies or speeds, in each configuration."""

    kind: ClassVar[str] = "percentile_bands"
    naming: ClassVar[Mapping[str, str]] = {"quantity": QUANTITY}

    quantity: str = entry(Text("quantity that is a curve"))
    percentiles: tuple[float, ...] = entry(
        Listed("per cent of the variants that are not above a line; default: 2.5, 25, 50, 75, 97.5",
               Value("per cent", "1", below=100.001)), None,
    )  # fmt: skip

    def study_faults(self, study: AskedStudy) -> Iterator[Fault]:
        if self.quantity in study.quantities and not measure_of(study, self.quantity).is_curve:
            yield Fault(f"{self.quantity} is a single number and no curve", ("quantity",), kind="not-applicable")

    def conclude(self, study: AskedStudy, result: VariantValues) -> PercentileBandsResult:
        shares = tuple(sorted(self.percentiles or DEFAULT_PERCENTILES))
        lines = {case_label(case): result.percentiles(self.quantity, shares, case) for case in study.configurations}
        return PercentileBandsResult(study.title, self.quantity, measure_of(study, self.quantity), shares, lines)


@dataclass(frozen=True, eq=False, repr=False)
class PercentileBandsResult(PlainConclusion):
    """Percentiles of a curve in SI by configuration, each (n_percentiles, n_points), rising."""

    drawing: ClassVar[str] = "torsionnet.plot.study.distributions:percentile_bands"

    title: str
    quantity: str
    measure: QuantityForm
    percentiles: tuple[float, ...]
    lines: Mapping[str, FloatArray]

    @property
    def sentences(self) -> tuple[str, ...]:
        return tuple(self._widest(case, lines) for case, lines in self.lines.items())

    def _widest(self, case: str, lines: FloatArray) -> str:
        width = lines[-1] - lines[0]
        place = int(width.argmax())
        span = f"{lines[0, place]:.4g} to {lines[-1, place]:.4g} {self.measure.unit}".rstrip()
        at = f"{self.measure.points[place]:.4g} {self.points_unit}"
        shares = f"{self.percentiles[0]:g} to {self.percentiles[-1]:g} %"
        return f"{self.quantity}, {case}: spreads most at {at}, {span} ({shares})"

    @property
    def points_unit(self) -> str:
        """Unit of the axis of the curve, Hz for frequencies and rad/s for speeds."""
        return "Hz" if self.measure.over == "frequency" else "rad/s"

    def table(self) -> Table:
        columns = (
            Column("configuration"), Column(self.measure.over, self.points_unit),
            *(Column(f"{share:g} %", self.measure.unit) for share in self.percentiles),
        )  # fmt: skip
        rows = tuple(
            (case, float(point), *map(float, lines[:, place]))
            for case, lines in self.lines.items()
            for place, point in enumerate(self.measure.points)
        )
        return Table.of(self.title, f"percentiles of {self.quantity}", columns, rows, self.sentences)
