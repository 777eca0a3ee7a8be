"""Symbolic transfer function with numerator and denominator fully multiplied out."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import sympy

from torsionnet.base.errors import UsageError
from torsionnet.symbolic.algebra.algebras import TermCounts
from torsionnet.symbolic.algebra.sparse import Monomials, Sparse, monomials_for
from torsionnet.symbolic.formula_text import for_display

MOST_PRINTED = 100
"""Largest number of terms of an expanded transfer function printed as text, as of longer ones the number of terms says
more."""

if TYPE_CHECKING:
    from torsionnet.symbolic.symbolic_request import SymbolicFraction


@dataclass(frozen=True, repr=False)
class Expanded:
    """Numerator and denominator of a transfer function multiplied out, as maps from packed monomials to integers.

    Attributes
    ----------
    numerator, denominator : Sparse
    algebra : Monomials
    """

    numerator: Sparse
    denominator: Sparse
    algebra: Monomials

    @property
    def terms(self) -> int:
        """Number of terms in numerator and denominator of the expanded transfer function together."""
        return sum(sum(map(bool, part.terms.values())) for part in (self.numerator, self.denominator))

    def __repr__(self) -> str:
        return f"<Expanded: {self.terms} terms>"

    def __str__(self) -> str:
        return str(for_display(self.expression)) if self.terms <= MOST_PRINTED else repr(self)

    @cached_property
    def expression(self) -> Any:
        """Expanded transfer function, a quotient of sums, as a sympy expression."""
        depth = max(self.numerator.depth, self.denominator.depth)
        above, below = (
            self.algebra.expression(part.at_depth(depth), part.scale**depth)
            for part in (self.numerator, self.denominator)
        )
        return above / below

    def to_ring(self) -> tuple[Any, Any]:
        """Numerator and denominator, multiplied out, as elements of a sympy polynomial ring over the rationals."""
        ring = sympy.polys.rings.PolyRing(self.algebra.generators, sympy.QQ, sympy.polys.orderings.lex)
        return ring(self.algebra.as_dict(self.numerator)), ring(self.algebra.as_dict(self.denominator))


def predicted_terms(function: SymbolicFraction) -> int:
    """Upper bound of the number of terms of a transfer function's numerator and denominator, multiplied out."""
    return int(sum(function.steps.run(TermCounts(), [function.numerator, function.denominator])))


def expanded(function: SymbolicFraction, cap: int) -> Expanded:
    """Transfer function multiplied out, refused beyond ``cap`` terms; see :meth:`TransferFunction.expanded`."""
    predicted = predicted_terms(function)
    if predicted > cap:
        raise UsageError(
            f"fully expanded, this transfer function has up to {predicted:,} terms, more than {cap:,}; "
            "use .mechanical or .program, keep(...) fewer parameters, or raise cap="
        )
    program, outputs = function.steps, [function.numerator, function.denominator]
    algebra = monomials_for(program.payloads(outputs))
    above, below = program.run(algebra, outputs)
    return Expanded(above, below, algebra)
