"""Sobol indices of a function of independent parameters, with bootstrap intervals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.errors import SolveError, UsageError
from torsionnet.study.answers.point_functions import OfPoints

RESAMPLES = 1000
FEWEST = 64
"""Base points, below which intervals say nothing."""


@dataclass(frozen=True, eq=False)
class SobolEstimates:
    """Indices (d,) of every parameter; ``_low`` and ``_high`` are the ends of their intervals. All are from 0 to 1.

    ``variance`` is that of the quantity, ``evaluations`` the number of variants, ``without_value`` how many base points
    were left out because one of their variants has no value.
    """

    first: FloatArray
    first_low: FloatArray
    first_high: FloatArray
    total: FloatArray
    total_low: FloatArray
    total_high: FloatArray
    variance: float
    evaluations: int
    without_value: int


def sobol_estimates(
    function: OfPoints, n_parameters: int, base: int, seed: int, confidence: float = 0.95
) -> SobolEstimates:
    """First order and total indices by the estimators of Saltelli (2010) and Jansen.

    Two independent halves A and B of one scrambled Sobol sequence, and for every parameter A with that column from B:
    base (d + 2) variants. Intervals are percentiles over resampled base points, which takes those for independent
    and makes the intervals wider than needed. The estimates are those of :func:`scipy.stats.sobol_indices`, whose
    bootstrap takes no seed; here the same seed gives the same bytes.

    Parameters
    ----------
    function : callable
        Values (n,) at points (n, d) of the unit cube, from which distributions are made.
    n_parameters : int
    base : int
        Base points, a power of two.
    seed : int
    confidence : float

    Raises
    ------
    UsageError
        Too few base points, or no power of two.
    SolveError
        The quantity does not vary, or has hardly any values.
    """
    return estimates_of(function(sobol_points(n_parameters, base, seed)), base, seed, confidence)


def sobol_points(n_parameters: int, base: int, seed: int) -> FloatArray:
    """Points of the unit cube (base (d + 2), d): A, B, and A with one column after the other from B."""
    from scipy.stats import qmc

    if base < FEWEST or base & (base - 1):
        raise UsageError(f"the number of base points must be a power of two, {FEWEST} or more; got {base}")
    pair = qmc.Sobol(2 * n_parameters, rng=np.random.default_rng(seed)).random(base)
    first, second = pair[:, :n_parameters], pair[:, n_parameters:]
    exchanged = [np.where(np.arange(n_parameters) == column, second, first) for column in range(n_parameters)]
    return np.concatenate([first, second, *exchanged])


def estimates_of(at_points: FloatArray, base: int, seed: int, confidence: float = 0.95) -> SobolEstimates:
    """Indices by the values at :func:`sobol_points`; base points with a value missing are left out."""
    values = at_points.reshape(-1, base)
    whole = np.isfinite(values).all(axis=0)
    if whole.sum() < FEWEST:
        raise SolveError(f"only {whole.sum()} of {base} base points have values for all of their variants")
    terms = _terms(values[:, whole])
    numbers = np.random.default_rng([seed, 1])
    drawn = np.array([_indices(terms[numbers.integers(len(terms), size=len(terms))]) for _ in range(RESAMPLES)])
    tail = (1 - confidence) / 2
    # A share of a variance: an interval holds its truth as often without the part that lies beyond 0 or 1.
    low, high = np.clip(np.quantile(drawn, [tail, 1 - tail], axis=0), 0.0, 1.0)
    found = np.clip(_indices(terms), 0.0, 1.0)
    variance = float(values[:2, whole].var())
    return SobolEstimates(
        found[0], low[0], high[0], found[1], low[1], high[1], variance, values.size, base - int(whole.sum())
    )


def _terms(values: FloatArray) -> FloatArray:
    """What indices are means of, for each base point (n, 2 d + 2): numerators, then moments of A and B."""
    a, b = values[:2] - values[:2].mean()
    if np.ptp(values[:2]) <= 1e-12 * np.abs(values[:2]).max():
        raise SolveError("the quantity does not vary, so that nothing has a share in its variance")
    moved = values[2:] - values[:2].mean()
    return np.column_stack([*(b * (moved - a)), *((a - moved) ** 2 / 2), (a + b) / 2, (a**2 + b**2) / 2])


def _indices(terms: FloatArray) -> FloatArray:
    """First order and total indices (2, d)."""
    means = terms.mean(axis=0)
    variance = means[-1] - means[-2] ** 2
    return np.asarray(means[:-2].reshape(2, -1) / variance)
