"""Torque curve of a synchronous machine over the angle of its rotor against the turning field."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from torsionnet.model.element_base.laws import MotionState, TorqueCurve

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

        field, saliency, wanted = (float(one) for one in (self.field_torque, self.reluctance_torque, torque))
        coefficients = np.array([saliency, field, -2j * wanted, -field, -saliency])  # of z = e^(j delta)
        if saliency == 0:
            coefficients = coefficients[1:4]
        roots = [complex(root) for root in np.roots(coefficients)]
        angles = [math.atan2(root.imag, root.real) for root in roots if abs(abs(root) - 1) < ON_CIRCLE]
        found: list[float] = []
        for angle in sorted(self._refined(angle, field, saliency, wanted) for angle in angles):
            if not found or angle - found[-1] > ON_CIRCLE:  # at the pull-out torque two are one
                found.append(angle)
        return tuple(MotionState(twist=angle / float(self.pole_pairs)) for angle in found)

    @staticmethod
    def _refined(angle: float, field: float, saliency: float, wanted: float) -> float:
        """Root of the torque near an electrical angle in rad, by two steps of Newton's method."""
        for _ in range(2):
            slope = field * math.cos(angle) + 2 * saliency * math.cos(2 * angle)
            if abs(slope) > ON_CIRCLE * (field + abs(saliency)):
                angle -= (field * math.sin(angle) + saliency * math.sin(2 * angle) - wanted) / slope
        return angle
