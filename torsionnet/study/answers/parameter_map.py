"""Values of a quantity over a grid of two parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.answers.point_functions import OfVariants

AGGREGATES: Mapping[str, Callable[..., FloatArray]] = {
    "mean": np.mean,
    "median": np.median,
    "smallest": np.min,
    "largest": np.max,
}
"""What is shown of the values that the other parameters make at one point of a map."""


@dataclass(frozen=True, eq=False)
class ParameterMap:
    """``values`` (n_x, n_y) over ``x`` (n_x,) and ``y`` (n_y,), SI; NaN where there is no value."""

    x: FloatArray
    y: FloatArray
    values: FloatArray

    def where(self, *, largest: bool) -> tuple[float, float, float]:
        """The two parameters and the value where that is largest, or smallest."""
        flat = np.nanargmax(self.values) if largest else np.nanargmin(self.values)
        i, j = np.unravel_index(flat, self.values.shape)
        return float(self.x[i]), float(self.y[j]), float(self.values[i, j])


def parameter_map(
    evaluate: OfVariants,
    x: tuple[str, FloatArray],
    y: tuple[str, FloatArray],
    others: Mapping[str, FloatArray],
    aggregate: str = "mean",
) -> ParameterMap:
    """Values over two parameters; of the ``others`` (m,), which vary along, every combination is shown by one number.

    Parameters
    ----------
    evaluate : callable
    x, y : tuple
        Name and values.
    others : mapping
        Values (m,) of the other parameters, m = 1 where they are fixed; the same at every point of the map.
    aggregate : {"mean", "median", "smallest", "largest"}
        Of the m values at a point; where one is missing there is none.

    Examples
    --------
    >>> import numpy as np
    >>> found = parameter_map(lambda v: v["a"] * v["b"] + v["c"], ("a", np.array([1.0, 2.0])), ("b", np.array([3.0])),
    ...     {"c": np.array([0.0, 1.0])}, "largest")
    >>> found.values.tolist()
    [[4.0], [7.0]]
    """
    size = max((len(column) for column in others.values()), default=1)
    first, second, which = np.meshgrid(x[1], y[1], np.arange(size), indexing="ij")
    columns = {x[0]: first.ravel(), y[0]: second.ravel()}
    columns |= {name: column[which.ravel()] for name, column in others.items()}
    values = evaluate(columns).reshape(first.shape)
    return ParameterMap(x[1], y[1], np.asarray(AGGREGATES[aggregate](values, axis=2)))
