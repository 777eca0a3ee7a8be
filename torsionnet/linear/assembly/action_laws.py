"""Transfer functions of actions (controllers, fluid couplings), whose torques follow a motion, in exact numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.expressions import exact
from torsionnet.model.kinematics import Kinematics, exact_row

Polynomial: TypeAlias = tuple[Fraction, ...]
"""Coefficients of a polynomial in s in ascending powers, the last of them not zero; an empty tuple for zero."""


@dataclass(frozen=True)
class ActionLaw:
    """Law of an action, whose torque N(s)/D(s) e^(-s delay) gamma_sensed in N m drives one row by another's motion.

    Attributes
    ----------
    owner : str
        Its element.
    nodes : mapping
        The row it drives, over nodes.
    row, sensed : mapping
        The row it drives and the one it follows, over coordinates and imposed angles.
    numerator, denominator : tuple of Fraction
        N(s) in N m/rad and D(s), ascending, without a common factor s; the last coefficient of D is 1.
    delay : Fraction
        s.
    """

    owner: str
    nodes: Mapping[str, Fraction]
    row: Mapping[str, Fraction]
    sensed: Mapping[str, Fraction]
    numerator: Polynomial
    denominator: Polynomial
    delay: Fraction

    @property
    def acts_at_rest(self) -> bool:
        """Whether a constant angle of the sensed row makes a torque."""
        return self.numerator[0] != 0 or self.denominator[0] == 0

    @property
    def rows(self) -> tuple[str, Mapping[str, Fraction], Mapping[str, Fraction], Mapping[str, Fraction]]:
        """Element of the action, and its rows over nodes: all it touches, the driven and the sensed ones."""
        return self.owner, self.nodes, self.row, self.sensed

    @cached_property
    def _floats(self) -> tuple[list[float], list[float], float]:
        numbers = ([float(value) for value in part] for part in (self.numerator, self.denominator))
        return (*numbers, float(self.delay))  # type: ignore[return-value]

    def kappa(self, s: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Transfer function torque / sensed angle in N m/rad at the Laplace variable s in rad/s, shape of s."""
        numerator, denominator, delay = self._floats
        with np.errstate(all="ignore"):
            value = polynomial(numerator, s) / polynomial(denominator, s)
            return np.asarray(value * np.exp(-delay * s) if delay else value, dtype=np.complex128)


def polynomial(coefficients: Sequence[Any], s: Any) -> Any:
    """Value at s of a polynomial with the given coefficients in ascending powers, by Horner's rule."""
    value = 0 * s
    for coefficient in reversed(coefficients):
        value = value * s + coefficient
    return value


def action_laws(kinematics: Kinematics) -> tuple[ActionLaw, ...]:
    """Laws of all actions of a drivetrain whose gain and sensed motion are not zero, in the order of the elements."""
    laws = []
    for owner, action in kinematics.actions:
        sensed = exact_row(kinematics.reduction.reduced(action.sensed))
        numerator, denominator = lowest_terms(action.numerator, action.denominator)
        if numerator and sensed:
            nodes = exact_row(action.row)
            row, delay = exact_row(kinematics.reduction.reduced(action.row)), exact(action.delay)
            laws.append(ActionLaw(owner, nodes, row, sensed, numerator, denominator, delay))
    return tuple(laws)


def lowest_terms(numerator: Sequence[Any], denominator: Sequence[Any]) -> tuple[Polynomial, Polynomial]:
    """Exact coefficients of numerator and denominator without a common factor s, the denominator with leading 1.

    A common factor s is an integral of a rate, which is the angle: no state of its own.

    >>> lowest_terms((0, 2, 4, 0), (0, 2))
    ((Fraction(1, 1), Fraction(2, 1)), (Fraction(1, 1),))
    """
    above, below = ([exact(value) for value in part] for part in (numerator, denominator))
    for part in (above, below):
        while part and part[-1] == 0:
            part.pop()
    while above and below and above[0] == 0 and below[0] == 0:
        del above[0], below[0]
    lead = below[-1] if below else Fraction(1)
    return tuple(value / lead for value in above), tuple(value / lead for value in below)


def divide_polynomials(numerator: Polynomial, denominator: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Quotient and remainder of a polynomial divided by one with leading coefficient 1, as exact coefficients.

    >>> divide_polynomials((Fraction(1), Fraction(0), Fraction(2)), (Fraction(3), Fraction(1)))
    ((Fraction(-6, 1), Fraction(2, 1)), (Fraction(19, 1),))
    """
    rest, degree = list(numerator), len(denominator) - 1
    quotient = [Fraction(0)] * max(len(rest) - degree, 0)
    for power in reversed(range(len(quotient))):
        factor = quotient[power] = rest[power + degree]
        for place, value in enumerate(denominator):
            rest[power + place] -= factor * value
    return tuple(quotient), tuple(rest[:degree])
