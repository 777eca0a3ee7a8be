"""Which points have lost digits in a sum on the way: they are looked at again."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[Any]
"""Real where nothing damps the system, else complex; the last axis is points."""

LARGE = 1e4
"""A sum of two this much smaller than its terms is in doubt: what follows from it has lost four digits or more."""
SHARE = 1e3
"""The same of a term beside the pivot or quotient it is part of: lower, since such losses follow each other."""


class Doubt:
    """Marks points; the tests are quick where there is nothing to mark."""

    def __init__(self, n_points: int) -> None:
        self.n_points, self.marked = n_points, np.zeros(n_points, dtype=bool)
        self._ratio = np.empty(n_points)

    def shares(self, share: Array, factor: float = 1.0) -> None:
        """Look at a term over its sum, ``factor`` times ``share``."""
        limit, flat = SHARE / factor, share.view(float)
        if not (np.vdot(flat, flat) < limit * limit or -0.7 * limit < flat.min() <= flat.max() < 0.7 * limit):
            self.marked |= ~(np.abs(share) < limit)

    def sums(self, term: Array, total: Array) -> None:
        """Look at a sum of two, of which ``term`` is one. Real parts tell where a closer look is needed."""
        ratio = np.divide(term.real, total.real, out=self._ratio)
        if not ratio @ ratio < LARGE * LARGE:
            close = np.flatnonzero(~(np.abs(ratio, out=ratio) < LARGE))
            self.marked[close] |= np.abs(term[close]) > LARGE * np.abs(total[close])
