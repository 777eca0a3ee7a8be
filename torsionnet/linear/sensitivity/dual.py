"""Dual numbers, which carry derivatives, so that elements evaluate the derivatives of their own laws."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from torsionnet.base.expressions import Algebra
from torsionnet.linear.assembly.rows import FloatArray


@dataclass(frozen=True, eq=False, slots=True)
class Dual:
    """Dual number, which is a value and its gradient (n_p,) to the varied parameters.

    It equals a plain number only if its gradient is zero.

    >>> x = Dual(3.0, np.array([1.0]))
    >>> y = 1 / x**2 - x
    >>> round(float(y.value), 6), (y.gradient * 27).round(9).tolist()
    (-2.888889, [-29.0])
    """

    value: Fraction | float
    gradient: FloatArray

    def __add__(self, other: Any) -> Dual:
        if isinstance(other, Dual):
            return Dual(self.value + other.value, self.gradient + other.gradient)
        return Dual(self.value + other, self.gradient)

    def __mul__(self, other: Any) -> Dual:
        if isinstance(other, Dual):
            moved = float(self.value) * other.gradient + float(other.value) * self.gradient
            return Dual(self.value * other.value, moved)
        return Dual(self.value * other, self.gradient * float(other))

    def __truediv__(self, other: Any) -> Dual:
        if isinstance(other, Dual):
            quotient = self.value / other.value
            return Dual(quotient, (self.gradient - float(quotient) * other.gradient) / float(other.value))
        return Dual(self.value / other, self.gradient / float(other))

    def __rtruediv__(self, other: Any) -> Dual:
        quotient = other / self.value
        return Dual(quotient, self.gradient * (-float(quotient) / float(self.value)))

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.gradient)

    def __sub__(self, other: Any) -> Dual:
        return self.__add__(-other)

    def __rsub__(self, other: Any) -> Dual:
        return (-self).__add__(other)

    def __pow__(self, power: Any) -> Dual:
        slope = float(power) * float(self.value) ** (float(power) - 1)
        return Dual(self.value**power, self.gradient * slope)

    __radd__ = __add__
    __rmul__ = __mul__

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Dual):
            return bool(self.value == other.value) and bool(np.array_equal(self.gradient, other.gradient))
        return bool(self.value == other) and not self.gradient.any()

    def __lt__(self, other: Any) -> bool:
        return bool(self.value < value_of(other))

    def __gt__(self, other: Any) -> bool:
        return bool(self.value > value_of(other))

    def __hash__(self) -> int:
        return hash(self.value)

    def __float__(self) -> float:
        return float(self.value)


def _root(number: Any) -> Any:
    root = math.sqrt(float(number))
    if not isinstance(number, Dual):
        return root
    # The root of a square that vanishes has a kink, not a pole: its derivative is the mean of both sides.
    at_kink = root == 0 and not number.gradient.any()
    return Dual(root, number.gradient if at_kink else number.gradient / (2 * root))


DUALS = Algebra(number=Fraction, sqrt=_root, pi=math.pi)
"""Arithmetic for expressions in which some parameters are a :class:`Dual`, so that results carry derivatives."""


def gradient_of(number: Any, count: int) -> FloatArray:
    """Derivatives (count,) that a dual number carries, zeros for any other number."""
    return number.gradient if isinstance(number, Dual) else np.zeros(count)


def value_of(number: Any) -> Any:
    """Value of a dual number without its derivatives, or any other number as it is."""
    return number.value if isinstance(number, Dual) else number
