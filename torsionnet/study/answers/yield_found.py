"""How many variants are beyond limits, with intervals."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import ModuleType
from typing import TYPE_CHECKING, Any

from torsionnet.response.table import Column, Table
from torsionnet.study.answers.conclusion_data import IN_WORDS, PlainConclusion
from torsionnet.study.answers.limited_values import LimitedValues
from torsionnet.study.answers.share_interval import Share

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ANY_LIMIT = "any limit"
ALL_CASES, MEAN = "in any of them", "weighted mean"


@dataclass(frozen=True)
class LimitShare:
    """Share of the variants beyond a limit in one configuration, in any, or on average."""

    configuration: str
    limit: str
    share: Share


@dataclass(frozen=True, eq=False)
class YieldFound(PlainConclusion):
    """Shares beyond each limit and beyond any.

    ``missing`` variants have no value and count as beyond; ``exhaustive``: all variants are known, there is no
    interval to speak of. ``distributions`` has the values of each quantity in each configuration, of ``part`` of the
    variants where that says so; shares are always of all.
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
        """Share beyond a limit, by its words in the table."""
        return next(one.share for one in self.shares if (one.configuration, one.limit) == (configuration, limit))

    @property
    def sentences(self) -> tuple[str, ...]:
        said = [f"{self._told(one.share)}: {one.limit}, {one.configuration}" for one in self._headline]
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

    def _told(self, share: Share) -> str:
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
        return Table(f"{self.title}: yield", columns, rows, (*notes, *self.sentences[len(self._headline) :]))

    def figure(self, plot: ModuleType, **look: Any) -> Figure:
        return plot.limit_shares(self, **look)  # type: ignore[no-any-return]
