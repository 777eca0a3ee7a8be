"""Continued fraction of a transfer function on a tree, as a sympy expression or in another algebra."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import sympy

from torsionnet.symbolic.algebra.algebras import in_s
from torsionnet.symbolic.algebra.network import Stiffness
from torsionnet.symbolic.symbolic_request import SymbolicRequest
from torsionnet.symbolic.tree_fraction import NoContinuedFractionError, response


def continued_fraction(asked: SymbolicRequest, leaf: Callable[[Any], Any]) -> Any:
    """Continued fraction of a transfer function in the algebra of ``leaf``, None if the drivetrain is no tree."""

    def element(payload: Any) -> Any:
        if isinstance(payload, str):  # s itself
            return leaf(Stiffness(damping=sympy.Integer(1)))
        if isinstance(payload, Stiffness):
            return leaf(Stiffness(*(asked.change(part) for part in payload.parts)))
        return leaf(asked.change(sympy.Integer(payload) if isinstance(payload, int) else payload))

    if asked.mechanism.has_actions:
        return None
    try:
        alone = asked.measured is None
        above, receptance = response(asked.mechanism, asked.output, asked.load, element, shift=alone)
        if asked.measured is None:
            return above * receptance * element(asked.sign)
        return above / response(asked.mechanism, asked.measured, asked.load, element)[0]
    except NoContinuedFractionError:
        return None


def continued_fraction_expression(asked: SymbolicRequest) -> Any:
    """Continued fraction of a transfer function as a sympy expression, or None if the drivetrain is no tree."""
    return continued_fraction(asked, _expression)


def _expression(payload: Any) -> Any:
    if isinstance(payload, Stiffness):
        return in_s(payload.parts)
    return sympy.Rational(payload.numerator, payload.denominator) if isinstance(payload, Fraction) else payload
