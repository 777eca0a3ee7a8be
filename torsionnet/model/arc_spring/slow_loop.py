"""Arc springs pressed against a curved channel: torque over twist of slow motion in closed form.

A coil of a spring on the arc psi is pressed outward by its centrifugal force and by the spring force that turns with
it. With the torque T(s) of the spring at the share s of its length from the flange, C = m r^2 Omega^2 and Coulomb's
friction mu, coils that slide have dT/ds = -+mu (C + psi T). In u = T + C/psi and e = mu psi that is du/ds = -+e u: the
torque falls exponentially along the spring, and k gamma = integral of T ds.

*First loading*: the front at which u has fallen to u_0 = C/psi runs inward, k gamma = (u - u_0 - u_0 ln(u/u_0))/e;
from u = u_0 exp(e) on all coils slide and k gamma = u (1 - exp(-e))/e - u_0.

*From a top u_t over a swing q*: with E = sqrt(k e q/u_t) the coils slide to the depth z = -ln(1 - E)/e, those beyond
are locked, and u_b = u_t (1 - E)^2. At the distance x from its reversal the falling branch is u_t (1 - w)^2 with
w = sqrt(k e x/u_t), the rising one u_b (1 + w)^2 with w = sqrt(k e x/u_b). Once z = 1 they go on straight, with the
slopes k e/(exp(e) - 1) and k e/(1 - exp(-e)).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

POINTS = 24
"""Points of Gauss' rule on each piece of a branch, smooth over the phase; 16 reach rounding."""


@dataclass(frozen=True)
class ArcSprings:
    """Arc springs of a flywheel taken together, their stiffness k referred to the angle.

    Attributes
    ----------
    stiffness : float
        k in N m/rad without friction.
    arc_angle : float
        psi in rad, the angle on which a spring lies.
    friction_coefficient : float
        mu between coils and channel.
    spring_mass, spring_radius, speed : float
        m in kg, r in m and Omega in rad/s, which press the coils outward.
    """

    stiffness: float
    arc_angle: float
    friction_coefficient: float
    spring_mass: float
    spring_radius: float
    speed: float

    @property
    def winding(self) -> float:
        """Exponent e = mu psi by which friction wound round the arc reduces the torque."""
        return self.friction_coefficient * self.arc_angle

    @property
    def pressure(self) -> float:
        """Pressure C = m r^2 Omega^2 in N m, the centrifugal force of the coils times the radius."""
        return self.spring_mass * self.spring_radius**2 * self.speed**2

    @property
    def base(self) -> float:
        """Value u_0 = C/psi in N m, which with the torque makes u."""
        return self.pressure / self.arc_angle

    def first_torque(self, twist: float) -> float:
        """Torque in N m at a twist in rad when the springs are loaded for the first time.

        >>> springs = ArcSprings(700.0, 2.6, 0.12, 0.9, 0.11, 3000 * math.pi / 30)
        >>> round(springs.first_torque(math.radians(20)), 5)
        352.27896
        """
        e, base, pushed = self.winding, self.base, self.stiffness * abs(twist)
        if e == 0:
            torque = pushed
        elif base == 0 or pushed >= base * (math.expm1(e) - e) / e:
            torque = (pushed + base) * e / -math.expm1(-e) - base
        else:
            torque = base * _front(e * pushed / base)
        return math.copysign(torque, twist)

    def first_twist(self, torque: float) -> float:
        """Twist in rad at a torque in N m when the springs are loaded for the first time.

        >>> springs = ArcSprings(700.0, 2.6, 0.12, 0.9, 0.11, 3000 * math.pi / 30)
        >>> round(math.degrees(springs.first_twist(352.27896)), 6)
        20.0
        """
        e, base = self.winding, self.base
        # The three cases of first_torque, each solved for the push k gamma.
        u = abs(torque) + base
        if e == 0:
            pushed = u - base
        elif base == 0 or u >= base * math.exp(e):
            pushed = u * -math.expm1(-e) / e - base
        else:
            pushed = (u - base - base * math.log(u / base)) / e
        return math.copysign(pushed / self.stiffness, torque)


def _front(share: float) -> float:
    """Root y > 0 of y - ln(1 + y) = share, by Newton's method from its first term y^2/2."""
    # y - ln(1 + y) = share by Newton's method, from its first terms y^2/2 - y^3/3.
    y = math.sqrt(2 * share) + share / 1.5
    for _ in range(30):
        step = (y - math.log1p(y) - share) * (1 + y) / y if y else 0.0
        y -= step
        if abs(step) <= 1e-15 * y:
            break
    return y


@dataclass(frozen=True)
class SlowLoop:
    """Loop of torque over twist in slow cycles of one amplitude.

    Attributes
    ----------
    amplitude, mean_twist : float
        rad.
    top, bottom : float
        Torque at the largest and at the smallest twist, N m.
    mean_torque : float
        Mean over time of a sine of twist, N m.
    loss : float
        Loss of a cycle, J.
    elastic : float
        k', real part of the first harmonic of torque over that of a sine of twist, N m/rad.
    depth : float
        Share of the spring, from the flange on, that moves; the coils beyond are locked by friction.
    """

    amplitude: float
    mean_twist: float
    top: float
    bottom: float
    mean_torque: float
    loss: float
    elastic: float
    depth: float

    @property
    def secant_stiffness(self) -> float:
        """Secant k_s in N m/rad from tip to tip, friction included."""
        return (self.top - self.bottom) / (2 * self.amplitude)

    @property
    def secant_loss_factor(self) -> float:
        """Loss factor eta_s = D/(pi k_s a^2), 4/(3 pi) while coils are locked."""
        return self.loss / (math.pi * self.secant_stiffness * self.amplitude**2)

    @property
    def stiffness(self) -> complex:
        """Complex k' + j k'' in N m/rad, first harmonic of torque over that of the twist; k'' = D/(pi a^2)."""
        return complex(self.elastic, self.loss / (math.pi * self.amplitude**2))

    @property
    def loss_factor(self) -> float:
        """Loss factor eta_1 = k''/k', 1/2 while coils are locked; another number than that of the secant."""
        return self.stiffness.imag / self.elastic

    def mirrored(self) -> SlowLoop:
        """Loop of the other sign of torque and twist."""
        return SlowLoop(
            self.amplitude, -self.mean_twist, -self.bottom, -self.top, -self.mean_torque, self.loss, self.elastic,
            self.depth,
        )  # fmt: skip


