"""Polynomial form of a transfer function, numerator and denominator in s with named coefficients."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

import sympy

from torsionnet.symbolic.algebra.algebras import InPowersOfS, TermCounts, in_s
from torsionnet.symbolic.algebra.network import Program, ProgramNode
from torsionnet.symbolic.algebra.raw import RawExpressions
from torsionnet.symbolic.algebra.sparse import Monomials, Sparse, monomials_for
from torsionnet.symbolic.formula_text import polynomial_latex, polynomial_text, where_text, with_where

if TYPE_CHECKING:
    from torsionnet.symbolic.symbolic_request import SymbolicFraction

MOST_EXPANDED_COEFFICIENT_TERMS = 60
"""Largest number of terms of a coefficient that is written multiplied out, as longer ones are shorter when nested."""
MOST_TERMS_EXPANDED_WHOLE = 4000
"""Largest number of terms of a transfer function that is multiplied out as a whole first, as more take too long."""


class NamedCoefficients(Protocol):
    """Protocol of the coefficients in s of a transfer function, which can be written as sympy expressions."""

    def expressions(self) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        """Coefficients of 1, s, s^2, ... of numerator and denominator as sympy expressions."""
        ...


@dataclass(frozen=True, repr=False)
class Rational:
    """Transfer function as a quotient of polynomials in s, (b_0 + b_1 s + ...) / (a_0 + a_1 s + ...).

    Attributes
    ----------
    coefficients : NamedCoefficients
        As calculated; expressions are made when first used.
    """

    coefficients: NamedCoefficients

    @cached_property
    def _written(self) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        above, below = (list(_trimmed(part)) for part in self.coefficients.expressions())
        # A drivetrain that turns freely has powers of s above and below.
        while min(len(above), len(below)) > 1 and above[0] == 0 and below[0] == 0:
            del above[0], below[0]
        return tuple(above), tuple(below)

    @property
    def numerator(self) -> tuple[Any, ...]:
        """Coefficients of 1, s, s^2, ... in the numerator of the transfer function, as sympy expressions."""
        return self._written[0]

    @property
    def denominator(self) -> tuple[Any, ...]:
        """Coefficients of 1, s, s^2, ... in the denominator of the transfer function, as sympy expressions."""
        return self._written[1]

    @property
    def expression(self) -> Any:
        """Transfer function as a sympy quotient of polynomials in s, with the coefficients written out."""
        return in_s(self.numerator) / in_s(self.denominator)

    @cached_property
    def where(self) -> dict[Any, Any]:
        """Sympy expression of each named coefficient (a_i, b_i) that is not zero, by name."""
        named = {"b": self.numerator, "a": self.denominator}
        return {
            sympy.Symbol(f"{letter}_{power}"): value
            for letter, coefficients in named.items()
            for power, value in enumerate(coefficients)
            if value != 0
        }

    @property
    def named(self) -> Any:
        """Transfer function as a sympy quotient of polynomials in s, in the names of the coefficients."""
        above, below = (in_s(names) for names in self._names)
        return above / below

    @property
    def _names(self) -> tuple[list[Any], list[Any]]:
        """Names of the coefficients of numerator and denominator as symbols, 0 for those that are zero."""
        above, below = (
            [sympy.Symbol(f"{letter}_{power}") if value != 0 else sympy.Integer(0) for power, value in enumerate(part)]
            for letter, part in (("b", self.numerator), ("a", self.denominator))
        )
        return above, below

    def __str__(self) -> str:
        above, below = (polynomial_text(names) for names in self._names)
        return where_text(f"({above})/({below})", self.where)

    __repr__ = __str__

    def to_latex(self) -> str:
        """LaTeX of the transfer function in named coefficients, followed by their definitions."""
        above, below = (polynomial_latex(names) for names in self._names)
        return with_where(rf"\frac{{{above}}}{{{below}}}", self.where)

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.to_latex()}$"


def _trimmed(coefficients: Sequence[Any]) -> tuple[Any, ...]:
    result = list(coefficients) or [sympy.Integer(0)]
    while len(result) > 1 and result[-1] == 0:
        result.pop()
    return tuple(result)


def rational(function: SymbolicFraction) -> Rational:
    """Polynomial form of a transfer function, its coefficients multiplied out if short, else nested."""
    program, outputs = function.steps, [function.numerator, function.denominator]
    if sum(program.run(TermCounts(), outputs)) <= MOST_TERMS_EXPANDED_WHOLE or len(function.free_symbols) <= 6:
        algebra = monomials_for(program.payloads(outputs))
        above, below = program.run(algebra, outputs)
        return Rational(ExpandedCoefficients(above, below, algebra))
    polynomials = program.run(InPowersOfS(Program().leaf), outputs)
    return Rational(ProgramCoefficients(*(polynomial.coefficients for polynomial in polynomials)))


@dataclass(frozen=True)
class ExpandedCoefficients:
    """Coefficients of a transfer function in s, from numerator and denominator multiplied out."""

    above: Sparse
    below: Sparse
    algebra: Monomials

    def expressions(self) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        depth = max(self.above.depth, self.below.depth)
        above, below = (
            tuple(
                self.algebra.expression(terms, part.scale**depth)
                for terms in self.algebra.by_power(Sparse(part.at_depth(depth), depth, part.scale))
            )
            for part in (self.above, self.below)
        )
        return above, below


@dataclass(frozen=True)
class ProgramCoefficients:
    """Coefficients of a transfer function in s as results of a straight-line program."""

    above: Sequence[Any]
    below: Sequence[Any]

    def expressions(self) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        nodes = [value for value in (*self.above, *self.below) if isinstance(value, ProgramNode)]
        found = dict(zip((node.index for node in nodes), to_expressions(nodes), strict=True))
        above, below = (
            tuple(found[value.index] if isinstance(value, ProgramNode) else sympy.Integer(0) for value in part)
            for part in (self.above, self.below)
        )
        return above, below


def to_expression(node: Any) -> Any:
    """Sympy expression of a program's result, multiplied out if short, else nested."""
    return to_expressions([node])[0]


def to_expressions(nodes: Sequence[ProgramNode]) -> list[Any]:
    """Sympy expressions of several results of one program, each multiplied out if short, else nested."""
    program = nodes[0].program
    counts = program.run(TermCounts(), nodes)
    short = [node for node, terms in zip(nodes, counts, strict=True) if terms <= MOST_EXPANDED_COEFFICIENT_TERMS]
    long = [node for node, terms in zip(nodes, counts, strict=True) if terms > MOST_EXPANDED_COEFFICIENT_TERMS]
    algebra = monomials_for(program.payloads(short))
    written = {
        node.index: algebra.expression(part.terms, part.scale**part.depth)
        for node, part in zip(short, program.run(algebra, short), strict=True)
    }
    raw = zip(long, program.run(RawExpressions(), long), strict=True)
    written |= {node.index: part.expression for node, part in raw}
    return [written[node.index] for node in nodes]


def factor_if_short(expression: Any) -> Any:
    """Factored form of a short real expression, a longer or complex one unchanged, as sympy takes too long on it."""
    easy = not expression.has(sympy.I) and sympy.count_ops(expression) <= MOST_EXPANDED_COEFFICIENT_TERMS
    return sympy.factor(expression) if easy else expression
