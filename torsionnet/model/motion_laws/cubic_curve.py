"""Torque curve of a spring that stiffens or softens with the cube of its twist."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from torsionnet.model.element_base.laws import MotionState, TorqueCurve


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
        roots = np.roots([third, 0.0, k, -wanted])
        real = {float(root.real) for root in roots if abs(root.imag) <= 1e-9 * abs(root)}
        return tuple(MotionState(self._refined(twist, wanted)) for twist in sorted(real))

    def _refined(self, twist: float, torque: float) -> float:
        """Root of the torque near a twist in rad, by two steps of Newton's method from the roots of the polynomial."""
        k, third = float(self.stiffness), float(self.cubic)
        for _ in range(2):
            slope = k + 3 * third * twist**2
            if slope:
                twist -= (k * twist + third * twist**3 - torque) / slope
        return twist
