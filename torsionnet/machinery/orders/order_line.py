"""Order line, one order or fixed frequency of an excitation, and its frequency at each speed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from torsionnet.linear.frequency_response import FloatArray

LARGEST_DENOMINATOR = 10**6
"""Largest denominator of an order as a fraction; finer ones are taken for rounding."""


@dataclass(frozen=True)
class OrderLine:
    """Line of an order response, one order of one excitation or one of its fixed frequencies (Hz).

    Attributes
    ----------
    excitation : str
    order : float
        Vibrations per revolution of the shaft of the excitation.
    ratio : Fraction
        Revolutions of that shaft per revolution of the reference shaft, not negative.
    fixed : float
        Frequency in Hz added to that of the order: the whole frequency if ``order`` is 0; a slip if it is negative.
    engine : str
        Engine of the line, or the first of those fixed to it, if angles between engines are unknown.
    """

    excitation: str
    order: float
    ratio: Fraction
    fixed: float = 0.0
    engine: str = ""

    @cached_property
    def exact_order(self) -> Fraction:
        """Order of an order line, vibrations per revolution of the shaft of its excitation, as a fraction."""
        return near_fraction(float(self.order))

    @cached_property
    def relative(self) -> Fraction:
        """Order of an order line, vibrations per revolution of the reference shaft, as a fraction."""
        return self.exact_order * self.ratio

    def frequency(self, speeds: FloatArray) -> FloatArray:
        """Frequency of an order line in Hz at speeds in rad/s of the reference shaft, in the shape of the speeds.

        Negative where a slip has changed its sign.
        """
        return np.asarray(float(self.relative) * speeds / (2 * math.pi) + self.fixed)

    def __str__(self) -> str:
        return f"{self.excitation} {self.words}"

    @property
    def words(self) -> str:
        """Order of an order line, its fixed frequency in Hz, or both, without its excitation."""
        if not self.fixed:
            return f"{self.order:g}"
        if not self.order:
            return f"{self.fixed:g} Hz"
        return f"{self.fixed:g} Hz {'-' if self.order < 0 else '+'} order {abs(self.order):g}"


def near_fraction(value: float) -> Fraction:
    """Fraction nearest to an order or a frequency, with a denominator of at most ``LARGEST_DENOMINATOR``."""
    return Fraction(value).limit_denominator(LARGEST_DENOMINATOR)
