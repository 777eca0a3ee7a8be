"""LaTeX of a model file's expressions, in the order in which they were written."""

from __future__ import annotations

from fractions import Fraction

from torsionnet.base.expressions import Compound, Expression, Name, Number
from torsionnet.symbolic.symbol_names import symbol_latex

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
