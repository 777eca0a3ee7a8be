"""Poles as roots of det D(s): how many there are, by exact ranks, and how far given ones are from them.

For p of degree N and any z, a disc of radius N |p/p'| around z holds a root. N discs without common points therefore
hold one each: given poles are verified all together, without finding any. Where that fails the polynomial itself is
made from values on a circle, and its roots enclosed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import pi

from flint import acb, acb_poly, arb

from oracle.elimination import SingularError, determinant
from oracle.exact import ball, precision
from oracle.solution import Mechanics

BITS, MOST_BITS = 800, 200_000
STEP = 240
"""Derivatives are differences over 2^-STEP of s."""
ROOT_BITS = 80
CIRCLE = 128
"""Points on a circle that is followed."""


@dataclass(frozen=True)
class Count:
    """Of poles: rigid-body modes, zeros of det D(s) at s = 0 and roots apart from these."""

    rigid: int
    zeros: int
    others: int


class Poles:
    """Poles of a model whose stiffness does not depend on frequency, or is frozen at ``omega``."""

    def __init__(self, mechanics: Mechanics) -> None:
        self.mechanics = mechanics

    @cached_property
    def count(self) -> Count:
        """From ranks: det D falls to s^zeros for small s, and grows with s^degree for large s."""
        m = self.mechanics
        rigid = m.freedom - m.rank_of("k")
        zeros = rigid + m.freedom - m.rank_of("kc")
        degree = m.rank_of("J") + m.rank_of("Jc")
        return Count(rigid, zeros, degree - zeros)

    def value(self, s: acb, omega: arb | None) -> acb:
        """Det D(s), up to a constant factor."""
        return determinant(self.mechanics.entries(s, omega), self.mechanics.order)

    def correction(self, z: complex, omega: float | None = None) -> complex:
        """Newton's step p/p' at z for the polynomial without its roots at zero; nan where p' says nothing."""
        bits = BITS
        while bits <= 8 * BITS:
            with precision(bits):
                try:
                    s = acb(ball(z.real), ball(z.imag))
                    frozen = None if omega is None else ball(omega)
                    step = s * arb(2) ** -STEP
                    here, there = self.value(s, frozen), self.value(s + step, frozen)
                    slope = (there / here - 1) / step - self.count.zeros / s
                    if (1 / slope).rel_accuracy_bits() > 60:
                        return complex(1 / slope)
                except (SingularError, ZeroDivisionError):
                    pass
            bits *= 2
        return complex("nan")

    def number_inside(self, centre: complex, radius: float, omega: float | None = None) -> int:
        """Roots in a circle, by the turns that det D makes along it."""
        turned, previous = 0.0, None
        with precision(BITS):
            for k in range(CIRCLE + 1):
                s = acb(ball(centre.real), ball(centre.imag)) + ball(radius) * (acb(2 * k) / CIRCLE).exp_pi_i()
                value = self.value(s, None if omega is None else ball(omega))
                if previous is not None:
                    turned += float((value / previous).arg().mid())
                previous = value
        return round(turned / (2 * pi))

    def roots(self) -> list[acb]:
        """All roots apart from zero, enclosed (for the report of what failed)."""
        number = self.count.others
        if number == 0:
            return []
        bits = 100 * number + 1000
        while bits <= MOST_BITS:
            with precision(bits):
                try:
                    return [acb(root) for root in self._polynomial().roots(tol=arb(2) ** -ROOT_BITS)]
                except (SingularError, ValueError, ZeroDivisionError):
                    bits *= 2
        raise SingularError

    def _polynomial(self) -> acb_poly:
        zeros, number = self.count.zeros, self.count.others
        points = number + 1
        unit = [(acb(2 * k) / points).exp_pi_i() for k in range(points)]
        values = [self.value(s, arb(0)) / s**zeros for s in unit]
        spectrum = acb.dft(values)
        return acb_poly([value / points for value in spectrum])
