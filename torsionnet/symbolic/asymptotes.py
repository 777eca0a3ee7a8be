"""Static gain of a symbolic transfer function, and its leading terms at very low and very high frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy

from torsionnet.symbolic.algebra.algebras import InPowersOfS, S, surely_zero
from torsionnet.symbolic.algebra.delay import refuse_delays
from torsionnet.symbolic.algebra.network import Program, ProgramNode
from torsionnet.symbolic.numeric_evaluation import first_term, lowest_terms_in_s
from torsionnet.symbolic.rational import factor_if_short, to_expression

if TYPE_CHECKING:
    from torsionnet.symbolic.symbolic_request import SymbolicFraction


def static_gain(function: SymbolicFraction) -> Any:
    """Limit of a symbolic transfer function for s -> 0, a sympy expression, zero or infinity."""
    above, below = lowest_terms_in_s(function, Program().leaf, surely_zero)
    if above is None or above[0] > below[0]:
        return sympy.Integer(0)
    return sympy.oo if above[0] < below[0] else _quotient(above[1], below[1])


def low_frequency(function: SymbolicFraction) -> Any:
    """Leading term of a symbolic transfer function for s -> 0, gain * s^power, a sympy expression."""
    above, below = lowest_terms_in_s(function, Program().leaf, surely_zero)
    return sympy.Integer(0) if above is None else _quotient(above[1], below[1]) * S ** (above[0] - below[0])


def high_frequency(function: SymbolicFraction) -> Any:
    """Leading term of a symbolic transfer function for s -> oo, gain * s^power, a sympy expression."""
    refuse_delays(function.used_tables, "leading term at high frequency")
    algebra = InPowersOfS(Program().leaf)
    above, below = (
        (len(polynomial.coefficients), first_term(polynomial.coefficients[::-1], surely_zero))
        for polynomial in function.steps.run(algebra, [function.numerator, function.denominator])
    )
    if above[1] is None or below[1] is None:
        return sympy.Integer(0)
    power = (above[0] - above[1][0]) - (below[0] - below[1][0])
    return _quotient(above[1][1], below[1][1]) * S**power


def _quotient(above: Any, below: Any) -> Any:
    """Quotient of two program nodes as a sympy expression, without common factors."""
    program = (above if isinstance(above, ProgramNode) else below).program
    numerator, denominator = program.reduced(above, below)
    above, below = (to_expression(node) for node in (numerator, denominator))
    return factor_if_short(above / below)
