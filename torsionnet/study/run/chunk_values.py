"""Results of some variants of a study (kept values, moments, histograms, limits), and how they are joined."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import ceil, gcd
from typing import TYPE_CHECKING, Self

import numpy as np

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.quantity import QuantityLimit
from torsionnet.study.quantities.variant_block import NOTHING_READ, VariantBlock, remark
from torsionnet.study.reductions.summaries import GrowingHistogram, Histogram, Moments, extremes, kept_indices
from torsionnet.study.study import Study

if TYPE_CHECKING:
    from torsionnet.study.reductions.limit_counts import LimitFlags


@dataclass(frozen=True, eq=False)
class ChunkValues:
    """Results of a block or chunk of n variants, their kept values and statistics in SI.

    Attributes
    ----------
    kept : mapping
        Quantity -> values (n,) of the variants that are kept, NaN where one has none; of a quantity of several points
        its smallest and largest value over them, (n, 2). Where not all are kept, also parameter -> (n,) values.
    moments, histograms : mappings
        Quantity -> moments, histogram.
    impossible : int
        Number of variants whose values the model refuses.
    remarks : mapping
        Text of a warning -> how often.
    beyond : LimitFlags or None
        Variants beyond the limits; None where all values are kept.
    read : (2,) array
        Lowest and highest frequency in Hz at which laws over frequency are read.
    """

    kept: Mapping[str, FloatArray]
    moments: Mapping[str, Moments]
    histograms: Mapping[str, Histogram]
    impossible: int
    remarks: Mapping[str, int]
    beyond: LimitFlags | None = None
    read: FloatArray = field(default_factory=lambda: np.array(NOTHING_READ))

    @classmethod
    def of(cls, block: VariantBlock, start: int, every: int, limits: Mapping[str, QuantityLimit]) -> Self:
        """Results of a block of variants, the first of which has the index ``start``.

        Parameters
        ----------
        block : VariantBlock
        start : int
        every : int
            Every how many-th variant keeps its values; with 1 all do, and parameters are not kept.
        limits : mapping
            Quantity -> limit by which variants are counted.
        """
        chosen = kept_indices(start, start + len(block), every)
        found = {name: block.of(name) for name in block.quantities}
        kept = {name: one[chosen, 0] if one.shape[1] == 1 else extremes(one[chosen]) for name, one in found.items()}
        if every > 1:
            kept |= {name: column[chosen] for name, column in block.values.items()}
        return cls(
            kept,
            {name: Moments.of(one, start) for name, one in found.items()},
            {name: Histogram.of(one) for name, one in found.items()},
            int(block.impossible.sum()),
            block.remarks,
            _flags([(limit, found[name]) for name, limit in limits.items()]),
            block.read,
        )


def _flags(found: Sequence[tuple[QuantityLimit, FloatArray]]) -> LimitFlags | None:
    if not found:
        return None
    from torsionnet.study.reductions.limit_counts import LimitFlags

    return LimitFlags.of(found)


@dataclass
class JoinedValues:
    """Results of blocks or chunks of variants that are joined in their order, in bounded memory.

    Attributes
    ----------
    sharing : int
        How many of these grow side by side, in the same memory.
    """

    sharing: int = 1
    kept: dict[str, list[FloatArray]] = field(default_factory=dict)
    moments: dict[str, Moments] = field(default_factory=dict)
    histograms: dict[str, GrowingHistogram] = field(default_factory=dict)
    impossible: int = 0
    remarks: Counter[str] = field(default_factory=Counter)
    beyond: list[LimitFlags] = field(default_factory=list)
    read: FloatArray = field(default_factory=lambda: np.array(NOTHING_READ))

    def add(self, part: ChunkValues) -> None:
        """Add the results of the next variants."""
        for name, moments in part.moments.items():
            self.moments[name] = self.moments[name].joined(moments) if name in self.moments else moments
            self.histograms.setdefault(name, GrowingHistogram(sharing=self.sharing)).add(part.histograms[name])
        for name, values in part.kept.items():
            self.kept.setdefault(name, []).append(values)
        self.impossible += part.impossible
        for text, count in part.remarks.items():
            remark(self.remarks, text, count)
        self.beyond += [] if part.beyond is None else [part.beyond]
        self.read = widest([self.read, part.read])

    def whole(self) -> ChunkValues:
        """Results of all variants added."""
        return ChunkValues(
            {name: np.concatenate(parts) for name, parts in self.kept.items()},
            self.moments,
            {name: parts.whole() for name, parts in self.histograms.items()},
            self.impossible,
            self.remarks,
            self.beyond[0].joined(self.beyond) if self.beyond else None,
            self.read,
        )


def widest(read: Sequence[FloatArray]) -> FloatArray:
    """Lowest and highest of several pairs (2,) of frequencies in Hz, :data:`NOTHING_READ` without any.

    >>> widest([np.array([2.0, 5.0]), np.array(NOTHING_READ), np.array([3.0, 9.0])]).tolist()
    [2.0, 9.0]
    """
    low, high = np.array([NOTHING_READ, *read]).T
    return np.array([low.min(), high.max()])


# Division of the variants of a study into chunks of fixed size.

KEPT_VALUES = 10_000_000
"""Largest number of values that a study keeps, 80 MB, those of a part of the variants where it has more."""


def kept_every(study: Study) -> int:
    """Number m with which every m-th variant of a study keeps its values, 1 where all do.

    m has no factor in common with the number of values on any axis, nor with two: of a grid every tenth variant could
    have one and the same value of a parameter, and every other point of a Sobol sequence lies in the same half.
    """
    if study.count * len(study.quantities) <= KEPT_VALUES:
        return 1
    model = study.model_in(study.configurations[0])
    forms = [one.measured(model, study.quantities) for one in study.quantities.values()]
    each = len(study.space.names) + sum(2 if form.is_curve else 1 for form in forms)
    every = ceil(study.count * each / KEPT_VALUES)
    while gcd(every, 2 * study.space.count) > 1:
        every += 1
    return every


def counted_limits(study: Study, every: int) -> dict[str, QuantityLimit]:
    """Limits, by quantity, by which variants are counted while they are calculated, sorted by name.

    None where all are kept.
    """
    return {} if every == 1 else dict(sorted(study.limits.items()))


@dataclass(frozen=True)
class Chunk:
    """Chunk of a study, the variants ``start`` to ``stop - 1`` of one configuration of the model."""

    number: int
    case: int
    start: int
    stop: int

    def __len__(self) -> int:
        return self.stop - self.start


@dataclass(frozen=True)
class Chunks:
    """Chunks of a study by number, those of the first configuration first.

    Attributes
    ----------
    cases : int
    count : int
        Number of variants in each case.
    size : int
        Number of variants in a chunk; the last one of a case may have fewer.

    Examples
    --------
    >>> chunks = Chunks(cases=2, count=250, size=100)
    >>> chunks.total, chunks[5]
    (6, Chunk(number=5, case=1, start=200, stop=250))
    """

    cases: int
    count: int
    size: int

    @property
    def each(self) -> int:
        """Number of chunks of variants in each configuration."""
        return ceil(self.count / self.size)

    @property
    def total(self) -> int:
        return self.cases * self.each

    def __getitem__(self, number: int) -> Chunk:
        if not 0 <= number < self.total:
            raise IndexError(f"chunks are 0 to {self.total - 1}, asked for {number}")
        case, place = divmod(number, self.each)
        start = place * self.size
        return Chunk(number, case, start, min(start + self.size, self.count))

    def side_by_side(self) -> Iterator[range]:
        """Numbers of the chunks with the same variants in all configurations, a range for each such group.

        >>> [list(numbers) for numbers in Chunks(cases=2, count=250, size=100).side_by_side()]
        [[0, 3], [1, 4], [2, 5]]
        """
        return (range(place, self.total, self.each) for place in range(self.each))
