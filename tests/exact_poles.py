"""All roots of det D(s) of a blueprint in rationals, each enclosed by python-flint: no part of the package."""

from dataclasses import dataclass
from fractions import Fraction

import flint
import numpy as np
from scipy.optimize import linear_sum_assignment
from strategies import MP


@dataclass(frozen=True)
class Roots:
    """Roots of a polynomial: how many are zero, and the others with their multiplicity."""

    zeros: int
    others: tuple[tuple[complex, int], ...]

    @property
    def values(self):
        return np.array([root for root, count in self.others for _ in range(count)], complex)

    @property
    def real(self):
        return sum(count for root, count in self.others if root.imag == 0)


def rational(value):
    if isinstance(value, int | Fraction):
        return flint.fmpq(Fraction(value).numerator, Fraction(value).denominator)
    return rational(Fraction(MP.nstr(value, 40)))  # a shaft brings pi


def matrices(mechanics):
    """M, C and K over exact coordinates."""
    n = mechanics.degrees_of_freedom
    rows = [[(i, rational(x)) for i, x in enumerate(mechanics.reduced(term.row)) if x] for term in mechanics.terms]
    found = []
    for law in ("J", "c", "k"):
        matrix = flint.fmpq_mat(n, n)
        for row, term in zip(rows, mechanics.terms, strict=True):
            value = rational(getattr(term, law))
            for i, a in row:
                for j, b in row:
                    matrix[i, j] += value * a * b
        found.append(matrix)
    return found


def roots_of(determinant_at, degree):
    """Roots of the polynomial that takes these values at integers; None where it vanishes."""
    differences = [determinant_at(x) for x in range(degree + 1)]
    for order in range(1, degree + 1):
        for i in range(degree, order - 1, -1):
            differences[i] = (differences[i] - differences[i - 1]) / order
    polynomial = flint.fmpq_poly([])
    for x in range(degree, -1, -1):  # Newton's form
        polynomial = polynomial * flint.fmpq_poly([-x, 1]) + differences[x]
    coefficients = [int(value) for value in polynomial.numer().coeffs()]
    if not coefficients:
        return None
    zeros = next(i for i, value in enumerate(coefficients) if value)
    before, flint.ctx.prec = flint.ctx.prec, 200
    try:
        found = flint.fmpz_poly(coefficients[zeros:]).complex_roots()
        return Roots(zeros, tuple((complex(root), count) for root, count in found))
    finally:
        flint.ctx.prec = before


def poles(mechanics):
    """Roots of det(M s^2 + C s + K)."""
    M, C, K = matrices(mechanics)
    return roots_of(lambda s: (M * rational(s * s) + C * rational(s) + K).det(), 2 * mechanics.degrees_of_freedom)


def natural_frequencies(mechanics):
    """Square roots of the eigenvalues other than zero of M and K, ascending; None where a motion has neither."""
    M, _, K = matrices(mechanics)
    roots = roots_of(lambda x: (K - M * rational(x)).det(), mechanics.degrees_of_freedom)
    return None if roots is None else np.sort(np.sqrt(np.abs(roots.values)))


def errors(values, roots):
    """Relative error of each value (Im >= 0, one of each pair); None where there are not as many as roots."""
    values = np.asarray(values, complex)
    every = np.concatenate([values, values[values.imag != 0].conj()])
    if len(every) != len(roots.values):
        return None
    apart = np.abs(every[:, None] - roots.values) / np.abs(roots.values)
    ours, theirs = linear_sum_assignment(np.minimum(apart, 10.0))
    return apart[ours, theirs][: len(values)]
