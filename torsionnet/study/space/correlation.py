"""Correlation entry of a study file, which says which parameters vary together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Text, entry
from torsionnet.base.errors import Fault, unknown_name
from torsionnet.base.registers import Groups
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.study.space.variations.variation import Marginal


@dataclass(frozen=True, kw_only=True)
class Correlation(Declared):
    """Linear correlation, from -1 to 1, of the values of parameters, of every two where more are named.

    The distributions are those of the parameters all the same; they are joined as functions of correlated normal
    variables (a Gaussian copula, in structural reliability Nataf's model).

    Examples
    --------
    >>> Correlation(between=["k_1", "k_2"], coefficient=0.6).to_data()
    {'between': ['k_1', 'k_2'], 'coefficient': 0.6}
    """

    kind: ClassVar[str] = "correlation"
    article: ClassVar[str] = "a correlation"
    form: ClassVar[str] = "{between: [k_1, k_2], coefficient: 0.6}"

    between: tuple[str, ...] = entry(Listed("parameters", Text("name of a parameter"), form="a list of parameters"))
    coefficient: float = entry(Value("linear correlation of the values, above -1 and below 1", "1", lower=None))

    def contradictions(self) -> list[Fault]:
        faults = []
        if len(self.between) < 2:
            faults.append(Fault("a correlation is between two parameters or more", ("between",), kind="wrong-count"))
        faults += [
            Fault(f"{name} stands twice", ("between", index), kind="repeated-name")
            for index, name in enumerate(self.between)
            if name in self.between[:index]
        ]
        if not -1 < self.coefficient < 1:
            text = f"a correlation lies between -1 and 1, got {self.coefficient:g}"
            if abs(self.coefficient) == 1:
                text = f"{text}; what follows another parameter exactly is an expression of that in the model"
            faults.append(Fault(text, ("coefficient",), kind="out-of-range"))
        return faults

    @property
    def pairs(self) -> Iterator[tuple[str, str]]:
        """Pairs of names of all correlated parameters."""
        return combinations(self.between, 2)


def name_faults(correlations: Sequence[Correlation], random: Sequence[str], grid: Sequence[str]) -> list[Fault]:
    """Faults of correlations that name a parameter without distribution, or a pair twice."""
    faults = []
    seen: dict[frozenset[str], int] = {}
    for index, correlation in enumerate(correlations):
        for place, name in enumerate(correlation.between):
            path = (index, "between", place)
            if name in grid:
                text = (
                    f"{name} takes the values of a list or range one after the other, and can be correlated with none"
                )
                faults.append(Fault(f"{text}; give it a distribution", path, kind="contradicting-entries"))
            elif name not in random:
                rest = f"with a distribution there is {', '.join(random) or 'none'}"
                faults.append(unknown_name("varied parameter", name, random, path, rest=rest))
        for pair in map(frozenset, correlation.pairs):
            if pair in seen:
                text = f"the correlation of {' and '.join(sorted(pair))} is given twice"
                faults.append(Fault(text, (index, "between"), kind="contradicting-entries"))
            seen[pair] = index
    return faults


# Correlation matrix of the normal variables behind the parameters of a study, and its faults.

HERMITE_TERMS = 80
"""Highest degree of the Hermite series of a distribution, as one with fewer fits skewed distributions worse."""
INTEGRATED_DEVIATIONS = 9.0
"""Standard deviations to both sides of a distribution that are integrated over, as 1e-19 of variants lie beyond."""
ROUNDED = 1e-12
"""Standard deviation over the mean below which rounding makes up the spread of a distribution."""
PANELS, NODES = 120, 8
"""Panels of the Gauss-Legendre quadrature over a normal variable, and nodes in each."""


class HermiteSeries:
    """Coefficients of a distribution in Hermite polynomials of a normal variable, for a standard deviation of 1."""

    def __init__(self, marginal: Marginal) -> None:
        nodes, weights = _nodes()
        x = marginal.from_normal(nodes)
        # a_k = E(x He_k/sqrt(k!)) over the standard deviation, of x without its mean.
        mean = weights @ x
        x = x - mean
        self.coefficients = _polynomials(nodes)[1:] @ (weights * x)
        deviation = np.sqrt(weights @ x**2)
        if deviation > ROUNDED * abs(mean):
            self.coefficients /= deviation
        else:  # a spread of rounding: over so little any distribution is straight, x = a_1 z
            self.coefficients = np.eye(len(self.coefficients))[0]


def _nodes() -> tuple[FloatArray, FloatArray]:
    """Nodes (n,) and weights (n,) of the quadrature over a standard normal variable."""
    from numpy.polynomial.legendre import leggauss

    # Gauss and Legendre's rule in equal panels, with the weight exp(-x^2/2), summing up to 1.
    inner, weights = leggauss(NODES)
    edges = np.linspace(-INTEGRATED_DEVIATIONS, INTEGRATED_DEVIATIONS, PANELS + 1)
    half = INTEGRATED_DEVIATIONS / PANELS
    nodes = (edges[:-1, None] + half * (inner + 1)).ravel()
    density = np.exp(-(nodes**2) / 2) * np.tile(weights, PANELS)
    return nodes, density / density.sum()


def _polynomials(nodes: FloatArray) -> FloatArray:
    """Normalised Hermite polynomials (HERMITE_TERMS + 1, n) at nodes (n,), He_k/sqrt(k!) of degree k in row k."""
    rows = [np.ones_like(nodes), nodes]
    # He_(k+1) = x He_k - k He_(k-1), each over the root of its factorial.
    for k in range(1, HERMITE_TERMS):
        rows.append((nodes * rows[k] - np.sqrt(k) * rows[k - 1]) / np.sqrt(k + 1))
    return np.array(rows)


class CorrelationOfPair:
    """Correlation of two parameters as a function of that of the normal variables behind them."""

    def __init__(self, first: HermiteSeries, second: HermiteSeries) -> None:
        # Mehler: the correlation of the values is the sum of a_k b_k rho^k over k from 1, rho that of the normals.
        self._powers = np.concatenate([[0.0], first.coefficients * second.coefficients])

    def of_values(self, of_normals: float) -> float:
        return float(np.polynomial.polynomial.polyval(of_normals, self._powers))

    @property
    def range(self) -> tuple[float, float]:
        """Lowest and highest correlation, from -1 to 1, that the values of the two parameters can have."""
        return self.of_values(-1.0), self.of_values(1.0)

    def of_normals(self, of_values: float) -> float:
        """Correlation of the normal variables with which the two parameters have the correlation ``of_values``."""
        if of_values == 0:
            return 0.0
        from scipy.optimize import brentq

        return float(brentq(lambda rho: self.of_values(rho) - of_values, -1.0, 1.0, xtol=1e-14))


LEAST_EIGENVALUE = 1e-10
"""Smallest eigenvalue of a correlation matrix that counts as above 0, as below Cholesky factors lose their digits."""
INVOLVED_SHARE = 0.05
"""Share of the largest component of an eigenvector above which a message names the parameter as involved."""
Pair = tuple[int, str, str]
"""Place of a pair of correlated parameters in the entry, and their two names."""


def normal_correlation(
    correlations: Sequence[Correlation], marginals: Mapping[str, Marginal]
) -> tuple[FloatArray, list[Fault]]:
    """Correlation matrix (n, n) of the normal variables behind all n parameters, and faults where it cannot exist."""
    names = list(marginals)
    given, matrix = np.eye(len(names)), np.eye(len(names))
    series = {name: HermiteSeries(marginals[name]) for correlation in correlations for name in correlation.between}
    faults = []
    for index, first, second in _pairs(correlations):
        coefficient = correlations[index].coefficient
        pair = CorrelationOfPair(series[first], series[second])
        low, high = pair.range
        at = names.index(first), names.index(second)
        given[at] = given[at[::-1]] = coefficient
        if not low < coefficient < high:
            text = f"{first} and {second} can only be correlated from {low:.3f} to {high:.3f} with their distributions"
            faults.append(Fault(f"{text}, got {coefficient:g}", (index, "coefficient"), kind="out-of-range"))
            continue
        # Nataf: the normal variables take the correlation with which the values have the given one.
        matrix[at] = matrix[at[::-1]] = pair.of_normals(coefficient)
    if not faults:
        faults = list(_contradictions(correlations, names, given, "contradict each other"))
    if not faults:
        faults = list(_contradictions(correlations, names, matrix, "contradict each other with these distributions"))
    return matrix, faults


def _pairs(correlations: Sequence[Correlation]) -> Iterator[Pair]:
    return ((index, *pair) for index, correlation in enumerate(correlations) for pair in correlation.pairs)


def _contradictions(
    correlations: Sequence[Correlation], names: Sequence[str], matrix: FloatArray, what: str
) -> Iterator[Fault]:
    """Yield the faults of coefficients that contradict each other, one for each group of correlated parameters."""
    if _least(matrix) >= LEAST_EIGENVALUE:
        return
    together: Groups[str] = Groups()
    for _, first, second in _pairs(correlations):
        together.join(first, second)
    for group in together.groups():
        members = [names.index(name) for name in group]
        part = matrix[np.ix_(members, members)]
        if _least(part) < LEAST_EIGENVALUE:
            yield _contradiction([pair for pair in _pairs(correlations) if pair[1] in group], group, part, what)


def _contradiction(pairs: Sequence[Pair], group: Sequence[str], matrix: FloatArray, what: str) -> Fault:
    """Fault of a matrix that is not positive definite, with the smallest change of a coefficient that mends it."""
    # The vector of the smallest eigenvalue shows which parameters contradict each other.
    values, vectors = np.linalg.eigh(matrix)
    weights = np.abs(vectors[:, 0])
    involved = [name for name, weight in zip(group, weights, strict=True) if weight > INVOLVED_SHARE * weights.max()]
    text = f"the correlations of {', '.join(involved)} {what}: the smallest eigenvalue is {values[0]:.3g}, not above 0"
    repairs = []
    for pair in pairs:
        at = group.index(pair[1]), group.index(pair[2])
        span = _possible(matrix, *at)
        if span is not None:
            repairs.append((min(abs(end - matrix[at]) for end in span), pair, span))
    if not repairs:
        index = next(index for index, *pair in pairs if set(pair) <= set(involved))
        return Fault(
            f"{text}, and no change of a single one would do", (index, "coefficient"), kind="contradicting-values"
        )
    _, (index, first, second), (low, high) = min(repairs)
    text = f"{text}; with the others as they are, {first} and {second} can be correlated from {low:.3f} to {high:.3f}"
    return Fault(text, (index, "coefficient"), kind="contradicting-values")


def _least(matrix: FloatArray) -> float:
    return float(np.linalg.eigvalsh(matrix)[0])


def _possible(matrix: FloatArray, i: int, j: int) -> tuple[float, float] | None:
    """Lowest and highest coefficient of one pair with which the correlation matrix is positive definite.

    None if there is none.

    They are those of which the partial correlation, given all other parameters, lies between -1 and 1.
    """
    rest = [k for k in range(len(matrix)) if k not in (i, j)]
    inner, along = matrix[np.ix_(rest, rest)], matrix[np.ix_(rest, (i, j))]
    if rest and _least(inner) < LEAST_EIGENVALUE:
        return None
    # Schur complement: rho_ij = a_i^T R^-1 a_j +- sqrt((1 - a_i^T R^-1 a_i)(1 - a_j^T R^-1 a_j)).
    known = along.T @ np.linalg.solve(inner, along)
    free = 1 - np.diag(known)
    if min(free) <= 0:
        return None
    reach = float(np.sqrt(free[0] * free[1]))
    return float(known[0, 1]) - reach, float(known[0, 1]) + reach
