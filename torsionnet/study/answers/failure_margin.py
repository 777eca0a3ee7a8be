"""How far a variant is from its limits, as a function of independent standard normal variables."""

from __future__ import annotations

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.answers.answer_case import AnswerCase
from torsionnet.study.answers.point_functions import OfPoints
from torsionnet.study.quantities.quantity_limit import QuantityLimit


def failure_margin(case: AnswerCase, limits: dict[str, QuantityLimit]) -> OfPoints:
    """The smallest distance to a limit, over the size of that limit: not above 0 where one of them is not kept."""
    names = tuple(limits)

    def margin(points: FloatArray) -> FloatArray:
        found = case.calculated(case.space.from_standard_normal(points), names)
        return np.asarray(np.min([distance(limits[name], found[name]) for name in names], axis=0))

    return margin


def distance(limit: QuantityLimit, values: FloatArray) -> FloatArray:
    """Of values (n,), or the worst of a curve (n, n_points), to the nearer side of their limit, over its size.

    NaN where there is no value.

    Examples
    --------
    >>> import numpy as np
    >>> distance(QuantityLimit(below=4.0, above=1.0), np.array([2.0, 5.0])).tolist()
    [0.25, -0.25]
    """
    sides = [(1, limit.above), (-1, limit.below)]
    size = max(abs(side) for _, side in sides if side is not None) or 1.0
    found = np.min([sign * (values - side) / size for sign, side in sides if side is not None], axis=0)
    return np.asarray(found if found.ndim == 1 else found.min(axis=1))
