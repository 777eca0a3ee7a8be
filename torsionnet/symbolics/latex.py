"""LaTeX of the forms of a transfer function."""

from __future__ import annotations

from typing import TYPE_CHECKING

from torsionnet.errors import UsageError, did_you_mean
from torsionnet.symbolics.algebras import InPowersOfS, Lengths, Terms
from torsionnet.symbolics.program import Node, Program
from torsionnet.symbolics.rational import FEW
from torsionnet.symbolics.shown import latex, with_where
from torsionnet.symbolics.transfer_function import FORMS, MOST_LEAVES

if TYPE_CHECKING:
    from torsionnet.symbolics.transfer_function import TransferFunction

MOST_WRITTEN = 20_000
"""Elements and numbers in the coefficients of a formula; more fill pages, and take minutes."""


def to_latex(function: TransferFunction, form: str) -> str:
    """See :meth:`TransferFunction.to_latex`.

    Raises
    ------
    UsageError
        No such form, or one that would fill pages.
    """
    if form == "mechanical":
        _require_short(function)
        return latex(function.mechanical)
    if form in ("polynomial", "normalised"):
        _require_readable(function)
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


def _require_readable(function: TransferFunction) -> None:
    """Coefficients that are written nested grow without measure with the number of coordinates."""
    outputs = [function.numerator, function.denominator]
    if sum(function.steps.run(Terms(), outputs)) <= FEW:
        return
    polynomials = function.steps.run(InPowersOfS(Program().leaf), outputs)
    nodes = [value for polynomial in polynomials for value in polynomial.coefficients if isinstance(value, Node)]
    leaves = sum(part.leaves for part in nodes[0].program.run(Lengths(), nodes)) if nodes else 0
    if leaves > MOST_WRITTEN:
        msg = f'the coefficients would be written with {leaves:,} elements and numbers; ask for "program"'
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
