"""Joint distribution of several parameters, joined by a Gaussian copula."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from torsionnet.linear.frequency_response import FloatArray
from torsionnet.study.space.variations.variation import Marginal


@dataclass(frozen=True, eq=False)
class JointDistribution:
    """Distributions of parameters, joined as functions of correlated normal variables (Gaussian copula).

    Attributes
    ----------
    marginals : mapping
        Parameter -> its distribution.
    root : (n, n) array or None
        Lower triangular factor from independent to correlated normal variables; None where nothing is correlated.
    """

    marginals: Mapping[str, Marginal]
    root: FloatArray | None

    def from_unit(self, shares: FloatArray) -> dict[str, FloatArray]:
        """Values (n,) in SI of each parameter, by its name, at points (n, n_names) of the unit cube.

        Where there is correlation, the values of a parameter depend on the shares of those before it, too.
        """
        if self.root is not None:
            from scipy.special import ndtri

            return self.from_standard_normal(ndtri(shares))
        return {name: one.ppf(shares[:, place]) for place, (name, one) in enumerate(self.marginals.items())}

    def from_standard_normal(self, normal: FloatArray) -> dict[str, FloatArray]:
        """Values (n,) in SI of each parameter, by its name, at independent standard normal variables (n, n_names)."""
        marginals = enumerate(self.marginals.items())
        return {name: one.from_normal(self._correlated(normal, place)) for place, (name, one) in marginals}

    def _correlated(self, normal: FloatArray, place: int) -> FloatArray:
        """Values (n,) of one correlated normal variable from independent ones (n, n_names).

        Summed term by term: a product of matrices rounds differently with the number of rows.
        """
        if self.root is None:
            return normal[:, place]
        row = self.root[place]
        return np.asarray(sum(row[term] * normal[:, term] for term in np.flatnonzero(row).tolist()))

    def to_standard_normal(self, values: Mapping[str, FloatArray]) -> FloatArray:
        """Independent standard normal variables (n, n_names) of parameter values (n,) in SI by name."""
        return self._independent(self._normal(values))

    def _normal(self, values: Mapping[str, FloatArray]) -> FloatArray:
        return np.stack([one.to_normal(values[name]) for name, one in self.marginals.items()], axis=-1)

    def _independent(self, correlated: FloatArray) -> FloatArray:
        return correlated if self.root is None else np.asarray(np.linalg.solve(self.root, correlated.T).T)

    def log_density(self, values: Mapping[str, FloatArray]) -> FloatArray:
        """Logarithm (n,) of the joint probability density at parameter values (n,) in SI by name."""
        found = np.sum([one.log_density(values[name]) for name, one in self.marginals.items()], axis=0)
        if self.root is None:
            return np.asarray(found)
        correlated = np.where(np.isfinite(found)[:, None], self._normal(values), 0.0)
        squares = (correlated**2).sum(axis=1) - (self._independent(correlated) ** 2).sum(axis=1)
        return np.asarray(found + squares / 2 - np.log(np.diag(self.root)).sum())
