"""Natural frequencies and mode shapes at any speed, where parameters follow the operating point."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.core.errors import SolveError
from torsionnet.core.units import RPM
from torsionnet.response.vibrations.vibration_mode import VibrationMode
from torsionnet.solve.modes.mode_pairs import vibration_modes
from torsionnet.solve.modes.modes import modes
from torsionnet.solve.responses.shared_response import shared_by_conditions
from torsionnet.solve.running.operating_groups import drivetrains_at_speeds, values_at_speeds

SPEED_TOLERANCE = 1e-6
"""Relative difference up to which a critical speed agrees with the speed at which its mode was calculated, as speeds
are shown in six figures.

A smaller value costs more sets of modes; speeds are shown in six figures.
"""
MOST_ITERATIONS = 60
"""Most iterations for a critical speed before it is bracketed instead, which more iterations would only delay."""

MODE_BYTES = 100
"""Size in bytes of a mode per node, with shape and texts, as counted against the memory for kept results."""

BRACKET_FACTOR = 1.2
"""Ratio of each trial speed to the one before while a bracket of a critical speed is sought.

A larger ratio may step over two crossings at once, a smaller one needs more sets of modes.
"""


class ModesOverSpeed:
    """Vibration modes at any speed of a reference node, beyond the range of speeds those at its ends.

    Where no parameter follows the operating point there is one set of modes. ``numbers`` are the numbers of the modes
    at the operating point, by rising undamped frequency: a mode keeps its number at every speed.
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
    def is_speed_dependent(self) -> bool:
        """Whether modes differ from speed to speed, because parameters follow the operating point."""
        return self.drivetrain.definition.follows_speed

    def at(self, speed: float) -> tuple[VibrationMode, ...]:
        """Vibration modes at a speed of the reference node in rad/s, numbered, by rising undamped frequency."""
        inside = min(max(speed, self.speed_range[0]), self.speed_range[1])
        if inside not in self._found:
            known = [*self.numbers, *range(len(self.numbers) + 1, len(self._unnumbered(inside)) + 1)]
            self._found[inside] = tuple(
                replace(mode, number=number) for mode, number in zip(self._unnumbered(inside), known, strict=False)
            )
        return self._found[inside]

    def _unnumbered(self, speed: float) -> tuple[VibrationMode, ...]:
        """Vibration modes at a speed in rad/s, by rising undamped frequency, before they are numbered."""

        def found() -> tuple[VibrationMode, ...]:
            ((rig, _),) = drivetrains_at_speeds(self.drivetrain, self.reference, np.array([speed]))
            return tuple(vibration_modes(rig, modes(rig)))

        (values,) = (
            values_at_speeds(self.drivetrain, self.reference, np.array([speed])) if self.is_speed_dependent else ({},)
        )
        size = MODE_BYTES * len(self.drivetrain.nodes) ** 2
        return shared_by_conditions(self.drivetrain, tuple, tuple(values.items()), found, lambda _: size)

    def at_critical_speed(self, mode: VibrationMode, speed_of: Callable[[VibrationMode], float]) -> VibrationMode:
        """Vibration mode of the same number at its own critical speed, which ``speed_of`` gives in rad/s for a mode.

        Raises
        ------
        SolveError
            No speed agrees with its mode: the frequency leaps over the order line.
        """
        if not self.is_speed_dependent:
            return mode
        speed, length, before = speed_of(mode), 1.0, np.inf
        for _ in range(MOST_ITERATIONS):
            found = self._numbered(mode.number, speed)
            if found is None:
                return mode
            mode = found
            step = speed_of(mode) - speed
            if abs(step) <= SPEED_TOLERANCE * speed:
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
        """Vibration mode at its own critical speed, found by bracketing where iteration fails.

        Modes may rise nearly with the line, as those of pendulums do.

        Beyond the range of speeds modes stay as they are, so that there always are speeds on both sides.
        """
        from scipy.optimize import brentq

        def above(at: float) -> float:
            found = self._numbered(mode.number, at)
            return math.nan if found is None else speed_of(found) - at

        factor = BRACKET_FACTOR if above(speed) > 0 else 1 / BRACKET_FACTOR
        other = speed * factor
        while above(speed) * above(other) > 0:
            speed, other = other, other * factor
        settled = math.nan
        if above(speed) * above(other) <= 0:
            ends, share = (min(speed, other), max(speed, other)), SPEED_TOLERANCE / 10
            settled = float(brentq(above, ends[0], ends[1], xtol=share * speed, rtol=share))
        last = self._numbered(mode.number, settled)
        if last is not None and abs(above(settled)) <= 10 * SPEED_TOLERANCE * settled:
            return last
        text = f"mode {mode.number} and its critical speed near {speed * RPM:.6g} rpm"
        advice = "the frequency leaps across the order; see the modes at speeds nearby"
        raise SolveError(f"{text} do not settle within {SPEED_TOLERANCE:g} of each other; {advice}")
