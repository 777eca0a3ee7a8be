"""What one line of an order response is: which frequency, at which speed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from torsionnet.response.frequency_response import FloatArray

FINEST = 10**6
"""Largest denominator of an order."""


@dataclass(frozen=True)
class OrderLine:
    """One order of one excitation, or a frequency of it that does not follow the speed.

    Attributes
    ----------
    excitation : str
    order : float
        Vibrations per revolution of the shaft the excitation runs with.
    ratio : Fraction
        Revolutions of that shaft per revolution of the reference shaft, not negative.
    fixed : float
        Hz, added to what follows the speed: all of it where ``order`` is 0; with an order below 0 a slip.
    engine : str
        Where angles between engines are not known: the engine this is of, or the first of those fixed to it.
    """

    excitation: str
    order: float
    ratio: Fraction
    fixed: float = 0.0
    engine: str = ""

    @property
    def exact_order(self) -> Fraction:
        return near_fraction(float(self.order))

    @property
    def relative(self) -> Fraction:
        """Vibrations per revolution of the reference shaft."""
        return self.exact_order * self.ratio

    def frequency(self, speeds: FloatArray) -> FloatArray:
        """Hz at speeds of the reference shaft in rad/s; below 0 where a slip has changed its sign."""
        return np.asarray(float(self.relative) * speeds / (2 * math.pi) + self.fixed)

    def __str__(self) -> str:
        if not self.fixed:
            return f"{self.excitation} {self.order:g}"
        if not self.order:
            return f"{self.excitation} {self.fixed:g} Hz"
        return f"{self.excitation} {self.fixed:g} Hz {'-' if self.order < 0 else '+'} order {abs(self.order):g}"


def near_fraction(value: float) -> Fraction:
    """The fraction of at most ``FINEST`` parts that an order or a frequency stands for."""
    return Fraction(value).limit_denominator(FINEST)
