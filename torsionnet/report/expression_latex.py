"""Expressions of a model file in LaTeX, in the order they were written in."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from torsionnet.core.expressions import Binary, Expression, Name, Negative, Number, Pi, Power, SquareRoot
from torsionnet.symbolic.symbol_names import symbol_latex

SUM, PRODUCT, QUOTIENT, ATOM = 1, 2, 3, 4
"""How strongly the parts of an expression hold together."""


def expression_latex(tree: Expression) -> str:
    r"""LaTeX of an expression.

    >>> from torsionnet.core.expressions import scalar
    >>> expression_latex(scalar("I_1 - I_MT")), expression_latex(scalar("pi*G*d**4/(32*L)"))
    ('I_{1} - I_{\\mathrm{MT}}', '\\frac{\\pi G d^{4}}{32 L}')
    >>> expression_latex(scalar("-r_p/(2*(a + b)*3)"))
    '- \\frac{r_{p}}{2 \\left(a + b\\right) \\cdot 3}'
    """
    return _WRITERS[type(tree)](tree)


def _number(tree: Number) -> str:
    value = tree.value
    if isinstance(value, Fraction) and value.denominator == 1:
        return str(value.numerator)
    return f"{float(value):.6g}"


def _binary(tree: Binary) -> str:
    left, right = tree.left, tree.right
    if tree.operator == "/":
        sign, above = ("- ", left.operand) if isinstance(left, Negative) else ("", left)
        return rf"{sign}\frac{{{expression_latex(above)}}}{{{expression_latex(right)}}}"
    if tree.operator == "*":
        times = r" \cdot " if _begins_with_number(right) else " "
        return f"{_enclosed(left, PRODUCT)}{times}{_enclosed(right, PRODUCT)}"
    needed = PRODUCT if tree.operator == "-" or isinstance(right, Negative) else SUM
    return f"{expression_latex(left)} {tree.operator} {_enclosed(right, needed)}"


_WRITERS: dict[type[Expression], Callable[[Any], str]] = {
    Number: _number,
    Name: lambda tree: symbol_latex(tree.name),
    Pi: lambda _: r"\pi",
    Negative: lambda tree: f"- {_enclosed(tree.operand, PRODUCT)}",
    Binary: _binary,
    Power: lambda tree: f"{_enclosed(tree.base, ATOM)}^{{{tree.exponent}}}",
    SquareRoot: lambda tree: rf"\sqrt{{{expression_latex(tree.operand)}}}",
}


def _begins_with_number(tree: Expression) -> bool:
    return isinstance(tree, Number) or (isinstance(tree, Binary) and _begins_with_number(tree.left))


def _strength(tree: Expression) -> int:
    if isinstance(tree, Binary):
        return {"+": SUM, "-": SUM, "*": PRODUCT, "/": QUOTIENT}[tree.operator]
    return SUM if isinstance(tree, Negative) else QUOTIENT if isinstance(tree, Power) else ATOM


def _enclosed(tree: Expression, needed: int) -> str:
    text = expression_latex(tree)
    return text if _strength(tree) >= needed else rf"\left({text}\right)"
