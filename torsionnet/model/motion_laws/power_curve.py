"""Torque curves of loads over their speed: a power of it, and a propeller behind a ship that keeps its speed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from torsionnet.base.units import RPM
from torsionnet.model.element_base.laws import MotionState, TorqueCurve


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
        size = self.size * abs(rate / self.speed) ** self.exponent
        return size if rate > 0 else -size

    def energy(self, twist: Any) -> Any:
        return 0 * twist

    def slopes(self, state: MotionState) -> tuple[Any, ...]:
        if self.exponent == 0:
            return 0, 0
        if state.rate == 0:
            return 0, self.size / self.speed if self.exponent == 1 else 0
        return 0, self.exponent * self.torque(0, state.rate) / state.rate

    def corners(self) -> tuple[Any, ...]:
        return (0,)

    def states_at(self, torque: Any) -> tuple[MotionState, ...] | None:
        """State in which the load takes a torque in N m; None of a torque that does not follow the speed."""
        there, speed, exponent, wanted = (float(one) for one in (self.size, self.speed, self.exponent, torque))
        if exponent == 0 or there == 0:
            return None
        if wanted == 0:
            return (MotionState(),) if exponent > 0 else ()
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
        r = (-bend + math.sqrt(bend**2 + 4 * (1 - bend) * size)) / (2 * (1 - bend))
        return (MotionState(rate=r * float(self.speed)),)
