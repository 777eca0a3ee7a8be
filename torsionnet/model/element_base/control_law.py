"""Control law, the torque over the sensed motion as a quotient of polynomials, in any algebra."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeAlias

from torsionnet.model.element_base.laws import Values

Polynomial: TypeAlias = tuple[Any, ...]
"""Type of the coefficients of a polynomial, ascending in s."""
GAIN, PID, POLYNOMIALS, ROOTS, MATRICES = "gain", "PID", "polynomials", "zeros and poles", "state space"


@dataclass(frozen=True)
class ControlLaw:
    """Transfer function H(s) of a controller in the form in which the file gives it.

    Attributes
    ----------
    form : str
        ``gain``, ``PID``, ``polynomials``, ``zeros and poles`` or ``state space``.
    entries : tuple of (name, value)
        Expressions, or tuples of these; two of them deep for matrices and for pairs of roots.
    """

    form: str
    entries: tuple[tuple[str, Any], ...]

    def quotient(self, value: Values) -> tuple[Polynomial, Polynomial]:
        """Numerator and denominator of H(s), each as coefficients ascending in s, in the algebra of ``value``."""
        given = {name: _evaluated(one, value) for name, one in self.entries}
        if self.form == GAIN:
            return (given["gain"],), (1,)
        if self.form == PID:
            return _pid(given)
        if self.form == POLYNOMIALS:
            return given["numerator"][::-1], given["denominator"][::-1]
        if self.form == ROOTS:
            above = product((given["gain"],), _with_roots(given.get("zeros", ())))
            return above, _with_roots(given.get("poles", ()))
        return _of_matrices(given)


def _evaluated(entry: Any, value: Values) -> Any:
    return tuple(_evaluated(one, value) for one in entry) if isinstance(entry, tuple) else value(entry)


def _pid(given: dict[str, Any]) -> tuple[Polynomial, Polynomial]:
    """Numerator and denominator, ascending in s, of p + i/s + d s/(1 + T s), with T the filter's time constant."""
    lag: Polynomial = (1, given["filter"]) if "filter" in given else (1,)
    rate: Polynomial = (0, given["d"]) if "d" in given else ()
    if "i" not in given:
        return total(product((given.get("p", 0),), lag), rate), lag
    return total(product((given["i"], given.get("p", 0)), lag), (0, *rate) if rate else ()), product((0, 1), lag)


def _with_roots(roots: Sequence[Any]) -> Polynomial:
    """Coefficients of the monic polynomial of real roots and of pairs (re, im) of conjugate roots.

    A pair stands for re + j im and re - j im.
    """
    found: Polynomial = (1,)
    for root in roots:
        found = product(
            found, (root[0] * root[0] + root[1] * root[1], -2 * root[0], 1) if isinstance(root, tuple) else (-root, 1)
        )
    return found


def _of_matrices(given: dict[str, Any]) -> tuple[Polynomial, Polynomial]:
    """Numerator and denominator, ascending in s, of the state space that four matrices give.

    C (s I - A)^-1 B + D by the Faddeev-LeVerrier algorithm, which divides by whole numbers only.
    """
    A, B, C, D = (given[name] for name in "ABCD")
    n, zero = len(A), 0 * D
    adjugate = [[zero + (1 if i == j else 0) for j in range(n)] for i in range(n)]
    below, above = [1], []
    for k in range(1, n + 1):
        above.append(sum((C[i] * adjugate[i][j] * B[j] for i in range(n) for j in range(n)), start=zero))
        moved = [[sum((A[i][m] * adjugate[m][j] for m in range(n)), start=zero) for j in range(n)] for i in range(n)]
        last = -sum((moved[i][i] for i in range(n)), start=zero) * Fraction(1, k)
        below.append(last)
        adjugate = [[moved[i][j] + (last if i == j else 0) for j in range(n)] for i in range(n)]
    denominator = tuple(reversed(below))
    return total(tuple(reversed(above)), product((D,), denominator)), denominator


def product(first: Polynomial, second: Polynomial) -> Polynomial:
    """Coefficients, ascending in s, of the product of two polynomials.

    >>> product((1, 2), (3, 0, 1))
    (3, 6, 1, 2)
    """
    found: list[Any] = [0] * (len(first) + len(second) - 1)
    for i, a in enumerate(first):
        for j, b in enumerate(second):
            found[i + j] = found[i + j] + a * b
    return tuple(found)


def total(first: Polynomial, second: Polynomial) -> Polynomial:
    """Coefficients, ascending in s, of the sum of two polynomials."""
    longer, shorter = (first, second) if len(first) >= len(second) else (second, first)
    return tuple(a + b for a, b in zip(longer, shorter, strict=False)) + longer[len(shorter) :]
