"""Numerator and denominator as polynomials in s with named coefficients."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import sympy

from torsionnet.symbolics.algebras import Expressions, InPowersOfS, S, Terms, in_s
from torsionnet.symbolics.program import Node, Program

if TYPE_CHECKING:
    from torsionnet.symbolics.transfer_function import TransferFunction

SHORT = 60
"""Coefficients of at most so many terms are written expanded, longer ones nested."""


@dataclass(frozen=True)
class Rational:
    """(b_0 + b_1 s + ...) / (a_0 + a_1 s + ...).

    Attributes
    ----------
    numerator, denominator : tuple of sympy expressions
        Coefficients of 1, s, s^2, ...
    """

    numerator: tuple[Any, ...]
    denominator: tuple[Any, ...]

    @property
    def expression(self) -> Any:
        """The quotient, with the coefficients written out."""
        return in_s(self.numerator) / in_s(self.denominator)

    @cached_property
    def where(self) -> dict[Any, Any]:
        """Coefficient -> what it stands for; those that are zero are left out."""
        named = {"b": self.numerator, "a": self.denominator}
        return {
            sympy.Symbol(f"{letter}_{power}"): value
            for letter, coefficients in named.items()
            for power, value in enumerate(coefficients)
            if value != 0
        }

    @property
    def named(self) -> Any:
        """The quotient in the names of the coefficients."""
        above, below = (
            in_s(sympy.Symbol(f"{letter}_{power}") if value != 0 else 0 for power, value in enumerate(coefficients))
            for letter, coefficients in (("b", self.numerator), ("a", self.denominator))
        )
        return above / below

    @property
    def degrees(self) -> tuple[int, int]:
        """Of numerator and denominator."""
        return len(self.numerator) - 1, len(self.denominator) - 1


def rational(function: TransferFunction) -> Rational:
    """Coefficients in s, expanded where they are short."""
    algebra = InPowersOfS(Program().leaf)
    above, below = function.steps.run(algebra, [function.numerator, function.denominator])
    return Rational(*(_trimmed(part.coefficients) for part in (above, below)))


def _trimmed(coefficients: tuple[Any, ...]) -> tuple[Any, ...]:
    nodes = [value for value in coefficients if isinstance(value, Node)]
    if not nodes:
        return (sympy.Integer(0),)
    written = dict(zip((node.index for node in nodes), _tidied(nodes), strict=True))
    result = [written[value.index] if isinstance(value, Node) else sympy.Integer(0) for value in coefficients]
    while len(result) > 1 and result[-1] == 0:
        result.pop()
    return tuple(result)


def tidy(node: Any) -> Any:
    """A step as an expression: expanded if it is short."""
    return _tidied([node])[0]


def _tidied(nodes: list[Node]) -> list[Any]:
    program = nodes[0].program
    counts = program.run(Terms(), nodes)
    expressions = program.run(Expressions(), nodes)
    return [
        sympy.expand(expression) if terms <= SHORT else expression
        for terms, expression in zip(counts, expressions, strict=True)
    ]


__all__ = ["Rational", "S", "rational", "tidy"]
