"""Complex arrays with a separate exponent, so that products over hundreds of coordinates do not overflow.

Each number carries a bound of what rounding may have done to it: sums of large terms that cancel leave few digits.

Here as well: the algebra that evaluates programs with such arrays or other numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import sympy
from numpy.typing import NDArray

from torsionnet.base.program import ProgramAlgebra
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.symbolic.algebra.algebras import evaluate_expression
from torsionnet.symbolic.algebra.network import Stiffness

ZERO_EXPONENT = -(10**9)
"""Binary exponent of an exact zero, below that of any other number, so that sums keep the other number."""
OPERATION_ROUNDING = 2.0**-51
"""Relative rounding error assumed for one operation with complex doubles, 4 times their unit roundoff 2^-53."""


@dataclass(eq=False, slots=True)
class Scaled:
    """Complex array (mantissa +- error) * 2^exponent, element by element, with 0.5 <= |mantissa| < 1, or 0.

    Examples
    --------
    >>> huge = Scaled.of(np.array([1e300]))
    >>> (huge * huge / (huge * huge)).array().real.tolist()
    [1.0]
    >>> third = Scaled.rational(Fraction(1, 3))
    >>> close = third + Scaled.rational(Fraction(-333333, 1000000))
    >>> bool(1e-11 < close.relative_error()[0] < 1e-9)
    True
    """

    mantissa: NDArray[np.complex128]
    exponent: NDArray[np.int64]
    error: NDArray[np.float64]

    @classmethod
    def normalised(cls, mantissa: ComplexArray, exponent: NDArray[np.int64], error: FloatArray) -> Scaled:
        """Scaled array of numbers whose mantissas may have any size."""
        shift = np.frexp(np.abs(mantissa))[1].astype(np.int64)
        nothing, down = mantissa == 0, np.exp2(-shift)
        error = error * down
        # A zero of which something may be left by rounding keeps its exponent.
        return cls(mantissa * down, np.where(nothing & (error == 0), ZERO_EXPONENT, exponent + shift), error)

    @classmethod
    def of(cls, array: Any) -> Scaled:
        """Scaled array of a complex array or number of ordinary size, which is taken for exact."""
        mantissa = np.atleast_1d(np.asarray(array, dtype=complex))
        return cls.normalised(mantissa, np.zeros(mantissa.shape, dtype=np.int64), np.zeros(mantissa.shape))

    @classmethod
    def rational(cls, value: Fraction) -> Scaled:
        """Scaled array (1,) of a rational constant of any size, with its rounding error."""
        # The quotient is brought to about one first, as its parts may be too large for a double.
        shift = value.numerator.bit_length() - value.denominator.bit_length()
        exact = value / Fraction(2) ** shift
        mantissa = float(exact)
        error = 0.0 if mantissa == exact else OPERATION_ROUNDING * abs(mantissa)
        return cls.normalised(np.array([mantissa + 0j]), np.array([shift], dtype=np.int64), np.array([error]))

    def __add__(self, other: Scaled) -> Scaled:
        # Both at the larger exponent; what is 2^2000 times smaller is nothing beside it.
        top = np.maximum(self.exponent, other.exponent)
        first = np.exp2(np.maximum(self.exponent - top, -2000))
        second = np.exp2(np.maximum(other.exponent - top, -2000))
        total = self.mantissa * first + other.mantissa * second
        return Scaled.normalised(
            total, top, self.error * first + other.error * second + OPERATION_ROUNDING * np.abs(total)
        )

    def __mul__(self, other: Scaled) -> Scaled:
        first, second = np.abs(self.mantissa), np.abs(other.mantissa)
        # |a b - a' b'| <= |a| e_b + |b| e_a + e_a e_b, and rounding
        error = (
            first * other.error + second * self.error + self.error * other.error + OPERATION_ROUNDING * first * second
        )
        return Scaled.normalised(self.mantissa * other.mantissa, self.exponent + other.exponent, error)

    def __truediv__(self, other: Scaled) -> Scaled:
        with np.errstate(divide="ignore", invalid="ignore"):
            quotient = np.where(other.mantissa == 0, np.inf + 0j, self.mantissa / other.mantissa)
            size = np.abs(quotient)
            # (e_a + |a / b| e_b) / |b|, and rounding
            error = (self.error + size * other.error) / np.abs(other.mantissa) + OPERATION_ROUNDING * size
        exponent = self.exponent - other.exponent
        return Scaled(quotient, np.where(other.mantissa == 0, 0, exponent), error)  # infinite where it divides by zero

    def __pow__(self, power: float) -> Scaled:
        result = Scaled.of(self.array() ** power)
        result.error = (abs(power) * self.relative_error() + OPERATION_ROUNDING) * np.abs(result.mantissa)
        return result

    def array(self) -> ComplexArray:
        """Plain complex array of the scaled values, same shape, which may overflow."""
        return np.asarray(self.mantissa * np.exp2(np.clip(self.exponent, -2000, 2000).astype(float)))

    def relative_error(self) -> FloatArray:
        """Bound of each scaled value's relative rounding error, same shape, infinite or nan where no digit is sure."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self.error == 0, 0.0, self.error / np.abs(self.mantissa))


@dataclass(frozen=True)
class NumericValues(ProgramAlgebra):
    """Algebra that evaluates a program with numbers or arrays for its symbols; ``number`` converts Fractions."""

    values: Mapping[Any, Any]
    number: Callable[[Fraction], Any]
    s: Any = None

    def leaf(self, payload: Any) -> Any:
        if isinstance(payload, Fraction):
            return self.number(payload)
        if isinstance(payload, Stiffness):
            k, c, j = (self.leaf(part) for part in payload.parts)
            return k + self.s * (c + self.s * j)
        return evaluate_expression(payload, self._element)

    def _element(self, expression: Any) -> Any:
        if expression.is_Rational:
            return self.number(Fraction(expression.p, expression.q))
        if expression in self.values:
            return self.values[expression]
        if isinstance(expression, sympy.Pow):  # a root
            return evaluate_expression(expression.base, self._element) ** float(expression.exp)
        return complex(expression) if expression.has(sympy.I) else self.number(Fraction(repr(float(expression))))
