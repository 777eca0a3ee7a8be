"""Values of single variants that a study keeps, all of them, or every m-th where there are very many."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from torsionnet.linear.assembly.rows import FloatArray

Cases = Mapping[tuple[str, str], FloatArray]
"""Mapping of (configuration, quantity or parameter) to its values in SI, (n,), or (n, 2) for the extremes of curves."""


@dataclass(frozen=True, eq=False)
class KeptValues:
    """Values in SI of the variants 0, m, 2 m, ... of each configuration.

    Attributes
    ----------
    every : int
        m; 1 where all are kept.
    numbers : mapping
        (configuration, quantity that is a number) -> (n,) values.
    extremes : mapping
        (configuration, quantity of several points) -> (n, 2), its smallest and largest value over them.
    parameters : mapping
        (configuration, parameter) -> (n,) values; empty where all are kept, as they follow from the index then.
    """

    every: int = 1
    numbers: Cases = field(default_factory=dict)
    extremes: Cases = field(default_factory=dict)
    parameters: Cases = field(default_factory=dict)

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
