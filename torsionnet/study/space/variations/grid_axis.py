"""The values of a parameter that takes one after the other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.response.frequency_response import FloatArray

Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class GridAxis:
    """Values by index, of which only those that are asked for exist.

    Attributes
    ----------
    count : int
    at : callable
        Indices (n,) -> values (n,) in SI.
    low, high : float
        Lowest and highest value.
    """

    count: int
    at: Callable[[Indices], FloatArray]
    low: float
    high: float

    @property
    def values(self) -> FloatArray:
        """All, (count,)."""
        return self.at(np.arange(self.count))
