"""Modes of running machinery whose parameters follow the operating point."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.core.errors import SolveError
from torsionnet.core.units import RPM
from torsionnet.response.vibration_mode import VibrationMode
from torsionnet.solve.modes.mode_pairs import vibration_modes
from torsionnet.solve.modes.modes import modes
from torsionnet.solve.running.operating_groups import at_speeds

TOLERANCE, MOST_STEPS = 1e-6, 60
"""Share by which a critical speed and the speed its mode is calculated at may differ, and in how many steps."""

STRIDE = 1.2
"""From a speed to the next on the way to one on the other side of the line."""


class ModesOverSpeed:
    """The vibration modes at speeds of a reference node; beyond the range of speeds those of its ends.

    Where no parameter follows the operating point there is one set of modes. ``numbers`` are those of the modes at the
    operating point, by rising undamped frequency: a mode keeps its number at every speed.
    """

    def __init__(
        self, drivetrain: AssembledModel, reference: str, speed_range: tuple[float, float], numbers: Sequence[int] = ()
    ) -> None:
        self.drivetrain: AssembledModel = drivetrain
        self.reference: str = reference
        self.speed_range: tuple[float, float] = speed_range
        self.numbers = numbers
        self._found: dict[float, tuple[VibrationMode, ...]] = {}

    @cached_property
    def follow(self) -> bool:
        """Whether modes differ from speed to speed."""
        return bool(self.drivetrain.definition.following)

    def at(self, speed: float) -> tuple[VibrationMode, ...]:
        """Rising with their undamped frequencies."""
        inside = min(max(speed, self.speed_range[0]), self.speed_range[1])
        if inside not in self._found:
            ((rig, _),) = at_speeds(self.drivetrain, self.reference, np.array([inside]))
            found = vibration_modes(rig, modes(rig))
            known = [*self.numbers, *range(len(self.numbers) + 1, len(found) + 1)]
            self._found[inside] = tuple(
                replace(mode, number=number) for mode, number in zip(found, known, strict=False)
            )
        return self._found[inside]

    def settled(self, mode: VibrationMode, speed_of: Callable[[VibrationMode], float]) -> VibrationMode:
        """The mode of this number at the speed that itself is critical with.

        Raises
        ------
        SolveError
            The two do not settle: the frequency leaps over the line.
        """
        if not self.follow:
            return mode
        speed, length, before = speed_of(mode), 1.0, np.inf
        for _ in range(MOST_STEPS):
            found = self._numbered(mode.number, speed)
            if found is None:
                return mode
            mode = found
            step = speed_of(mode) - speed
            if abs(step) <= TOLERANCE * speed:
                return mode
            length = length / 2 if abs(step) > 0.7 * before else length
            before = abs(step)
            speed += length * step
        return self._bracketed(mode, speed, speed_of)

    def _numbered(self, number: int, speed: float) -> VibrationMode | None:
        found = self.at(speed) if speed > 0 else ()
        return next((mode for mode in found if mode.number == number), None)

    def _bracketed(
        self, mode: VibrationMode, speed: float, speed_of: Callable[[VibrationMode], float]
    ) -> VibrationMode:
        """Where a mode rises nearly with the line, as one of pendulums does, steps from one to the other do not end.

        Beyond the range of speeds modes stay as they are, so that there always are speeds on both sides.
        """
        from scipy.optimize import brentq

        def above(at: float) -> float:
            found = self._numbered(mode.number, at)
            return math.nan if found is None else speed_of(found) - at

        factor = STRIDE if above(speed) > 0 else 1 / STRIDE
        other = speed * factor
        while above(speed) * above(other) > 0:
            speed, other = other, other * factor
        settled = math.nan
        if above(speed) * above(other) <= 0:
            ends, share = (min(speed, other), max(speed, other)), TOLERANCE / 10
            settled = float(brentq(above, ends[0], ends[1], xtol=share * speed, rtol=share))
        last = self._numbered(mode.number, settled)
        if last is not None and abs(above(settled)) <= 10 * TOLERANCE * settled:
            return last
        text = f"mode {mode.number} and its critical speed near {speed * RPM:.6g} rpm"
        raise SolveError(f"{text} do not settle within {TOLERANCE:g} of each other")
