"""Histograms of values that come in chunks, and their percentiles within 0.2 % of themselves, in bounded memory.

Values are counted in bins whose edges are powers of a number a little above 1, so that the middle of a bin is off by at
most :data:`ACCURACY` of any value in it (Masson, Rim and Lee, DDSketch, 2019). Counts are whole numbers: they add up to
the same whatever the order.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import log
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.linear.assembly.rows import FloatArray

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
    >>> found = Histogram.of(np.arange(1.0, 1002.0)[:, None]).percentiles([50.0], 1)
    >>> bool(abs(found[0, 0] - 501.0) < 0.002 * 501)
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
        if width * values.shape[1] > MOST_COUNTERS:
            bins, counts = np.unique((points << 21) + own + (1 << 20), return_counts=True)
            return cls(bins, counts.astype(np.int64))
        every = np.bincount(points * width + (own - low), minlength=width * values.shape[1])
        places = np.flatnonzero(every)
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
        found = np.full((len(wanted), n_points), np.nan)
        for point in range(n_points):
            first, last = np.searchsorted(self.bins, [point << 21, (point + 1) << 21])
            if first == last:
                continue
            below = np.cumsum(self.counts[first:last])
            ranks = np.ceil(wanted * below[-1]).clip(1, below[-1])
            places = np.searchsorted(below, ranks)
            found[:, point] = _middles(self.bins[first:last][places] - (point << 21) - (1 << 20))
        return found


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
        sizes = np.floor(np.log(np.abs(values)) / log(BIN_RATIO))
    return np.where(values == 0, 0, np.sign(values) * (sizes.clip(1 - BIN_OFFSET, BIN_OFFSET - 1) + BIN_OFFSET)).astype(
        np.int64
    )


def _middles(bins: NDArray[np.int64]) -> FloatArray:
    """Middle values of bins by their numbers, with the same relative distance from both edges."""
    sizes = np.abs(bins) - BIN_OFFSET
    middle = np.exp(sizes * log(BIN_RATIO)) * (2 * BIN_RATIO / (1 + BIN_RATIO))
    return np.where(bins == 0, 0.0, np.sign(bins) * middle)
