"""Width of formulas, counted in letters, so that none runs off the page."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from torsionnet.base.expressions import Compound, Expression, Name, Number
from torsionnet.symbolic.symbol_names import symbol_latex

WIDEST_FORMULA, WIDEST_MATRIX = 72, 60
"""Largest width in letters of a formula, and of the rows of a symbolic matrix, that fits a page."""


def formula_letters(expression: Any) -> int:
    """Width of a formula, as the number of letters that stand side by side.

    A fraction is as wide as the wider of its halves.

    >>> import sympy
    >>> a, b, c = sympy.symbols("a b c")
    >>> formula_letters(a + b), formula_letters((a + b) / c), formula_letters(1 / (a + 1 / (b + c)))
    (5, 5, 9)
    """
    if expression.is_Add:
        return sum(formula_letters(term) + 3 for term in expression.args) - 3
    if expression.is_Mul:
        above, below = _halves(expression)
        return max(_product(above), _product(below))
    if expression.is_Pow:
        if expression.exp.is_negative:
            return formula_letters(1 / expression)
        return formula_letters(expression.base) + (2 if expression.base.is_Add else 0) + 1
    text = str(expression)
    return len(text.replace("_", "")) if expression.is_Symbol else len(text)


def _halves(product: Any) -> tuple[list[Any], list[Any]]:
    above: list[Any] = []
    below: list[Any] = []
    for factor in product.args:
        if factor.is_Pow and factor.exp.is_negative:
            below.append(1 / factor)
        else:
            above.append(factor)
    return above, below


def _product(factors: list[Any]) -> int:
    return sum(formula_letters(factor) + (2 if factor.is_Add and len(factors) > 1 else 0) for factor in factors)


def matrix_letters(matrix: Any) -> int:
    """Width of a symbolic matrix, as the number of letters from left to right."""
    rows = [[formula_letters(cell) for cell in row] for row in matrix.tolist()]
    return sum(max(column) + 2 for column in zip(*rows, strict=True)) if rows else 0


# LaTeX of a model file's expressions, in the order in which they were written.

SUM, PRODUCT, QUOTIENT, ATOM = 1, 2, 3, 4
PRECEDENCE = {"+": SUM, "-": SUM, "negative": SUM, "*": PRODUCT, "/": QUOTIENT, "**": QUOTIENT}
"""Precedence of an operation in LaTeX, by the sign of the operation; operations not listed bind like names and
numbers."""


def expression_latex(tree: Expression) -> str:
    r"""LaTeX of an expression of parameters, in the order in which it was written.

    >>> from torsionnet.base.expression_reading import scalar
    >>> expression_latex(scalar("I_1 - I_MT")), expression_latex(scalar("pi*G*d**4/(32*L)"))
    ('I_{1} - I_{\\mathrm{MT}}', '\\frac{\\pi G d^{4}}{32 L}')
    >>> expression_latex(scalar("-r_p/(2*(a + b)*3)"))
    '- \\frac{r_{p}}{2 \\left(a + b\\right) \\cdot 3}'
    """
    match tree:
        case Number(value=value):
            return str(value) if isinstance(value, Fraction) and value.denominator == 1 else f"{float(value):.6g}"
        case Name(name=name):
            return symbol_latex(name)
        case Compound("pi"):
            return r"\pi"
        case Compound("negative", (operand,)):
            return f"- {_enclosed(operand, PRODUCT)}"
        case Compound("sqrt", (operand,)):
            return rf"\sqrt{{{expression_latex(operand)}}}"
        case Compound("**", (base, Number(value=exponent))):
            return f"{_enclosed(base, ATOM)}^{{{exponent}}}"
        case Compound("/", (Compound("negative", (above,)), below)):
            return rf"- \frac{{{expression_latex(above)}}}{{{expression_latex(below)}}}"
        case Compound("/", (above, below)):
            return rf"\frac{{{expression_latex(above)}}}{{{expression_latex(below)}}}"
        case Compound("*", (left, right)):
            times = r" \cdot " if _begins_with_number(right) else " "
            return f"{_enclosed(left, PRODUCT)}{times}{_enclosed(right, PRODUCT)}"
        case Compound(sign, (left, right)):
            needed = PRODUCT if sign == "-" or _sign(right) == "negative" else SUM
            return f"{expression_latex(left)} {sign} {_enclosed(right, needed)}"
    raise TypeError(tree)


def _sign(tree: Expression) -> str:
    return tree.sign if isinstance(tree, Compound) else ""


def _begins_with_number(tree: Expression) -> bool:
    if isinstance(tree, Compound) and tree.sign in "+-*/":
        return _begins_with_number(tree.operands[0])
    return isinstance(tree, Number)


def _enclosed(tree: Expression, needed: int) -> str:
    text = expression_latex(tree)
    return text if PRECEDENCE.get(_sign(tree), ATOM) >= needed else rf"\left({text}\right)"
