"""Statistics of values that come in chunks of variants: moments, histograms with their percentiles, values kept.

Histograms of values that come in chunks, and their percentiles within 0.2 % of themselves, in bounded memory. Values
are counted in bins whose edges are powers of a number a little above 1, so that the middle of a bin is off by at most
:data:`ACCURACY` of any value in it (Masson, Rim and Lee, DDSketch, 2019). Counts are whole numbers: they add up to the
same whatever the order.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import log
from typing import Annotated, Any, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.entries.spec import Schema
from torsionnet.base.result_rows import NUMBER, NUMBER_ROWS, NUMBERS, Out
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.quantity import QuantityForm

# Histograms of values that come in chunks, and their percentiles within 0.2 % of themselves, in bounded memory.

ACCURACY = 0.002
"""Largest relative error of a percentile, beside the step between neighbouring values, as less takes more bins."""
MOST_COUNTERS = 4_000_000
"""Largest number of bins counted in a dense array, which is quickest and takes 32 MB at this size."""
BIN_RATIO = (1 + ACCURACY) / (1 - ACCURACY)
"""Ratio of neighbouring histogram edges, such that the middle of a bin is off by :data:`ACCURACY` at both edges."""
MOST_WAITING_BINS = 2_000_000
"""Number of histogram bins that wait to be merged, as merging many at once is quicker, but takes memory."""
BIN_OFFSET = 1 << 19
"""Number added to the bins of positive values, so that those of negative ones are mirrored at 0, a bin of its own."""


@dataclass(frozen=True, eq=False)
class Histogram:
    """Counts of a quantity's values in bins, for each point of a curve.

    Attributes
    ----------
    bins : (n_bins,) integers
        Ascending bin numbers: ``point * 2^21 + bin + 2^20``.
    counts : (n_bins,) integers

    Examples
    --------
    >>> import numpy as np
    >>> median = Histogram.of(np.arange(1.0, 1002.0)[:, None]).percentiles([50.0], 1)
    >>> bool(abs(median[0, 0] - 501.0) < 0.002 * 501)
    True
    """

    bins: NDArray[np.int64]
    counts: NDArray[np.int64]

    @classmethod
    def of(cls, values: FloatArray) -> Self:
        """Histogram of values (n, n_points), in which values that are not finite are not counted."""
        there = np.isfinite(values)
        points = np.broadcast_to(np.arange(values.shape[1]), values.shape)[there]
        own = _bins(values[there])
        low, high = (int(own.min()), int(own.max()) + 1) if own.size else (0, 1)
        width = high - low
        # A counter for every bin in between, or sorted values where these would be too many.
        if width * values.shape[1] > MOST_COUNTERS:
            bins, counts = np.unique((points << 21) + own + (1 << 20), return_counts=True)
            return cls(bins, counts.astype(np.int64))
        every = np.bincount(points * width + (own - low), minlength=width * values.shape[1])
        places = np.flatnonzero(every)
        # The point in the high bits, the bin with an offset in the lower 21.
        return cls((places // width << 21) + places % width + low + (1 << 20), every[places].astype(np.int64))

    @classmethod
    def joined(cls, parts: Sequence[Histogram]) -> Self:
        """Histogram of the values of several histograms together."""
        bins = np.concatenate([np.zeros(0, dtype=np.int64), *(part.bins for part in parts)])
        counts = np.concatenate([np.zeros(0, dtype=np.int64), *(part.counts for part in parts)])
        order = np.argsort(bins, kind="stable")  # which only merges what is ascending already
        bins = bins[order]
        firsts = np.flatnonzero(np.diff(bins, prepend=-1))
        return cls(bins[firsts], np.add.reduceat(counts[order], firsts) if len(firsts) else counts)

    def percentiles(self, shares: ArrayLike, n_points: int) -> FloatArray:
        """Percentiles (n_shares, n_points) at shares in per cent, in the unit of the values.

        NaN where no value was counted.
        """
        wanted = np.asarray(shares, dtype=float) / 100
        percentiles = np.full((len(wanted), n_points), np.nan)
        for point in range(n_points):
            first, last = np.searchsorted(self.bins, [point << 21, (point + 1) << 21])
            if first == last:
                continue
            below = np.cumsum(self.counts[first:last])
            # The value of that rank, rounded up, without interpolation.
            ranks = np.ceil(wanted * below[-1]).clip(1, below[-1])
            places = np.searchsorted(below, ranks)
            percentiles[:, point] = _middles(self.bins[first:last][places] - (point << 21) - (1 << 20))
        return percentiles


@dataclass
class GrowingHistogram:
    """Sum of any number of histograms that are merged as they come, in bounded memory.

    Attributes
    ----------
    waiting : list of Histogram
    bins : int
        Number of bins of all that wait to be merged.
    sharing : int
        How many histograms grow side by side, in the same memory.
    """

    waiting: list[Histogram] = field(default_factory=list)
    bins: int = 0
    sharing: int = 1

    def add(self, part: Histogram) -> None:
        """Add the histogram of one more chunk of variants."""
        self.waiting.append(part)
        self.bins += len(part.bins)
        if self.bins > 2 * len(self.waiting[0].bins) + MOST_WAITING_BINS // self.sharing:
            self.waiting = [self.whole()]
            self.bins = len(self.waiting[0].bins)

    def whole(self) -> Histogram:
        """Histogram of all chunks added so far."""
        return Histogram.joined(self.waiting)


def _bins(values: FloatArray) -> NDArray[np.int64]:
    with np.errstate(divide="ignore"):
        # Bin n holds the sizes from r^n to r^(n + 1); its sign and an offset leave 0 for zero.
        sizes = np.floor(np.log(np.abs(values)) / log(BIN_RATIO))
    return np.where(values == 0, 0, np.sign(values) * (sizes.clip(1 - BIN_OFFSET, BIN_OFFSET - 1) + BIN_OFFSET)).astype(
        np.int64
    )


def _middles(bins: NDArray[np.int64]) -> FloatArray:
    """Middle values of bins by their numbers, with the same relative distance from both edges."""
    sizes = np.abs(bins) - BIN_OFFSET
    middle = np.exp(sizes * log(BIN_RATIO)) * (2 * BIN_RATIO / (1 + BIN_RATIO))
    return np.where(bins == 0, 0.0, np.sign(bins) * middle)


# Number, mean, variance and extremes of values that come in chunks, for all points of a curve at once.


@dataclass(frozen=True, eq=False)
class Moments:
    """Number, mean, squared deviations and extremes of a quantity's finite values, each attribute (n_points,).

    Attributes
    ----------
    count : integers
    mean : floats
    squares : floats
        Sum of the squared deviations from the mean.
    smallest, largest : floats
        NaN where there are no values.
    smallest_at, largest_at : integers
        Numbers of the variants with the extremes, the first of several; -1 where there are none.

    Examples
    --------
    >>> import numpy as np
    >>> first, then = Moments.of(np.array([[1.0], [2.0]]), 0), Moments.of(np.array([[6.0]]), 2)
    >>> whole = first.joined(then)
    >>> whole.mean.tolist(), whole.deviation.round(6).tolist(), whole.largest_at.tolist()
    ([3.0], [2.645751], [2])
    """

    count: NDArray[np.int64]
    mean: FloatArray
    squares: FloatArray
    smallest: FloatArray
    largest: FloatArray
    smallest_at: NDArray[np.int64]
    largest_at: NDArray[np.int64]

    @classmethod
    def of(cls, values: FloatArray, start: int) -> Self:
        """Moments of the values (n, n_points) of variants, the first of which has the index ``start``."""
        there = np.isfinite(values)
        count = there.sum(axis=0)
        some = count > 0
        known = np.where(there, values, 0.0)
        mean = known.sum(axis=0) / np.maximum(count, 1)
        with np.errstate(over="ignore"):  # the spread of values beyond 1e154 is infinite
            squares = (np.where(there, values - mean, 0.0) ** 2).sum(axis=0)
        low, high = np.where(there, values, np.inf), np.where(there, values, -np.inf)
        lowest, highest = low.argmin(axis=0), high.argmax(axis=0)
        points = np.arange(values.shape[1])
        return cls(
            count.astype(np.int64),
            np.where(some, mean, 0.0),
            squares,
            np.where(some, low[lowest, points], np.nan),
            np.where(some, high[highest, points], np.nan),
            np.where(some, lowest + start, -1),
            np.where(some, highest + start, -1),
        )

    def joined(self, other: Moments) -> Moments:
        """Moments of the values of some variants together with those of later variants."""
        count = self.count + other.count
        # Chan, Golub and LeVeque: about the common mean the squares grow by d^2 n_a n_b/(n_a + n_b).
        apart = other.mean - self.mean
        share = other.count / np.maximum(count, 1)
        lower = ~(self.smallest <= other.smallest) & (other.count > 0)
        higher = ~(self.largest >= other.largest) & (other.count > 0)
        return Moments(
            count,
            self.mean + apart * share,
            self.squares + other.squares + apart * apart * (self.count * share),
            np.where(lower, other.smallest, self.smallest),
            np.where(higher, other.largest, self.largest),
            np.where(lower, other.smallest_at, self.smallest_at),
            np.where(higher, other.largest_at, self.largest_at),
        )

    @property
    def deviation(self) -> FloatArray:
        """Standard deviation (n_points,) of the sample, in the unit of the values; NaN of fewer than two values."""
        return np.where(self.count > 1, np.sqrt(self.squares / np.maximum(self.count - 1, 1)), np.nan)


# Statistics of a quantity over all variants of one configuration, as numbers and for JSON.

OVER: Schema = {"enum": ["frequency", "speed"]}
"""JSON Schema of what a curve runs over, frequency or speed."""
NUMBER_OR_CURVE: Schema = {"anyOf": [NUMBER, NUMBERS], "description": "of a curve one for each point"}
"""JSON Schema of a statistic of a quantity, a number, or an array with one for each point of a curve."""
OverPoints: TypeAlias = Annotated[Any, Out(schema=NUMBER_OR_CURVE)]
"""Type of a statistic of a quantity, a number, or (n_points,) for a curve."""


@dataclass(frozen=True, eq=False)
class QuantityStatistics:
    """Statistics in SI of a quantity over all variants of one configuration, as they are written to JSON."""

    quantity: str
    configuration: str
    unit: str
    over: Annotated[str | None, Out(optional=True, schema=OVER)]
    points: Annotated[FloatArray | None, Out(optional=True, schema=NUMBERS)]
    variants: OverPoints
    mean: OverPoints
    standard_deviation: OverPoints
    smallest: OverPoints
    smallest_at: OverPoints
    largest: OverPoints
    largest_at: OverPoints
    percentiles: Annotated[Any, Out(schema={"anyOf": [NUMBERS, NUMBER_ROWS]})]


@dataclass(frozen=True, eq=False)
class Summary:
    """Statistics of a quantity over all variants of one configuration, ``measure`` being its unit and points."""

    measure: QuantityForm
    moments: Moments
    histogram: Histogram

    def percentiles(self, shares: ArrayLike) -> FloatArray:
        """Percentiles (n_shares, n_points) in SI at shares in per cent, within 0.2 % of themselves."""
        return self.histogram.percentiles(shares, len(self.measure.points))

    def row(self, name: str, configuration: str, percentiles: FloatArray) -> QuantityStatistics:
        """Statistics of the quantity in SI as plain data for JSON, with percentiles (n_shares, n_points)."""
        moments, is_curve = self.moments, self.measure.is_curve

        def shown(array: Any) -> Any:
            return array if is_curve else array[0]

        return QuantityStatistics(
            name, configuration, self.measure.unit,
            self.measure.over if is_curve else None, self.measure.points if is_curve else None,
            shown(moments.count), shown(moments.mean), shown(moments.deviation), shown(moments.smallest),
            shown(moments.smallest_at), shown(moments.largest), shown(moments.largest_at),
            percentiles if is_curve else percentiles[:, 0],
        )  # fmt: skip


# Values of single variants that a study keeps, all of them, or every m-th where there are very many.

Cases = Mapping[tuple[str, str], FloatArray]
"""Mapping of (configuration, quantity or parameter) to its values in SI, (n,), or (n, 2) for the extremes of curves."""


@dataclass(frozen=True, eq=False)
class KeptValues:
    """Values in SI of the variants 0, m, 2 m, ... of each configuration.

    Attributes
    ----------
    every : int
        m; 1 where all are kept.
    values : mapping
        (configuration, quantity) -> (n,) values, or (n, 2), the smallest and largest value of a quantity over several
        points; (configuration, parameter) -> (n,) values where not all are kept, else they follow from the index.
    """

    every: int = 1
    values: Cases = field(default_factory=dict)

    def words(self, count: int) -> str:
        """Words for the part of ``count`` variants whose values are kept; empty where all are.

        >>> KeptValues(every=7).words(20_000_000)
        'one in 7 of 20000000 variants'
        """
        return "" if self.every == 1 else f"one in {self.every} of {count} variants"


def kept_indices(start: int, stop: int, every: int) -> slice:
    """Slice of the kept variants, those with multiples of ``every`` as index, among ``start`` to ``stop - 1``.

    >>> list(range(10, 20))[kept_indices(10, 20, 4)]
    [12, 16]
    """
    return slice(-start % every, stop - start, every)


def extremes(curves: FloatArray) -> FloatArray:
    """Smallest and largest value (n, 2) of each of n curves (n, n_points); NaN where one of the points has no value.

    >>> import numpy as np
    >>> extremes(np.array([[1.0, 3.0, 2.0], [1.0, np.nan, 2.0]])).tolist()
    [[1.0, 3.0], [nan, nan]]
    """
    return np.column_stack([curves.min(axis=1), curves.max(axis=1)])
