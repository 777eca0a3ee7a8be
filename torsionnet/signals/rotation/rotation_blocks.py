"""Rotation of a shaft from long trains of pulses, block by block, so that the memory does not grow with the record."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.wheel import Wheel
from torsionnet.signals.rotation.wheel_pattern import WheelPattern
from torsionnet.signals.rotation.wheel_rotation import WheelRotation, wheel_rotation

PULSES_PER_BLOCK = 200_000
"""Number of pulses of a block, some minutes of a usual wheel, for which about 50 MB are needed."""
OVERLAP = 200
"""Number of pulses that blocks share on either side, after which the error of their ends is below 1e-6."""


@dataclass(frozen=True, eq=False)
class RotationBlock:
    """Rotation over a part of a record, to be used from ``start`` up to ``stop``, times in s."""

    rotation: WheelRotation
    start: float
    stop: float


def iter_wheel_rotations(
    channel: PulseChannel,
    wheel: Wheel,
    pattern: WheelPattern | None = None,
    *,
    index: PulseChannel | None = None,
    first: int | None = None,
    pulses_per_block: int = PULSES_PER_BLOCK,
) -> Iterator[RotationBlock]:
    """Yield the rotation of the reference shaft over parts of a record, which meet in time; angles go on across them.

    The first block tells tooth 0, as :func:`wheel_rotation` does for the whole; the others count on from it.

    Parameters
    ----------
    channel, wheel, pattern, index, first
        As of :func:`wheel_rotation`.
    pulses_per_block : int
        Number of pulses of a block, beside those that it shares with its neighbours.

    Examples
    --------
    >>> channel = PulseChannel("n1", np.arange(3000) / 600)
    >>> blocks = list(iter_wheel_rotations(channel, Wheel(teeth=60), pulses_per_block=1000))
    >>> [(round(one.start, 3), round(one.stop, 3)) for one in blocks]
    [(0.0, 1.667), (1.667, 3.333), (3.333, 4.998)]
    >>> [round(float(one.rotation.angle(np.array([one.stop]))[0] / (2 * np.pi)), 3) for one in blocks]
    [16.667, 33.333, 49.983]
    """
    times, begin, before = channel.times, 0, None
    start = float(times[0])
    while True:
        end = begin + pulses_per_block + (OVERLAP if before is None else 2 * OVERLAP)
        last = len(times) - end < pulses_per_block // 2
        part = replace(channel, times=times[begin : None if last else end])
        if before is None:
            found = wheel_rotation(part, wheel, pattern, index=index, first=first)
        else:
            number = int(before.numbers[np.searchsorted(before.times, times[begin])])
            counted = wheel_rotation(part, wheel, pattern, first=number % wheel.teeth)
            found = replace(counted, numbers=counted.numbers + (number - number % wheel.teeth), zero=before.zero)
        stop = float(found.times[-1] if last else found.times[-OVERLAP])
        yield RotationBlock(found, start, stop)
        if last:
            return
        start, before = stop, found
        begin = int(np.searchsorted(times, found.times[-2 * OVERLAP]))
