"""Of which sizes numbers may be, and roots that stay exact where they can."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

SMALLEST, LARGEST = 1e-40, 1e40
"""Sizes in SI: beyond these the square of a value, or its product with another one, leaves the range of numbers."""


def is_beyond_range(value: Any) -> bool:
    """Whether a value is of no size that anything in a drivetrain has; 0 is one.

    >>> is_beyond_range(1e300), is_beyond_range(0.0)
    (True, False)
    """
    return bool(value) and not SMALLEST < abs(value) < LARGEST


MOST_BITS = 4096
"""Of an exact fraction: with more, powers of powers would double them without end, and a float says all there is."""


def limited(value: Any) -> Any:
    """A value as it is, but a float for an exact fraction of too many digits."""
    if isinstance(value, Fraction) and value.numerator.bit_length() + value.denominator.bit_length() > MOST_BITS:
        return float(value)
    return value


def exact_sqrt(value: Fraction | float) -> Fraction | float:
    """The root, as a fraction if it is one."""
    if value < 0:
        raise ArithmeticError(f"there is no root of {float(value):.4g}")
    if not isinstance(value, Fraction | int):
        return math.sqrt(value)
    root = Fraction(math.isqrt(value.numerator), math.isqrt(value.denominator))
    return root if root * root == value else math.sqrt(value)
