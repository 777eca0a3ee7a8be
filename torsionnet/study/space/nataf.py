"""The correlation of normal variables behind variables of any distribution (Nataf's model).

Every variable is a function x(z) of a standard normal one. In Hermite polynomials x = sum_k a_k He_k(z)/sqrt(k!), and
two of them have the covariance sum_{k>0} a_k b_k rho^k where their normal variables have the correlation rho (Mehler).
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.optimize import brentq

from torsionnet.response.frequency_response import FloatArray
from torsionnet.study.space.variations.marginal import Marginal

TERMS = 80
REACH = 9.0
"""Standard deviations that are integrated over; beyond are 1e-19 of the variants."""
PANELS, NODES = 120, 8


class HermiteSeries:
    """Coefficients of a distribution, scaled to a standard deviation of 1."""

    def __init__(self, marginal: Marginal) -> None:
        nodes, weights = _nodes()
        x = marginal.from_normal(nodes)
        x = x - weights @ x
        self.coefficients = _polynomials(nodes)[1:] @ (weights * x) / np.sqrt(weights @ x**2)


def _nodes() -> tuple[FloatArray, FloatArray]:
    """Where functions of a standard normal variable are taken, and the share of the variants there."""
    inner, weights = leggauss(NODES)
    edges = np.linspace(-REACH, REACH, PANELS + 1)
    half = REACH / PANELS
    nodes = (edges[:-1, None] + half * (inner + 1)).ravel()
    density = np.exp(-(nodes**2) / 2) * np.tile(weights, PANELS)
    return nodes, density / density.sum()


def _polynomials(nodes: FloatArray) -> FloatArray:
    """He_k/sqrt(k!) for k up to TERMS, (TERMS + 1, n)."""
    rows = [np.ones_like(nodes), nodes]
    for k in range(1, TERMS):
        rows.append((nodes * rows[k] - np.sqrt(k) * rows[k - 1]) / np.sqrt(k + 1))
    return np.array(rows)


class CorrelationOfPair:
    """The correlation of two variables over that of the normal variables behind them."""

    def __init__(self, first: HermiteSeries, second: HermiteSeries) -> None:
        self._powers = np.concatenate([[0.0], first.coefficients * second.coefficients])

    def of_values(self, of_normals: float) -> float:
        return float(np.polynomial.polynomial.polyval(of_normals, self._powers))

    @property
    def range(self) -> tuple[float, float]:
        """Between which correlations of the values can be."""
        return self.of_values(-1.0), self.of_values(1.0)

    def of_normals(self, of_values: float) -> float:
        """Inverse of :meth:`of_values`, for a value in its range."""
        if of_values == 0:
            return 0.0
        return float(brentq(lambda rho: self.of_values(rho) - of_values, -1.0, 1.0, xtol=1e-14))
