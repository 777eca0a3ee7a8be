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

    def shares(self, share: Array) -> None:
        """Look at terms over their sum."""
        flat = share.view(float) if share.flags.c_contiguous else share
        if not abs(np.vdot(flat, flat)) < LARGE * LARGE:
            self._mark(~(np.abs(share) < LARGE))

    def sums(self, term: Array, total: Array) -> None:
        """Look at a sum of two, of which ``term`` is one. Real parts tell where a closer look is needed."""
        ratio = term.real / total.real
        if not np.vdot(ratio, ratio) < LARGE * LARGE:
            self._mark(np.abs(term) > LARGE * np.abs(total))

    def _mark(self, found: NDArray[np.bool_]) -> None:
        self.marked |= found.reshape(-1, found.shape[-1]).any(axis=0)
