"""Text and LaTeX of expressions for display, with powers of s in order and long numbers rounded."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import sympy

from torsionnet.symbolic.symbol_names import symbol_names

LONG_RATIONAL_DIGITS = 12
"""Number of digits of a rational number above which it is displayed as a decimal, being hard to read."""
DISPLAY_DIGITS = 8
"""Number of significant digits of a displayed decimal, more than parameters are known to."""


def for_display(expression: Any) -> Any:
    """Sympy expression for display, long rationals as decimals, even powers of sums without a leading minus."""
    long = {
        number: sympy.Float(number, DISPLAY_DIGITS)
        for number in expression.atoms(sympy.Rational)
        if len(str(number.p)) + len(str(number.q)) > LONG_RATIONAL_DIGITS
    }
    sign_changed = {
        power: (-power.base) ** power.exp for power in expression.atoms(sympy.Pow) if _begins_with_minus(power)
    }
    return expression.xreplace({**long, **sign_changed}) if long or sign_changed else expression


def _begins_with_minus(power: Any) -> bool:
    even = power.exp.is_Integer and power.exp % 2 == 0
    return bool(even and power.base.is_Add and power.base.could_extract_minus_sign())


def polynomial_text(names: Iterable[Any]) -> str:
    """Text ``b_0 + b_1*s + ...`` of a polynomial in ascending powers of s from the names of its coefficients."""
    terms = [_term(name, power) for power, name in enumerate(names) if name != 0]
    return " + ".join(terms) or "0"


def _term(name: Any, power: int) -> str:
    return str(name) if not power else f"{name}*s" if power == 1 else f"{name}*s**{power}"


def polynomial_latex(names: Iterable[Any]) -> str:
    """LaTeX of a polynomial in ascending powers of s from the names of its coefficients."""
    terms = [
        sympy.latex(name) + ("" if not power else " s" if power == 1 else f" s^{{{power}}}")
        for power, name in enumerate(names)
        if name != 0
    ]
    return " + ".join(terms) or "0"


def where_text(result: Any, table: Mapping[Any, Any]) -> str:
    """Text of a result, followed by the definition of each name in it on a line of its own."""
    return "\n".join([str(result), *(f"  {name} = {for_display(value)}" for name, value in table.items())])


def latex(expression: Any) -> str:
    """LaTeX of a sympy expression, with indices of several letters upright."""
    names = symbol_names(expression.free_symbols)
    return str(sympy.latex(for_display(expression), symbol_names=names, imaginary_unit="rj"))


def with_where(result: str, table: Mapping[Any, Any]) -> str:
    """LaTeX of a result, followed by the definition of each name in it, as an aligned block."""
    lines = [f"& {result}", *(f"& {latex(name)} = {latex(value)}" for name, value in table.items())]
    return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"
