"""Expressions as text to read: powers of s in order, long numbers rounded. Values stay as they are."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import sympy

from torsionnet.symbolic.symbol_names import symbol_names

LONG = 12
"""Digits of a rational number from which on it is shown as a decimal."""
DIGITS = 8


def shown(expression: Any) -> Any:
    """The expression with long rationals as decimals, and even powers of sums that begin with a minus turned round."""
    long = {
        number: sympy.Float(number, DIGITS)
        for number in expression.atoms(sympy.Rational)
        if len(str(number.p)) + len(str(number.q)) > LONG
    }
    turned = {power: (-power.base) ** power.exp for power in expression.atoms(sympy.Pow) if _begins_with_minus(power)}
    return expression.xreplace({**long, **turned}) if long or turned else expression


def _begins_with_minus(power: Any) -> bool:
    even = power.exp.is_Integer and power.exp % 2 == 0
    return bool(even and power.base.is_Add and power.base.could_extract_minus_sign())


def polynomial_text(names: Iterable[Any]) -> str:
    """``b_0 + b_1*s + ...`` in ascending powers; zeros are left out."""
    terms = [_term(name, power) for power, name in enumerate(names) if name != 0]
    return " + ".join(terms) or "0"


def _term(name: Any, power: int) -> str:
    return str(name) if not power else f"{name}*s" if power == 1 else f"{name}*s**{power}"


def polynomial_latex(names: Iterable[Any]) -> str:
    """The same in LaTeX."""
    terms = [
        sympy.latex(name) + ("" if not power else " s" if power == 1 else f" s^{{{power}}}")
        for power, name in enumerate(names)
        if name != 0
    ]
    return " + ".join(terms) or "0"


def where_text(result: Any, table: Mapping[Any, Any]) -> str:
    """The result, and on a line each what its names stand for."""
    return "\n".join([str(result), *(f"  {name} = {shown(value)}" for name, value in table.items())])


def latex(expression: Any) -> str:
    """LaTeX of an expression, with names as they are printed (indices of several letters upright)."""
    names = symbol_names(expression.free_symbols)
    return str(sympy.latex(shown(expression), symbol_names=names, imaginary_unit="rj"))


def with_where(result: str, table: Mapping[Any, Any]) -> str:
    """LaTeX of the result, and below it what its names stand for, as an aligned block."""
    lines = [f"& {result}", *(f"& {latex(name)} = {latex(value)}" for name, value in table.items())]
    return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"
