"""Torque curve of an induction machine on a line over its speed, by the equation of Kloss."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from torsionnet.model.element_base.laws import MotionState, TorqueCurve


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
        size = 2 * self.breakdown_torque / self.synchronous_speed
        return size * breakdown * (breakdown**2 - slip**2) / (slip**2 + breakdown**2) ** 2

    def corners(self) -> tuple[Any, ...]:
        speed, breakdown = self.synchronous_speed, self.breakdown_slip
        return (1 - breakdown) * speed, (1 + breakdown) * speed

    def states_at(self, torque: Any) -> tuple[MotionState, ...]:
        """States in which the machine takes a torque in N m, by rising speed: two slips, s and s_k^2/s.

        At the breakdown torque they are one, beyond it there is none, and without torque there is that without slip.
        """
        breakdown, speed, wanted = (float(one) for one in (self.breakdown_slip, self.synchronous_speed, torque))
        if wanted == 0:
            return (MotionState(rate=speed),)
        over = float(self.breakdown_torque) / -wanted
        if abs(over) < 1:
            return ()
        if abs(over) == 1:
            return (MotionState(rate=speed * (1 - over * breakdown)),)
        larger = breakdown * (over + math.copysign(math.sqrt(over**2 - 1), over))
        slips = sorted((larger, breakdown**2 / larger), reverse=True)
        return tuple(MotionState(rate=speed * (1 - slip)) for slip in slips)
