"""Algebras that evaluate the program of a transfer function as expressions, polynomials, term counts or numbers.

Here as well: tests whether a symbolic polynomial or coefficient is zero for all values of its symbols; base class of
results that sympy takes for their expressions.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import sympy

from torsionnet.base.packages import AttributeHints
from torsionnet.base.program import Program, ProgramAlgebra, ProgramNode
from torsionnet.symbolic.algebra.network import Stiffness

S = sympy.Symbol("s")


class SympyForm(AttributeHints):
    """Base class of what sympy's functions, printers and operators take for its expression.

    So they do also where sympy has a class of the same name.
    """

    _sympy_: Callable[[], Any]

    def __neg__(self) -> Any:
        return -self._sympy_()

    def _latex(self, printer: Any) -> Any:
        return printer._print(self._sympy_())  # noqa: SLF001  # what sympy asks of such a method

    _pretty = _sympystr = _sympyrepr = _mathml = _latex

    def __add__(self, other: Any) -> Any:
        return self._sympy_() + other

    def __radd__(self, other: Any) -> Any:
        return other + self._sympy_()

    def __sub__(self, other: Any) -> Any:
        return self._sympy_() - other

    def __rsub__(self, other: Any) -> Any:
        return other - self._sympy_()

    def __mul__(self, other: Any) -> Any:
        return self._sympy_() * other

    def __rmul__(self, other: Any) -> Any:
        return other * self._sympy_()

    def __truediv__(self, other: Any) -> Any:
        return self._sympy_() / other

    def __rtruediv__(self, other: Any) -> Any:
        return other / self._sympy_()

    def __pow__(self, other: Any) -> Any:
        return self._sympy_() ** other


@dataclass(frozen=True)
class Expressions(ProgramAlgebra):
    """Algebra of sympy expressions, nested as the program is, with ``change`` applied to every input of the program."""

    change: Callable[[Any], Any] = lambda expression: expression

    def leaf(self, payload: Any) -> Any:
        if isinstance(payload, Fraction):
            return sympy.Rational(payload.numerator, payload.denominator)
        if isinstance(payload, Stiffness):
            return in_s(self.change(part) for part in payload.parts)
        return self.change(payload)


def in_s(coefficients: Iterable[Any]) -> Any:
    """Sympy sum of coefficient * s^power over coefficients in ascending powers, without multiplying out."""
    return sympy.Add(*(sympy.Mul(part, S**power) for power, part in enumerate(coefficients) if part != 0))


def is_zero(value: Any) -> bool:
    """Whether an element of an algebra is zero exactly, as can be told without any calculation."""
    return value.is_zero if isinstance(value, ProgramNode) else bool(value == 0)


@dataclass(frozen=True)
class InPowersOfS(ProgramAlgebra):
    """Algebra of polynomials in s as tuples of the coefficients of 1, s, s^2, ...

    ``coefficient`` makes the coefficients from Fractions and sympy expressions. With a ``limit``, only that many are
    calculated, from the lowest.

    Examples
    --------
    >>> polynomials = InPowersOfS(int)
    >>> polynomials.add(polynomials.multiply((1, 2), (0, 3)), (1,))
    (1, 3, 6)
    """

    coefficient: Callable[[Any], Any]
    limit: int | None = None

    def leaf(self, payload: Any) -> tuple[Any, ...]:
        if isinstance(payload, Stiffness):
            parts = [self.coefficient(part) if part != 0 else 0 for part in payload.parts]
            while parts and is_zero(parts[-1]):
                parts.pop()
            return tuple(parts[: self.limit])
        return (self.coefficient(payload),)[: self.limit]

    def add(self, left: tuple[Any, ...], right: tuple[Any, ...]) -> tuple[Any, ...]:
        longer, shorter = (right, left) if len(left) < len(right) else (left, right)
        both = tuple(a + b for a, b in zip(longer, shorter, strict=False))
        return both + longer[len(both) :]

    def multiply(self, left: tuple[Any, ...], right: tuple[Any, ...]) -> tuple[Any, ...]:
        if not left or not right:
            return ()
        size = len(left) + len(right) - 1
        # Lower coefficients do not depend on higher ones, so that none beyond the limit is ever needed.
        total: list[Any] = [0] * (size if self.limit is None else min(size, self.limit))
        for i, a in enumerate(left):
            if is_zero(a):
                continue
            for j, b in enumerate(right[: len(total) - i]):
                if not is_zero(b):
                    total[i + j] = a * b if is_zero(total[i + j]) else total[i + j] + a * b
        return tuple(total)


class Lengths(ProgramAlgebra):
    """Algebra that counts symbols, stiffnesses and numbers of nested expressions, each as often as it appears."""

    def leaf(self, payload: Any) -> int:
        del payload
        return 1

    def multiply(self, left: int, right: int) -> int:
        return left + right


def evaluate_expression(expression: Any, element: Callable[[Any], Any]) -> Any:
    """Value of a sympy expression in any algebra, in which ``element`` gives its numbers, names, pi and roots.

    Sums, products and whole powers are done in the algebra itself.
    """
    if isinstance(expression, sympy.Add | sympy.Mul):
        parts = [evaluate_expression(part, element) for part in expression.args]
        result = parts[0]
        for part in parts[1:]:
            result = result + part if isinstance(expression, sympy.Add) else result * part
        return result
    if isinstance(expression, sympy.Pow) and expression.exp.is_Integer:
        base = evaluate_expression(expression.base, element)
        power = _power(base, abs(int(expression.exp)))
        return power if expression.exp > 0 else element(sympy.Integer(1)) / power
    return element(expression)


def _power(base: Any, exponent: int) -> Any:
    result = base
    for _ in range(exponent - 1):
        result = result * base
    return result


def exact_fraction(value: Any) -> Fraction:
    """Python Fraction equal to a rational number of sympy."""
    return Fraction(int(value.p), int(value.q))


def vanishes(node: ProgramNode) -> bool:
    """Whether a program's result, a polynomial in s, is zero for all values of s and of the symbols."""
    if node.is_zero:
        return True
    (polynomial,) = node.program.values_in(InPowersOfS(Program().leaf), [node])
    return all(surely_zero(value) for value in polynomial)


def surely_zero(node: ProgramNode | int) -> bool:
    """Whether a program's result is zero for all values of the symbols, tested at exact random numbers."""
    if not isinstance(node, ProgramNode):
        return node == 0
    if node.is_zero:
        return True
    # Exact random numbers, the same for a symbol in every run: a polynomial other than zero hardly ever
    # vanishes there (Schwartz and Zippel).
    chosen: dict[Any, Fraction] = {}

    def number(expression: Any) -> Fraction:
        if expression.is_Rational:
            return exact_fraction(expression)
        return chosen.setdefault(expression, Fraction(random.Random(str(expression)).randrange(10**6, 10**7)))

    class Chance(ProgramAlgebra):
        def leaf(self, payload: Any) -> Fraction:
            return payload if isinstance(payload, Fraction) else evaluate_expression(payload, number)

    return bool(node.program.values_in(Chance(), [node])[0] == 0)
