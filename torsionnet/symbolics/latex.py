"""LaTeX of the forms of a transfer function."""

from __future__ import annotations

from typing import TYPE_CHECKING

from torsionnet.errors import UsageError, did_you_mean
from torsionnet.symbolics.shown import latex, with_where
from torsionnet.symbolics.transfer_function import FORMS, MOST_LEAVES

if TYPE_CHECKING:
    from torsionnet.symbolics.transfer_function import TransferFunction


def to_latex(function: TransferFunction, form: str) -> str:
    """See :meth:`TransferFunction.to_latex`.

    Raises
    ------
    UsageError
        No such form, or the nested one would fill pages.
    """
    if form == "mechanical":
        _require_short(function)
        return latex(function.mechanical)
    if form == "polynomial":
        return function.polynomial.to_latex()
    if form == "normalised":
        return function.normalised.to_latex()
    if form == "program":
        table, result = function.program.where()
        return with_where(latex(result), table)
    if form == "expanded":
        return latex(function.expanded().expression)
    msg = f'"{form}" is no form{did_you_mean(form, FORMS)}; choose {", ".join(FORMS)}'
    raise UsageError(msg)


def _require_short(function: TransferFunction) -> None:
    """Nested expressions repeat themselves; a continued fraction does not."""
    leaves = function.nested_leaves if function.continued is None else 0
    if leaves > MOST_LEAVES:
        msg = (
            f"with its closed loops written out, this transfer function is a fraction of {leaves:,} elements and "
            'numbers; ask for "program"'
        )
        raise UsageError(msg)
