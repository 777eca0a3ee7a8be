"""Modes of running machinery whose parameters follow the operating point."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.core.errors import UsageError
from torsionnet.core.units import RPM
from torsionnet.model.operating_values import following
from torsionnet.response.vibration_mode import VibrationMode
from torsionnet.solve.mode_pairs import vibration_modes
from torsionnet.solve.modes import modes
from torsionnet.solve.operating_groups import at_speeds

TOLERANCE, MOST_STEPS = 1e-6, 60
"""Share by which a critical speed and the speed its mode is calculated at may differ, and in how many steps."""


class ModesOverSpeed:
    """The vibration modes at speeds of a reference node; beyond the range of speeds those of its ends.

    Where no parameter follows the operating point there is one set of modes.
    """

    def __init__(self, drivetrain: AssembledModel, reference: str, speed_range: tuple[float, float]) -> None:
        self.drivetrain, self.reference, self.speed_range = drivetrain, reference, speed_range
        self._found: dict[float, tuple[VibrationMode, ...]] = {}

    @cached_property
    def follow(self) -> bool:
        """Whether modes differ from speed to speed."""
        return bool(following(self.drivetrain.definition))

    def at(self, speed: float) -> tuple[VibrationMode, ...]:
        """Rising with their undamped frequencies."""
        inside = min(max(speed, self.speed_range[0]), self.speed_range[1])
        if inside not in self._found:
            ((rig, _),) = at_speeds(self.drivetrain, self.reference, np.array([inside]))
            self._found[inside] = vibration_modes(rig, modes(rig))
        return self._found[inside]

    def settled(self, mode: VibrationMode, speed_of: Callable[[VibrationMode], float]) -> VibrationMode:
        """The mode of this number at the speed that itself is critical with.

        Raises
        ------
        UsageError
            The two do not settle.
        """
        if not self.follow:
            return mode
        speed, length, before = speed_of(mode), 1.0, np.inf
        for _ in range(MOST_STEPS):
            if not speed > 0:
                return mode
            found = self.at(speed)
            if mode.number > len(found):
                return mode
            mode = found[mode.number - 1]
            step = speed_of(mode) - speed
            if abs(step) <= TOLERANCE * speed:
                return mode
            length = length / 2 if abs(step) > 0.7 * before else length
            before = abs(step)
            speed += length * step
        text = f"mode {mode.number} and its critical speed near {speed * RPM:.6g} rpm"
        raise UsageError(f"{text} do not settle within {TOLERANCE:g} of each other")
