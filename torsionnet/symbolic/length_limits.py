"""Limits for the length of formulas, beyond which a form of a transfer function is refused."""

from __future__ import annotations

from typing import TYPE_CHECKING

from torsionnet.base.errors import UsageError
from torsionnet.symbolic.algebra.algebras import InPowersOfS, Lengths, TermCounts
from torsionnet.symbolic.algebra.network import Program, ProgramNode
from torsionnet.symbolic.rational import MOST_TERMS_EXPANDED_WHOLE

if TYPE_CHECKING:
    from torsionnet.symbolic.symbolic_request import SymbolicFraction

MOST_WRITTEN = 20_000
"""Largest number of symbols and numbers, counted as often as they appear, in all coefficients together of a polynomial
form that is written out, as more fill pages and take minutes."""


def require_readable(function: SymbolicFraction) -> None:
    """Raise an error if the coefficients of a transfer function's polynomial form have too many symbols and numbers."""
    outputs = [function.numerator, function.denominator]
    if sum(function.steps.run(TermCounts(), outputs)) <= MOST_TERMS_EXPANDED_WHOLE:
        return
    polynomials = function.steps.run(InPowersOfS(Program().leaf), outputs)
    nodes = [value for polynomial in polynomials for value in polynomial.coefficients if isinstance(value, ProgramNode)]
    leaves = sum(part.leaves for part in nodes[0].program.run(Lengths(), nodes)) if nodes else 0
    if leaves > MOST_WRITTEN:
        raise UsageError(f'the coefficients would be written with {leaves:,} elements and numbers; ask for "program"')


def require_short(function: SymbolicFraction, most: int) -> None:
    """Raise an error if a transfer function without continued fraction has over ``most`` leaves in its nested form."""
    leaves = function.nested_leaves if function.continued_fraction is None else 0
    if leaves > most:
        raise UsageError(
            f"with its closed loops written out, this transfer function is a fraction of {leaves:,} elements and "
            'numbers; ask for "program"'
        )