def closed_loop(springs: ArcSprings, amplitude: float, mean_twist: float) -> SlowLoop | None:
    """Loop between two twists in rad after one loading from nothing to the upper of them, in closed form.

    None where the flange lifts off the springs in the cycle, which only :func:`.marched_loop` follows.

    >>> springs = ArcSprings(700.0, 2.6, 0.12, 0.9, 0.11, 3000 * math.pi / 30)
    >>> loop = closed_loop(springs, math.radians(2), math.radians(20))
    >>> round(loop.secant_stiffness, 4), round(loop.loss, 6), round(loop.secant_loss_factor, 6)
    (2933.8988, 4.766489, 0.424413)
    """
    if mean_twist < 0:
        other = closed_loop(springs, amplitude, -mean_twist)
        return None if other is None else other.mirrored()
    if mean_twist < amplitude:
        return None
    return loop_from_top(springs, amplitude, springs.first_torque(mean_twist + amplitude), mean_twist)


def loop_from_top(springs: ArcSprings, amplitude: float, top: float, mean_twist: float = math.nan) -> SlowLoop | None:
    """Loop of an amplitude in rad from a top torque in N m, or None where the flange lifts off the springs."""
    k, e, base, swing = springs.stiffness, springs.winding, springs.base, 2 * amplitude
    if e == 0:
        bottom = top - k * swing
        middle = (top + bottom) / 2
        return SlowLoop(amplitude, mean_twist, top, bottom, middle, 0.0, k, 1.0) if bottom >= 0 else None
    high = top + base
    reached = math.sqrt(k * e * swing / high) if high > 0 else math.inf
    if reached <= -math.expm1(-e):
        low, depth = high * (1 - reached) ** 2, -math.log1p(-reached) / e
    else:
        # All coils slide at the reversal already: the falling branch has gone on straight.
        low, depth = (-high * math.expm1(-e) - k * e * swing) / math.expm1(e), 1.0
    if low < base or low <= 0:
        return None
    falling = _Branch(high, k * e, -1, e)
    rising = _Branch(low, k * e, 1, e)
    area = rising.area(swing) - falling.area(swing)
    mean, first = _harmonics(amplitude, falling, rising)
    return SlowLoop(amplitude, mean_twist, top, low - base, mean - base, area, first, depth)


@dataclass(frozen=True)
class _Branch:
    """Torque u over the distance x from a reversal at u_r: u_r (1 + sign w)^2, straight once all coils slide."""

    start: float
    rate: float
    sign: int
    winding: float

    @property
    def corner(self) -> float:
        """Distance at which the last coil begins to slide: w = exp(e) - 1 rising, 1 - exp(-e) falling."""
        return self.start * math.expm1(self.sign * self.winding) ** 2 / self.rate

    @property
    def slope(self) -> float:
        """Slope du/dx of the straight rest, k e/(1 - exp(-e)) rising, -k e/(exp(e) - 1) falling."""
        return self.rate / -math.expm1(-self.sign * self.winding)

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        w = np.sqrt(self.rate * np.minimum(x, self.corner) / self.start)
        bent: NDArray[np.float64] = self.start * (1 + self.sign * w) ** 2
        return bent + self.slope * np.maximum(x - self.corner, 0.0)

    def area(self, x: float) -> float:
        """Integral of u from the reversal to x, in w on the bent part: dx = 2 u_r w dw/(k e)."""
        w, rest = math.sqrt(self.rate * min(x, self.corner) / self.start), max(x - self.corner, 0.0)
        # u = u_r (1 + s w)^2 there, s = +-1: the integral of (1 + 2 s w + w^2) w dw.
        bent = 2 * self.start**2 / self.rate * (w**2 / 2 + self.sign * 2 * w**3 / 3 + w**4 / 4)
        return bent + rest * (self.start * (1 + self.sign * w) ** 2 + self.slope * rest / 2)


def _harmonics(amplitude: float, falling: _Branch, rising: _Branch) -> tuple[float, float]:
    """Mean and k' of the torque u under gamma = a cos(tau), by Gauss' rule between the corners of the branches."""
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)

    def over_half(branch: _Branch, value: Callable[[NDArray[np.float64]], NDArray[np.float64]], turn: int) -> float:
        # x = a (1 - cos(tau)) from the reversal at tau = 0; the square root in x is a sine in tau.
        corner = math.acos(max(-1.0, 1 - branch.corner / amplitude))
        total = 0.0
        for start, end in ((0.0, corner), (corner, math.pi)):
            tau = start + (end - start) * (nodes + 1) / 2
            x = amplitude * 2 * np.sin(tau / 2) ** 2
            total += (end - start) / 2 * float(weights @ (branch(x) * value(turn * np.cos(tau))))
        return total

    mean = sum(over_half(branch, np.ones_like, 1) for branch in (falling, rising)) / (2 * math.pi)
    # The rising branch begins at gamma = -a.
    first = over_half(falling, np.array, 1) + over_half(rising, np.array, -1)
    return mean, first / (math.pi * amplitude)
