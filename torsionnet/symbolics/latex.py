"""LaTeX of the forms of a transfer function."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy

from torsionnet.errors import UsageError, did_you_mean
from torsionnet.symbolics.transfer_function import FORMS

if TYPE_CHECKING:
    from torsionnet.symbolics.transfer_function import TransferFunction


def to_latex(function: TransferFunction, form: str) -> str:
    """See :meth:`TransferFunction.to_latex`.

    Raises
    ------
    UsageError
        No such form.
    """
    if form == "mechanical":
        return written(function.mechanical)
    if form == "polynomial":
        return with_where(function.polynomial.named, function.polynomial.where)
    if form == "normalised":
        return written(function.normalised.expression)
    if form == "program":
        table, result = function.program.where()
        return with_where(result, table)
    if form == "expanded":
        return written(function.expanded().expression)
    msg = f'"{form}" is no form{did_you_mean(form, FORMS)}; choose {", ".join(FORMS)}'
    raise UsageError(msg)


def written(expression: Any) -> str:
    """LaTeX of an expression."""
    return str(sympy.latex(expression))


def with_where(result: Any, table: dict[Any, Any]) -> str:
    """The result, and below it what its names stand for, as an aligned block."""
    lines = [rf"& {written(result)}", *(rf"& {written(name)} = {written(value)}" for name, value in table.items())]
    return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"
