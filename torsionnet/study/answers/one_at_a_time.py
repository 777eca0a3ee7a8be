"""What each parameter alone does to a quantity: both ends of its span, all others in their middle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.answers.point_functions import OfPoints


@dataclass(frozen=True, eq=False)
class Swings:
    """The value in the middle, and those (d,) with each parameter at the low and at the high end of its span."""

    middle: float
    at_low: FloatArray
    at_high: FloatArray

    @property
    def order(self) -> list[int]:
        """Parameters by how far the quantity swings, the strongest first."""
        with_middle = np.stack([self.at_low, self.at_high, np.full(len(self.at_low), self.middle)])
        swings = np.nan_to_num(np.ptp(with_middle, axis=0))
        return [int(index) for index in np.argsort(-swings, kind="stable")]


def one_at_a_time(function: OfPoints, middle: FloatArray, low: FloatArray, high: FloatArray) -> Swings:
    """Both ends of each parameter's span, at points (d,) of any coordinates: 2 d + 1 variants.

    Examples
    --------
    >>> import numpy as np
    >>> found = one_at_a_time(lambda p: p[:, 0] + 3 * p[:, 1], np.zeros(2), -np.ones(2), np.ones(2))
    >>> found.at_high.tolist(), found.order
    ([1.0, 3.0], [1, 0])
    """
    d = len(middle)
    alone = np.eye(d, dtype=bool)
    points = np.concatenate([middle[None], np.where(alone, low, middle), np.where(alone, high, middle)])
    values = function(points)
    return Swings(float(values[0]), values[1 : d + 1], values[d + 1 :])
