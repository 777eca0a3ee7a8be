"""How far a quantity rises or falls along with each parameter, among variants drawn at random."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.errors import SolveError

FEWEST = 10


@dataclass(frozen=True, eq=False)
class RankCorrelations:
    """Spearman's coefficients (d,), the ends of their intervals, and the number of variants with a value.

    A parameter that is the same in all variants has none (NaN).
    """

    coefficients: FloatArray
    low: FloatArray
    high: FloatArray
    count: int


def rank_correlations(parameters: FloatArray, values: FloatArray, confidence: float = 0.95) -> RankCorrelations:
    """Spearman's coefficients of parameters (n, d) and values (n,), with the intervals of Bonett and Wright.

    These are Fisher's with a standard error of sqrt((1 + r^2/2)/(n - 3)).

    Examples
    --------
    >>> import numpy as np
    >>> x = np.linspace(0, 1, 50)
    >>> rank_correlations(np.column_stack([x, 1 - x]), np.exp(x)).coefficients.round(6).tolist()
    [1.0, -1.0]
    """
    from scipy.special import ndtri
    from scipy.stats import rankdata

    known = np.isfinite(values)
    count = int(known.sum())
    if count < FEWEST:
        raise SolveError(f"{count} variants have a value; rank correlations take {FEWEST} or more")
    ranks = rankdata(np.column_stack([parameters[known], values[known]]), axis=0)
    ranks -= ranks.mean(axis=0)
    sizes = np.sqrt((ranks**2).sum(axis=0))
    products = (ranks[:, :-1] * ranks[:, -1:]).sum(axis=0)
    found = np.full(len(products), np.nan)
    np.divide(products, sizes[:-1] * sizes[-1], out=found, where=sizes[:-1] * sizes[-1] > 0)
    found = np.clip(found, -1, 1)
    half = float(ndtri((1 + confidence) / 2)) * np.sqrt((1 + found**2 / 2) / (count - 3))
    with np.errstate(divide="ignore"):
        middle = np.arctanh(found)
    return RankCorrelations(found, np.tanh(middle - half), np.tanh(middle + half), count)
