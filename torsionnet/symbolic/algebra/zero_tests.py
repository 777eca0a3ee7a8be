"""Tests whether a symbolic polynomial or coefficient is zero for all values of its symbols."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

from torsionnet.symbolic.algebra.algebras import InPowersOfS, evaluate_expression
from torsionnet.symbolic.algebra.program import Program, ProgramNode


def exact_fraction(value: Any) -> Fraction:
    """Python Fraction equal to a rational number of sympy."""
    return Fraction(int(value.p), int(value.q))


def vanishes(node: ProgramNode) -> bool:
    """Whether a program's result, a polynomial in s, is zero for all values of s and of the symbols."""
    if node.is_zero:
        return True
    (polynomial,) = node.program.run(InPowersOfS(Program().leaf), [node])
    return all(surely_zero(value) for value in polynomial.coefficients)


def surely_zero(node: ProgramNode | int) -> bool:
    """Whether a program's result is zero for all values of the symbols, tested at exact random numbers."""
    if not isinstance(node, ProgramNode):
        return node == 0
    if node.is_zero:
        return True
    chosen: dict[Any, Fraction] = {}

    def number(expression: Any) -> Fraction:
        if expression.is_Rational:
            return exact_fraction(expression)
        return chosen.setdefault(expression, Fraction(random.Random(str(expression)).randrange(10**6, 10**7)))

    class Chance:
        def leaf(self, payload: Any) -> Fraction:
            return payload if isinstance(payload, Fraction) else evaluate_expression(payload, number)

    return bool(node.program.run(Chance(), [node])[0] == 0)
