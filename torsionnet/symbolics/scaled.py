"""Complex arrays with an exponent of their own: products over hundreds of coordinates neither overflow nor vanish."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.rows import ComplexArray

NOTHING = -(10**9)
"""Exponent of zero."""


class Scaled:
    """mantissa * 2^exponent, element by element; 0.5 <= |mantissa| < 1, or 0.

    Examples
    --------
    >>> huge = Scaled.of(np.array([1e300]))
    >>> (huge * huge / (huge * huge)).array().real.tolist()
    [1.0]
    """

    __slots__ = ("exponent", "mantissa")

    def __init__(self, mantissa: ComplexArray, exponent: NDArray[np.int64]) -> None:
        shift = np.frexp(np.abs(mantissa))[1].astype(np.int64)
        self.mantissa = mantissa * np.exp2(-shift)
        self.exponent = np.where(mantissa == 0, NOTHING, exponent + shift)

    @classmethod
    def of(cls, array: Any) -> Scaled:
        """An array or number of ordinary size."""
        mantissa = np.atleast_1d(np.asarray(array, dtype=complex))
        return cls(mantissa, np.zeros(mantissa.shape, dtype=np.int64))

    @classmethod
    def rational(cls, value: Fraction) -> Scaled:
        """A constant of any size."""
        shift = value.numerator.bit_length() - value.denominator.bit_length()
        mantissa = float(value / Fraction(2) ** shift)
        return cls(np.array([mantissa + 0j]), np.array([shift], dtype=np.int64))

    def __add__(self, other: Scaled) -> Scaled:
        top = np.maximum(self.exponent, other.exponent)
        left = self.mantissa * np.exp2(np.maximum(self.exponent - top, -2000))
        right = other.mantissa * np.exp2(np.maximum(other.exponent - top, -2000))
        return Scaled(left + right, top)

    def __mul__(self, other: Scaled) -> Scaled:
        return Scaled(self.mantissa * other.mantissa, self.exponent + other.exponent)

    def __truediv__(self, other: Scaled) -> Scaled:
        with np.errstate(divide="ignore", invalid="ignore"):
            quotient = np.where(other.mantissa == 0, np.inf + 0j, self.mantissa / other.mantissa)
        exponent = self.exponent - other.exponent
        result = Scaled.__new__(Scaled)
        result.mantissa, result.exponent = quotient, np.where(other.mantissa == 0, 0, exponent)
        return result

    def __pow__(self, power: float) -> Scaled:
        return Scaled.of(self.array() ** power)

    def array(self) -> ComplexArray:
        """The numbers themselves."""
        return np.asarray(self.mantissa * np.exp2(np.clip(self.exponent, -2000, 2000).astype(float)))
