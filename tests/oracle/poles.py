"""Poles as roots of det D(s): how many there are, by exact ranks, and how far given ones are from them.

For p of degree N and any z, a disc of radius N |p/p'| around z holds a root. N discs without common points therefore
hold one each: given poles are verified all together, without finding any. Where that fails the polynomial itself is
made from values on a circle, and its roots enclosed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import pi

from flint import acb, acb_poly, arb

from oracle.elimination import SingularError, determinant
from oracle.exact import ball, precision
from oracle.solution import Mechanics

BITS = 800
STEP = 240
"""Derivatives are differences over 2^-STEP of s."""
ROOT_BITS, ENOUGH, NUDGE = 80, 60, 60
CIRCLE = 128
"""Points on a circle that is followed."""


@dataclass(frozen=True)
class Count:
    """Of poles: rigid-body modes (None: not known), zeros of det D(s) at s = 0 and roots apart from these."""

    rigid: int | None
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
        for bits in (BITS, 2 * BITS, 4 * BITS):
            with precision(bits):
                s = acb(ball(z.real), ball(z.imag))
                for nudge in (0, arb(2) ** -NUDGE):  # z may be a root in every digit
                    try:
                        step = self.step(s * (1 + nudge), None if omega is None else ball(omega))
                    except (SingularError, ZeroDivisionError):
                        continue
                    if step.rel_accuracy_bits() > ENOUGH:
                        return complex(step)
        return complex("nan")

    def step(self, s: acb, omega: arb | None = None) -> acb:
        """Newton's step p/p' at the current precision."""
        apart = s * arb(2) ** -STEP
        growth = self.value(s + apart, omega) / self.value(s, omega)
        return 1 / ((growth - 1) / apart - self.count.zeros / s)

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
        """All roots apart from zero, enclosed; slow, for what failed."""
        number = self.count.others
        for bits in (precise(number), 2 * precise(number)):
            with precision(bits):
                try:
                    found = coefficients(lambda s: self.value(s, arb(0)) / s**self.count.zeros, number)
                    return [acb(root) for root in acb_poly(found).roots(tol=arb(2) ** -ROOT_BITS)]
                except (SingularError, ValueError, ZeroDivisionError):
                    continue
        raise SingularError


def precise(degree: int) -> int:
    """Bits for the coefficients of a polynomial."""
    return 100 * degree + 1000


def coefficients(value: Callable[[acb], acb], degree: int) -> list[acb]:
    """Of a polynomial of at most this degree, from its values on the unit circle."""
    points = [(acb(2 * k) / (degree + 1)).exp_pi_i() for k in range(degree + 1)]
    return acb.dft([value(s) for s in points])
