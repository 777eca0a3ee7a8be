"""Number, mean, variance and extremes of values that come in chunks, for all points of a curve at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import FloatArray


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
