"""Rotation of a shaft from the pulses of a toothed wheel, band-limited between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.core.errors import UsageError
from torsionnet.response.measured.pulse_channel import PulseChannel
from torsionnet.response.measured.wheel_pattern import WheelPattern
from torsionnet.response.recording import FloatArray
from torsionnet.signals.bandlimited import Rotation
from torsionnet.signals.pulses import repaired_pulses
from torsionnet.signals.rotation.wheel import Wheel


@dataclass(frozen=True, eq=False)
class WheelRotation:
    """Rotation of the reference shaft as a toothed wheel shows it, over the time of its pulses.

    Attributes
    ----------
    name : str
    wheel : Wheel
    times : (n,) array
        Times of the pulses kept, s.
    numbers : (n,) int array
        Tooth of each pulse, counted on from turn to turn; tooth 0 is the first after the gap of a wheel with missing
        teeth, else that of the first pulse.
    rotation : Rotation
        Rotation in pitches since the first pulse, at places of even pitch.
    remarks : tuple of str
        Repairs, with their counts.
    """

    name: str
    wheel: Wheel
    times: FloatArray
    numbers: NDArray[np.intp]
    rotation: Rotation
    remarks: tuple[str, ...] = ()

    def angle(self, times: FloatArray) -> FloatArray:
        """Angle of the reference shaft in rad at times in s between first and last pulse, shape (n,).

        It is 0 at tooth 0.
        """
        turns = (self.rotation.at(times) + self.numbers[0]) / self.wheel.teeth
        return np.asarray(2 * np.pi * self.wheel.ratio * (-turns if self.wheel.reversed else turns))


def wheel_rotation(channel: PulseChannel, wheel: Wheel, pattern: WheelPattern | None = None) -> WheelRotation:
    """Rotation of the reference shaft from the pulses of a wheel, without the errors of its pitch pattern.

    Raises
    ------
    UsageError
        Pulses that cannot be repaired, or a pattern of another number of teeth.
    """
    if pattern is not None and pattern.teeth != wheel.teeth:
        raise UsageError(f"{channel.name}: a pattern of {pattern.teeth} teeth does not fit a wheel of {wheel.teeth}")
    found = repaired_pulses(channel.times, wheel.teeth)
    return WheelRotation(
        channel.name, wheel, found.times, found.numbers,
        Rotation(found.times, found.numbers, wheel.teeth), found.remarks,
    )  # fmt: skip
