"""Marks of frequency points at which a sum cancelled so far that the response has to be solved again."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[Any]
"""Real array for systems without damping, else complex, of stiffnesses or motions with frequency points on the last
axis."""

LARGE_CANCELLATION = 1e4
"""Ratio of a term to a sum of two above which the frequency point is uncertain, as four digits or more are lost
there."""
LARGE_SHARE = 1e3
"""Ratio of a term to its pivot or quotient above which a frequency point is uncertain, lower than that of a sum since
such losses accumulate."""


class LostDigits:
    """Mask (n_points,) of frequency points at which an elimination lost digits.

    The tests are quick where there is nothing to mark.
    """

    def __init__(self, n_points: int) -> None:
        self.n_points, self.marked = n_points, np.zeros(n_points, dtype=bool)
        self._ratio = np.empty(n_points)

    def check_share(self, share: Array, factor: float = 1.0) -> None:
        """Mark frequency points where a term of a sum, ``factor`` times ``share`` of it, is large against that sum."""
        limit, flat = LARGE_SHARE / factor, share.view(float)
        if not (np.vdot(flat, flat) < limit * limit or -0.7 * limit < flat.min() <= flat.max() < 0.7 * limit):
            self.marked |= ~(np.abs(share) < limit)

    def check_sum(self, term: Array, total: Array) -> None:
        """Mark frequency points where ``total``, a sum of ``term`` and another term, nearly cancels.

        Real parts tell where a closer look is needed.
        """
        ratio = np.divide(term.real, total.real, out=self._ratio)
        if not ratio @ ratio < LARGE_CANCELLATION * LARGE_CANCELLATION:
            close = np.flatnonzero(~(np.abs(ratio, out=ratio) < LARGE_CANCELLATION))
            self.marked[close] |= np.abs(term[close]) > LARGE_CANCELLATION * np.abs(total[close])
