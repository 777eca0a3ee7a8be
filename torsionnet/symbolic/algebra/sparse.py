"""Fully expanded polynomials in parameters and s, exact, as maps from packed exponents to integers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import lcm
from typing import Any

import sympy

from torsionnet.base.program import ProgramAlgebra
from torsionnet.symbolic.algebra.algebras import S
from torsionnet.symbolic.algebra.network import Stiffness

EXPONENT_BITS = 12
"""Number of bits for the exponent of one generator in a packed monomial, enough for exponents up to 4095."""
EXPONENT_MASK = (1 << EXPONENT_BITS) - 1
"""Bit mask that extracts the exponent of one generator from a packed monomial."""


@dataclass(frozen=True, eq=False, slots=True)
class Sparse:
    """Sparse polynomial in parameters and s, a sum of integer * monomial over scale^depth.

    A monomial is one integer, with ``EXPONENT_BITS`` bits for the exponent of each generator, so that monomials
    multiply by adding. Fractions are kept out: all numbers have one common denominator, the scale.
    """

    terms: dict[int, int]
    depth: int
    scale: int

    def at_depth(self, depth: int) -> dict[int, int]:
        """Integer coefficients of a sparse polynomial by packed monomial, for the common denominator scale^depth."""
        if depth == self.depth:
            return self.terms
        factor = self.scale ** (depth - self.depth)
        return {monomial: number * factor for monomial, number in self.terms.items()}


@dataclass(frozen=True)
class Monomials(ProgramAlgebra):
    """Algebra of sparse polynomials in s, parameters, and inverses and roots of parameters."""

    generators: tuple[Any, ...]
    scale: int

    @cached_property
    def _place(self) -> Mapping[Any, int]:
        return {generator: EXPONENT_BITS * position for position, generator in enumerate(self.generators)}

    def leaf(self, payload: Any) -> Sparse:
        """Sparse polynomial of a program's input (a constant, an expression or a dynamic stiffness)."""
        depth = 0 if _is_whole(payload) else 1
        terms: dict[int, int] = {}
        for power, part in enumerate(_parts(payload)):
            for number, factors in monomials(part):
                # Exponents in fields of bits, so that monomials multiply by adding.
                key = sum(times << self._place[name] for name, times in factors.items()) + (power << self._place[S])
                value = number * self.scale**depth
                terms[key] = terms.get(key, 0) + value.numerator
        return Sparse(terms, depth, self.scale)

    def add(self, left: Sparse, right: Sparse) -> Sparse:
        depth = max(left.depth, right.depth)
        shorter, longer = left.at_depth(depth), right.at_depth(depth)
        if len(shorter) >= len(longer):
            shorter, longer = longer, shorter
        total = dict(longer)
        for monomial, number in shorter.items():
            total[monomial] = total.get(monomial, 0) + number
        return Sparse(total, depth, self.scale)

    def multiply(self, left: Sparse, right: Sparse) -> Sparse:
        shorter, longer = left.terms, right.terms
        if len(shorter) > len(longer):
            shorter, longer = longer, shorter
        total: dict[int, int] = {}
        for monomial, number in shorter.items():
            if not total:
                # Multiplied by one monomial, different monomials stay different: nothing to add up yet.
                total = {monomial + more: number * times for more, times in longer.items()}
                continue
            for more, times in longer.items():
                key = monomial + more
                total[key] = total.get(key, 0) + number * times
        return Sparse(total, left.depth + right.depth, self.scale)

    def by_power(self, polynomial: Sparse) -> list[dict[int, int]]:
        """Coefficients by packed monomial of a sparse polynomial, for each power of s from 0 on, no cancelled ones."""
        shift = self._place[S]
        coefficients: dict[int, dict[int, int]] = {}
        for monomial, number in polynomial.terms.items():
            if number:
                power = monomial >> shift & EXPONENT_MASK
                coefficients.setdefault(power, {})[monomial - (power << shift)] = number
        return [coefficients.get(power, {}) for power in range(max(coefficients, default=0) + 1)]

    def as_dict(self, polynomial: Sparse) -> dict[tuple[int, ...], Any]:
        """Rational coefficients of a sparse polynomial by the exponents of its generators, as in sympy's rings."""
        divisor = polynomial.scale**polynomial.depth
        return {
            tuple(monomial >> place & EXPONENT_MASK for place in self._place.values()): sympy.QQ(number, divisor)
            for monomial, number in polynomial.terms.items()
            if number
        }

    def expression(self, terms: Mapping[int, int], divisor: int = 1) -> Any:
        """Sympy sum of the terms of a sparse polynomial, given as integers by packed monomial, over a divisor."""
        return sympy.Add(*self._terms(terms, divisor))

    def _terms(self, terms: Mapping[int, int], divisor: int) -> Iterator[Any]:
        for monomial, number in terms.items():
            factors = [
                generator ** (monomial >> place & EXPONENT_MASK)
                for generator, place in self._place.items()
                if monomial >> place & EXPONENT_MASK
            ]
            if number:
                yield sympy.Mul(sympy.Rational(number, divisor), *factors)


def monomials_for(payloads: Iterable[Any]) -> Monomials:
    """Algebra of sparse polynomials in which all given stiffnesses and expressions can be written."""
    names: dict[Any, None] = {}
    scale = 1
    for payload in payloads:
        for part in _parts(payload):
            for number, factors in monomials(part):
                names |= dict.fromkeys(factors)
                scale = lcm(scale, number.denominator)
    return Monomials((S, *sorted(set(names) - {S}, key=str)), scale)


def _parts(payload: Any) -> tuple[Any, ...]:
    return payload.parts if isinstance(payload, Stiffness) else (payload,)


def _is_whole(payload: Any) -> bool:
    return all(number.denominator == 1 for part in _parts(payload) for number, _ in monomials(part))


def monomials(expression: Any) -> list[tuple[Fraction, dict[Any, int]]]:
    """Coefficient, and exponents by generator, of every term of an expression multiplied out."""
    if isinstance(expression, Fraction):
        return [(expression, {})] if expression else []
    if expression.is_Symbol:
        return [(Fraction(1), {expression: 1})]
    if expression.is_Rational:
        return [(Fraction(expression.p, expression.q), {})] if expression else []
    return [_monomial(term) for term in sympy.Add.make_args(sympy.expand(expression)) if term != 0]


def _monomial(term: Any) -> tuple[Fraction, dict[Any, int]]:
    number, rest = term.as_coeff_Mul()
    factors: dict[Any, int] = {}
    for factor in sympy.Mul.make_args(rest):
        base, power = factor.as_base_exp()
        if factor == 1:
            continue
        key, times = factor, 1
        if power.is_Integer:
            # Negative powers are powers of the inverse, a generator of its own.
            key, times = (base, int(power)) if power > 0 else (1 / base, -int(power))
        factors[key] = factors.get(key, 0) + times
    return Fraction(number.p, number.q), factors


class TermCounts(ProgramAlgebra):
    """Algebra of upper bounds of the number of terms of a program's results when multiplied out."""

    def leaf(self, payload: Any) -> int:
        parts = payload.parts if isinstance(payload, Stiffness) else (payload,)
        return sum(terms_of(part) for part in parts)


def terms_of(expression: Any) -> int:
    """Number of terms of a sympy expression or Fraction when multiplied out."""
    if isinstance(expression, Fraction):
        return int(expression != 0)
    if not isinstance(expression, sympy.Add | sympy.Mul | sympy.Pow):
        return int(expression != 0)
    return len(sympy.Add.make_args(sympy.expand(expression)))
