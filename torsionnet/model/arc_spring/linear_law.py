"""Stiffness k' + j k'' of arc springs at a swing, a mean torque and a speed, in whatever numbers an element has."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from torsionnet.base.expressions import Algebra, Expression

STEP = 1e-5
"""Step of a value over its size from which slopes to it are taken on both sides."""
SIGNED = 7
"""Place of the mean torque, which alone may be negative."""


def arc_stiffness(algebra: Algebra, *given: Any) -> tuple[Any, Any]:
    """Real part k' in N m/rad and loss factor k''/k' of the first harmonic of torque over twist.

    ``given`` are stiffness, arc angle, friction coefficient, mass, radius and speed of :class:`.ArcSprings`, then the
    amplitude in rad and the mean torque in N m.

    >>> from torsionnet.base.expressions import FLOAT
    >>> real, eta = arc_stiffness(FLOAT, 700, 2.6, 0.12, 0.9, 0.11, 314.15926536, 0.034906585, 276.2278)
    >>> round(real, 2), eta
    (2490.37, 0.5)
    """
    locked = _while_locked(algebra, *given)
    if locked is not None:
        return locked, 0.5
    real, imaginary = _tangent(given)
    return real, imaginary / real


def _while_locked(algebra: Algebra, *given: Any) -> Any:
    """Stiffness k' while friction locks coils at the depth of the springs, else None.

    From S^2 = 2 k e a, mean u = v^2 - v S + S^2 (1 - 2/pi) and k_s = S (2 v - S)/(2 a) follows
    k' = 8/(3 pi) k_s = 8/(3 pi) sqrt(2 k e (u - (3/4 - 2/pi) S^2)/a), with u = abs(T) + C/psi.
    """
    k, psi, mu, mass, radius, speed, amplitude, torque = given
    if not k > 0 or not psi > 0 or mu < 0 or not amplitude > 0:
        raise ArithmeticError("stiffness, arc_angle and swing of arc springs must be above 0, friction not below 0")
    base = mass * radius**2 * speed**2 / psi
    square = 2 * k * mu * psi * amplitude
    u = (-torque if torque < 0 else torque) + base - (Fraction(3, 4) - 2 / algebra.pi) * square
    if not square > 0 or not u > 0:
        return None
    swing, middle = algebra.sqrt(square), algebra.sqrt(u)
    # The depth is below 1 while E = S/v < 1 - exp(-e), and the flange stays on while u_b = (v - S)^2 > u_0.
    share = -math.expm1(-float(mu * psi))
    if not swing < share * (swing / 2 + middle) or not algebra.sqrt(base) < middle - swing / 2:
        return None
    return 8 * swing * middle / (3 * algebra.pi * amplitude)


def _tangent(given: Sequence[Any]) -> tuple[Any, Any]:
    """Stiffnesses k' and k'' of a loop worked out with plain numbers.

    Numbers with derivatives, and those that record what is done, get the tangent at their present values.
    """
    at = [float(entry) for entry in given]
    if not all(map(math.isfinite, at)):
        raise ArithmeticError("the values of arc springs must be finite")
    stiffness = _stiffness(at)
    parts: tuple[Any, Any] = (stiffness.real, stiffness.imag)
    for place, entry in enumerate(given):
        if isinstance(entry, int | float | Fraction):
            continue
        # Difference quotient over a step to each side, one-sided where the value would change its sign.
        step = STEP * (abs(at[place]) or 1.0)
        below = at[place] - step if place == SIGNED or at[place] > step else at[place]
        low, high = (_stiffness([*at[:place], x, *at[place + 1 :]]) for x in (below, at[place] + step))
        slope = (high - low) / (at[place] + step - below)
        moved = entry - Fraction(at[place])
        parts = (parts[0] + slope.real * moved, parts[1] + slope.imag * moved)
    return parts


def _stiffness(values: list[float]) -> complex:
    from torsionnet.model.arc_spring.loop_at_torque import loop_at_torque
    from torsionnet.model.arc_spring.slow_loop import ArcSprings

    springs, (amplitude, torque) = ArcSprings(*values[:6]), values[6:]
    return loop_at_torque(springs, amplitude, torque).stiffness


def arc_values(element: Any) -> tuple[Expression, ...]:
    """Entries of an element with arc springs in the order of :func:`arc_stiffness`."""
    return (
        element.stiffness,
        element.arc_angle,
        element.friction_coefficient,
        element.spring_mass,
        element.spring_radius,
        element.speed,
        element.swing,
        element.torque,
    )
