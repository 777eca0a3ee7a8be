"""Which lanes have lost digits in a sum on the way: they are looked at again."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[Any]
"""Real where nothing damps the system, else complex; the last axis is lanes."""

LARGE = 1e4
"""A sum this much smaller than its terms is in doubt: what follows from it has lost four digits or more."""


class Doubt:
    """Marks lanes; the tests are quick where there is nothing to mark."""

    def __init__(self, n_lanes: int) -> None:
        self.n_lanes, self.marked = n_lanes, np.zeros(n_lanes, dtype=bool)
        self._ratio = np.empty(n_lanes)

    def shares(self, share: Array, factor: float = 1.0) -> None:
        """Look at a term over its sum, ``factor`` times ``share``."""
        limit, flat = LARGE / factor, share.view(float)
        if not np.vdot(flat, flat) < limit * limit:
            self._mark(~(np.abs(share) < limit))

    def sums(self, term: Array, total: Array) -> None:
        """Look at a sum of two, of which ``term`` is one. Real parts tell where a closer look is needed."""
        ratio = np.divide(term.real, total.real, out=self._ratio)
        if not ratio @ ratio < LARGE * LARGE:
            self._mark(np.abs(term) > LARGE * np.abs(total))

    def _mark(self, found: NDArray[np.bool_]) -> None:
        self.marked |= found.reshape(-1, found.shape[-1]).any(axis=0)
