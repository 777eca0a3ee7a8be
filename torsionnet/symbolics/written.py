"""The continued fraction as a sympy expression."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import sympy

from torsionnet.symbolics.algebras import S, in_s
from torsionnet.symbolics.mechanical import NoContinuedFractionError, response
from torsionnet.symbolics.network import Stiffness
from torsionnet.symbolics.question import Asked


@dataclass(frozen=True)
class Changing:
    """A question whose expressions get values in the end."""

    asked: Asked
    change: Callable[[Any], Any]


def with_values(asked: Any, change: Callable[[Any], Any]) -> Changing:
    """The question with another change of its expressions on top."""
    if isinstance(asked, Changing):
        return Changing(asked.asked, lambda expression: change(asked.change(expression)))
    return Changing(asked, change)


def continued(asked: Any, leaf: Callable[[Any], Any]) -> Any:
    """The continued fraction with elements from ``leaf``, or None if there is none."""
    change: Callable[[Any], Any] = lambda expression: expression  # noqa: E731
    if isinstance(asked, Changing):
        asked, change = asked.asked, asked.change

    def element(payload: Any) -> Any:
        if payload == "s":
            return leaf(Stiffness(damping=sympy.Integer(1)))
        if isinstance(payload, Stiffness):
            return leaf(Stiffness(*(change(part) for part in payload.parts)))
        return leaf(change(sympy.Integer(payload) if isinstance(payload, int) else payload))

    try:
        alone = asked.measured is None
        above, receptance = response(asked.mechanism, asked.output, asked.node, element, shift=alone)
        if asked.measured is None:
            return above * receptance * element(asked.sign)
        return above / response(asked.mechanism, asked.measured, asked.node, element)[0]
    except NoContinuedFractionError:
        return None


def continued_expression(asked: Any) -> Any:
    """The continued fraction, or None if there is none."""
    return continued(asked, _expression)


def _expression(payload: Any) -> Any:
    if isinstance(payload, Stiffness):
        return in_s(payload.parts)
    return sympy.Rational(payload.numerator, payload.denominator) if isinstance(payload, Fraction) else payload


__all__ = ["Changing", "S", "continued", "continued_expression", "with_values"]
