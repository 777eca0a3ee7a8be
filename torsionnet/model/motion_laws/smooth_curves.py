"""Torque curves without steps: hardening springs, loads over speed, induction and synchronous machines."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from torsionnet.base.units import RPM
from torsionnet.model.element_base.laws import MotionState, TorqueCurve

# Torque curves of loads over their speed: a power of it, and a propeller behind a ship that keeps its speed.


@dataclass(frozen=True)
class PowerCurve(TorqueCurve):
    """Torque T_r (omega/omega_r)^m of a load: ``size`` T_r at the ``speed`` omega_r, with the ``exponent`` m.

    An exponent of 2 is that of a propeller or a fan, 0 of a hoist, -1 of a load that takes the power T_r omega_r at any
    speed. With an exponent above zero the other sense of rotation mirrors it, T(-omega) = -T(omega); others turn one
    way only, and refuse to come to a stand.

    Examples
    --------
    >>> fan = PowerCurve(size=90, speed=30, exponent=2)
    >>> fan.torque(0, 15), fan.torque(0, -15), fan.slopes(MotionState(rate=15))
    (22.5, -22.5, (0, 3.0))
    >>> converter = PowerCurve(size=600, speed=1, exponent=-1)
    >>> converter.torque(0, 20), converter.slopes(MotionState(rate=20))[1], converter.states_at(30)[0].rate
    (30.0, -1.5, 20.0)
    """

    over = "rate"

    size: Any
    speed: Any
    exponent: Any

    def torque(self, twist: Any, rate: Any, *sensed: Any) -> Any:
        del twist, sensed
        if self.exponent == 0:
            return self.size
        if rate == 0:
            return 0 * self.size
        # T = T_0 |omega/omega_0|^m, with the sign of omega.
        size = self.size * abs(rate / self.speed) ** self.exponent
        return size if rate > 0 else -size

    def energy(self, twist: Any) -> Any:
        return 0 * twist

    def slopes(self, state: MotionState) -> tuple[Any, ...]:
        if self.exponent == 0:
            return 0, 0
        if state.rate == 0:
            return 0, self.size / self.speed if self.exponent == 1 else 0
        # dT/domega = m T/omega.
        return 0, self.exponent * self.torque(0, state.rate) / state.rate

    def corners(self) -> tuple[Any, ...]:
        return (0,)

    def states_at(self, torque: Any) -> tuple[MotionState, ...] | None:
        """State in which the load takes a torque in N m; None of a torque that does not follow the speed."""
        there, speed, exponent, wanted = (float(number) for number in (self.size, self.speed, self.exponent, torque))
        if exponent == 0 or there == 0:
            return None
        if wanted == 0:
            return (MotionState(),) if exponent > 0 else ()
        # |omega| = omega_0 |T/T_0|^(1/m).
        rate = speed * abs(wanted / there) ** (1 / exponent)
        return (MotionState(rate=math.copysign(rate, wanted * there)),)

    def left(self, twist: float, rate: float = 0.0, *sensed: float) -> str:
        del twist, sensed
        if self.exponent >= 0 or rate > 0:
            return ""
        text = "a torque that falls with the speed has no value at rest or turning backwards, and the speed is"
        return f"{text} {rate * RPM:.6g} rpm; let it turn faster"


@dataclass(frozen=True)
class OpenWaterCurve(TorqueCurve):
    """Torque Q ((1 - b) r^2 + b r), r = omega/Omega, of a propeller whose ship keeps its speed.

    Q is its torque at the speed Omega. The torque coefficient K_Q follows the advance ratio J_a, which falls as the
    speed rises, along a straight line of slope dK_Q/dJ_a: b = J_a/K_Q dK_Q/dJ_a there. A propeller that turns slowly
    is driven by the water, with a torque below zero. The other sense of rotation mirrors the curve.

    >>> screw = OpenWaterCurve(mean_torque=100, speed=10, bend=-0.5)
    >>> screw.torque(0, 10), screw.slopes(MotionState(rate=10))[1], round(screw.states_at(52)[0].rate, 4)
    (100.0, 25.0, 7.7859)
    """

    over = "rate"

    mean_torque: Any
    speed: Any
    bend: Any

    def torque(self, twist: Any, rate: Any, *sensed: Any) -> Any:
        del twist, sensed
        r = rate / self.speed
        return self.mean_torque * ((1 - self.bend) * r * abs(r) + self.bend * r)

    def energy(self, twist: Any) -> Any:
        return 0 * twist

    def slopes(self, state: MotionState) -> tuple[Any, ...]:
        r = state.rate / self.speed
        return 0, self.mean_torque / self.speed * (2 * (1 - self.bend) * abs(r) + self.bend)

    def corners(self) -> tuple[Any, ...]:
        place = -self.bend / (2 * (1 - self.bend)) * self.speed
        return tuple(sorted({-place, 0 * place, place}))

    def states_at(self, torque: Any) -> tuple[MotionState, ...] | None:
        """State in which the propeller drives the ship and takes a torque in N m > 0; others are left to a search."""
        bend, size = float(self.bend), float(torque) / float(self.mean_torque)
        if bend > 0 or size <= 0:
            return None
        # (1 - b) r^2 + b r = T/Q, of which the root above 0 is wanted.
        r = (-bend + math.sqrt(bend**2 + 4 * (1 - bend) * size)) / (2 * (1 - bend))
        return (MotionState(rate=r * float(self.speed)),)


# Torque curve of a spring that stiffens or softens with the cube of its twist.


@dataclass(frozen=True)
class CubicCurve(TorqueCurve):
    """Torque k gamma + k_3 gamma^3 of a spring, with k in N m/rad and k_3 in N m/rad^3 (Duffing's spring).

    Examples
    --------
    >>> spring = CubicCurve(100, 300)
    >>> spring.torque(2, 0), spring.energy(2), spring.slopes(MotionState(twist=2))
    (2600, 1400.0, (3700, 0))
    >>> [round(state.twist, 9) for state in spring.states_at(2600)]
    [2.0]
    """

    over = "twist"

    stiffness: Any
    cubic: Any

    def torque(self, twist: Any, rate: Any, *sensed: Any) -> Any:
        del rate, sensed
        return self.stiffness * twist + self.cubic * twist**3

    def energy(self, twist: Any) -> Any:
        return self.stiffness * twist**2 / 2 + self.cubic * twist**4 / 4

    def slopes(self, state: MotionState) -> tuple[Any, ...]:
        if state.twist == 0:
            return self.stiffness, 0
        return self.stiffness + 3 * self.cubic * state.twist**2, 0

    def corners(self) -> tuple[Any, ...]:
        k, third = float(self.stiffness), float(self.cubic)
        if k * third >= 0:
            return ()
        # dT/dgamma = k + 3 k_3 gamma^2 = 0.
        extreme = math.sqrt(-k / (3 * third))
        return -extreme, extreme

    def scaled(self, ratio: Any) -> CubicCurve:
        return CubicCurve(self.stiffness * ratio**2, self.cubic * ratio**4)

    def states_at(self, torque: Any) -> tuple[MotionState, ...]:
        """States in which the spring gives a torque in N m, by rising twist: one, of a softening spring up to three."""
        import numpy as np

        k, third, wanted = float(self.stiffness), float(self.cubic), float(torque)
        if third == 0:
            return (MotionState(wanted / k),) if k else ()
        # k_3 gamma^3 + k gamma - T = 0.
        roots = np.roots([third, 0.0, k, -wanted])
        real = {float(root.real) for root in roots if abs(root.imag) <= 1e-9 * abs(root)}
        return tuple(MotionState(self._refined(twist, wanted)) for twist in sorted(real))

    def _refined(self, twist: float, torque: float) -> float:
        """Root of the torque near a twist in rad, by two steps of Newton's method from the roots of the polynomial."""
        k, third = float(self.stiffness), float(self.cubic)
        for _ in range(2):
            # of T = k x + k_3 x^3
            slope = k + 3 * third * twist**2
            if slope:
                twist -= (k * twist + third * twist**3 - torque) / slope
        return twist


# Torque curve of an induction machine on a line over its speed, by the equation of Kloss.


@dataclass(frozen=True)
class KlossCurve(TorqueCurve):
    """Torque that an induction machine takes at the speed omega of its rotor, below zero where it drives as a motor.

    It is -2 T_k/(s/s_k + s_k/s) = -2 T_k s_k s/(s^2 + s_k^2) at the slip s = 1 - omega/omega_s, with the breakdown
    torque T_k at the breakdown slip s_k and the synchronous speed omega_s. Its slope over the speed is
    2 T_k s_k (s_k^2 - s^2)/(omega_s (s^2 + s_k^2)^2), below zero beyond the breakdown slip.

    Examples
    --------
    Six tenths of the breakdown torque stand at a third of the breakdown slip and, unstable, at three times it:

    >>> motor = KlossCurve(breakdown_torque=400, breakdown_slip=0.1, synchronous_speed=100)
    >>> [round(1 - state.rate / 100, 9) for state in motor.states_at(-240)]
    [0.3, 0.033333333]
    >>> [round(motor.slopes(state)[1], 3) for state in motor.states_at(-240)]
    [-6.4, 57.6]
    >>> motor.states_at(-401)
    ()
    """

    over = "rate"

    breakdown_torque: Any
    breakdown_slip: Any
    synchronous_speed: Any

    def slip(self, rate: Any) -> Any:
        """Slip without unit at a speed in rad/s."""
        return 1 - rate / self.synchronous_speed

    def torque(self, twist: Any, rate: Any, *sensed: Any) -> Any:
        del twist, sensed
        slip = self.slip(rate)
        return -2 * self.breakdown_torque * self.breakdown_slip * slip / (slip**2 + self.breakdown_slip**2)

    def energy(self, twist: Any) -> Any:
        return 0 * twist

    def slopes(self, state: MotionState) -> tuple[Any, ...]:
        return 0, self.slope(self.slip(state.rate))

    def slope(self, slip: Any) -> Any:
        """Slope of the torque over the speed in N m s/rad at a slip."""
        breakdown = self.breakdown_slip
        # dT/ds over omega_s of Kloss' formula, T = 2 T_b s_b s/(s^2 + s_b^2)
        size = 2 * self.breakdown_torque / self.synchronous_speed
        return size * breakdown * (breakdown**2 - slip**2) / (slip**2 + breakdown**2) ** 2

    def corners(self) -> tuple[Any, ...]:
        speed, breakdown = self.synchronous_speed, self.breakdown_slip
        return (1 - breakdown) * speed, (1 + breakdown) * speed

    def states_at(self, torque: Any) -> tuple[MotionState, ...]:
        """States in which the machine takes a torque in N m, by rising speed: two slips, s and s_k^2/s.

        At the breakdown torque they are one, beyond it there is none, and without torque there is that without slip.
        """
        breakdown, speed, wanted = (float(number) for number in (self.breakdown_slip, self.synchronous_speed, torque))
        if wanted == 0:
            return (MotionState(rate=speed),)
        # Kloss: s/s_k + s_k/s = 2 T_k/T with the driving torque T, so that s = s_k (m +- sqrt(m^2 - 1)), m = T_k/T.
        over = float(self.breakdown_torque) / -wanted
        if abs(over) < 1:
            return ()
        if abs(over) == 1:
            return (MotionState(rate=speed * (1 - over * breakdown)),)
        # The larger root first, without a difference; the other follows from their product s_k^2.
        larger = breakdown * (over + math.copysign(math.sqrt(over**2 - 1), over))
        slips = sorted((larger, breakdown**2 / larger), reverse=True)
        return tuple(MotionState(rate=speed * (1 - slip)) for slip in slips)


# Torque curve of a synchronous machine over the angle of its rotor against the turning field.

ON_CIRCLE = 1e-7
"""Distance from 1 of the size of a double root that rounding leaves: the root of the rounding of a float, and some."""


@dataclass(frozen=True)
class LoadAngleCurve(TorqueCurve):
    """Torque T_e sin(p gamma) + T_r sin(2 p gamma) of p pole pairs over the mechanical angle gamma to the field.

    Examples
    --------
    >>> machine = LoadAngleCurve(field_torque=100, reluctance_torque=0, pole_pairs=2)
    >>> [round(math.degrees(state.twist), 9) for state in machine.states_at(50)]
    [15.0, 75.0]
    >>> [round(machine.slopes(state)[0], 6) for state in machine.states_at(50)]
    [173.205081, -173.205081]
    """

    over = "twist"

    field_torque: Any
    reluctance_torque: Any
    pole_pairs: Any

    def torque(self, twist: Any, rate: Any, *sensed: Any) -> Any:
        del rate, sensed
        angle = float(self.pole_pairs * twist)
        return self.field_torque * math.sin(angle) + self.reluctance_torque * math.sin(2 * angle)

    def energy(self, twist: Any) -> Any:
        angle = float(self.pole_pairs * twist)
        once, twice = 2 * math.sin(angle / 2) ** 2, math.sin(angle) ** 2  # 1 - cos, without its rounding
        return (self.field_torque * once + self.reluctance_torque * twice) / self.pole_pairs

    def slopes(self, state: MotionState) -> tuple[Any, ...]:
        angle = float(self.pole_pairs * state.twist)
        once, twice = self.field_torque * math.cos(angle), self.reluctance_torque * math.cos(2 * angle)
        return self.pole_pairs * (once + 2 * twice), 0

    def states_at(self, torque: Any) -> tuple[MotionState, ...]:
        """States within one electrical turn, from -pi/p on, in which the machine takes a torque in N m, by angle.

        They are stable where the slope is above zero; there is none beyond the pull-out torque.
        """
        import numpy as np

        field, saliency, wanted = (float(number) for number in (self.field_torque, self.reluctance_torque, torque))
        # T_e sin(delta) + T_r sin(2 delta) = T times 2j z^2, as sin(delta) = (z - 1/z)/2j.
        coefficients = np.array([saliency, field, -2j * wanted, -field, -saliency])  # of z = e^(j delta)
        if saliency == 0:
            coefficients = coefficients[1:4]
        roots = [complex(root) for root in np.roots(coefficients)]
        # Roots off the unit circle are no angles.
        angles = [math.atan2(root.imag, root.real) for root in roots if abs(abs(root) - 1) < ON_CIRCLE]
        distinct: list[float] = []
        for angle in sorted(self._refined(angle, field, saliency, wanted) for angle in angles):
            if not distinct or angle - distinct[-1] > ON_CIRCLE:  # at the pull-out torque two are one
                distinct.append(angle)
        return tuple(MotionState(twist=angle / float(self.pole_pairs)) for angle in distinct)

    @staticmethod
    def _refined(angle: float, field: float, saliency: float, wanted: float) -> float:
        """Root of the torque near an electrical angle in rad, by two steps of Newton's method."""
        for _ in range(2):
            # of T = T_f sin(delta) + T_s sin(2 delta)
            slope = field * math.cos(angle) + 2 * saliency * math.cos(2 * angle)
            if abs(slope) > ON_CIRCLE * (field + abs(saliency)):
                angle -= (field * math.sin(angle) + saliency * math.sin(2 * angle) - wanted) / slope
        return angle
