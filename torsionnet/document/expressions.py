"""Expressions of a model file in LaTeX, in the order they were written in."""

from __future__ import annotations

from fractions import Fraction

from torsionnet.expressions import Binary, Expression, Name, Negative, Number, Pi, Power, SquareRoot
from torsionnet.symbolics.naming import symbol_latex


def expression_latex(tree: Expression) -> str:
    r"""LaTeX of an expression.

    >>> from torsionnet.expressions import scalar
    >>> expression_latex(scalar("I_1 - I_MT")), expression_latex(scalar("pi*G*d**4/(32*L)"))
    ('I_{1} - I_{\\mathrm{MT}}', '\\frac{\\pi G d^{4}}{32 L}')
    """
    match tree:
        case Name(name):
            return symbol_latex(name)
        case Pi():
            return r"\pi"
        case Negative(operand):
            return f"- {_enclosed(operand, 2)}"
        case SquareRoot(operand):
            return rf"\sqrt{{{expression_latex(operand)}}}"
        case Power(base, exponent):
            return f"{_enclosed(base, 3)}^{{{exponent}}}"
        case Binary("/", left, right):
            return rf"\frac{{{expression_latex(left)}}}{{{expression_latex(right)}}}"
        case Binary("*", left, right):
            times = r" \cdot " if _ends_or_begins_with_number(right) else " "
            return f"{_enclosed(left, 2)}{times}{_enclosed(right, 2)}"
        case Binary(sign, left, right):
            return f"{expression_latex(left)} {sign} {_enclosed(right, 2 if sign == '-' else 1)}"
        case Number():
            return _number(tree)
    return rf"\text{{{tree}}}"


def _number(tree: Number) -> str:
    value = tree.value
    if isinstance(value, Fraction) and value.denominator == 1:
        return str(value.numerator)
    return f"{float(value):.6g}"


def _ends_or_begins_with_number(tree: Expression) -> bool:
    return isinstance(tree, Number) or (isinstance(tree, Binary) and _ends_or_begins_with_number(tree.left))


def _strength(tree: Expression) -> int:
    if isinstance(tree, Binary):
        return {"+": 1, "-": 1, "*": 2, "/": 3}[tree.operator]
    return 1 if isinstance(tree, Negative) else 2 if isinstance(tree, Power) else 4


def _enclosed(tree: Expression, needed: int) -> str:
    text = expression_latex(tree)
    return text if _strength(tree) >= needed else rf"\left({text}\right)"
