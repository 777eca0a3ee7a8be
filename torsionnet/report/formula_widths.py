"""Width of formulas, counted in letters, so that none runs off the page."""

from __future__ import annotations

from typing import Any

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
