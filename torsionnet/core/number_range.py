"""Range of sizes that numbers may have, and roots that stay exact where they can."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

SMALLEST_SIZE, LARGEST_SIZE = 1e-40, 1e40
"""Smallest and largest size of a value in SI units, as its square must stay in the range of floats."""


def is_beyond_range(value: Any) -> bool:
    """Whether a value is too small or too large for anything in a drivetrain; 0 is allowed.

    >>> is_beyond_range(1e300), is_beyond_range(0.0)
    (True, False)
    """
    return bool(value) and not SMALLEST_SIZE < abs(value) < LARGEST_SIZE


MOST_BITS = 4096
"""Largest number of bits of an exact fraction, as powers of powers would double them without end; a float has all the
digits that matter."""


def float_if_long(value: Any) -> Any:
    """Number unchanged, but as a float where it is an exact fraction of too many digits."""
    if isinstance(value, Fraction) and value.numerator.bit_length() + value.denominator.bit_length() > MOST_BITS:
        return float(value)
    return value


def exact_sqrt(value: Fraction | float) -> Fraction | float:
    """Square root of a number, as a fraction where the root is one."""
    if value < 0:
        raise ArithmeticError(f"the square root of {float(value):.4g} is not real; check the signs of the values")
    if not isinstance(value, Fraction | int):
        return math.sqrt(value)
    root = Fraction(math.isqrt(value.numerator), math.isqrt(value.denominator))
    return root if root * root == value else math.sqrt(value)
