"""Pulses of a wheel as a counter records them: lost and double ones, jitter, the clock and its tick."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.bench.plan.toothed_wheel import ToothedWheel
from torsionnet.bench.true_fault import TrueFault
from torsionnet.bench.wheel_turning import GeneratorFor
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.pulse_channel import PulseChannel

NEAREST_DOUBLE, FARTHEST_DOUBLE = 0.1, 0.4
"""Place of a second pulse behind its tooth, as a share of the time to the next one: less than half of it, so that it
can be told from a tooth."""


@dataclass(frozen=True, eq=False)
class CountedPulses:
    """Pulses as recorded, and what is wrong with them.

    Attributes
    ----------
    channel : PulseChannel
    numbers : (n,) int array
        True number of the tooth of each pulse; a second pulse has that of its tooth.
    faults : tuple of TrueFault
    """

    channel: PulseChannel
    numbers: NDArray[np.intp]
    faults: tuple[TrueFault, ...]


def counted_pulses(
    name: str,
    times: FloatArray,
    numbers: NDArray[np.intp],
    pickup: ToothedWheel,
    generator: GeneratorFor,
    shown: Callable[[FloatArray], FloatArray],
) -> CountedPulses:
    """Pulses that a counter records of teeth that pass a pickup at times in s.

    ``shown`` gives the time on the clock of the system that records them, which begins at 0.
    """
    faults: list[TrueFault] = []
    late = times + pickup.jitter * generator("jitter").standard_normal(len(times)) if pickup.jitter else times
    kept = np.ones(len(times), dtype=bool)
    if pickup.missing_pulses:
        kept = generator("missing").random(len(times)) >= pickup.missing_pulses
        faults += [
            TrueFault(name, "missing pulse", float(times[at]), float(numbers[at])) for at in np.flatnonzero(~kept)
        ]
    stamps, teeth = late[kept], numbers[kept]
    if pickup.double_pulses and len(times) > 1:
        chance = generator("double")
        doubled = (chance.random(len(times)) < pickup.double_pulses) & kept
        share = chance.uniform(NEAREST_DOUBLE, FARTHEST_DOUBLE, len(times))
        gaps = np.diff(times, append=2 * times[-1] - times[-2]) / np.diff(numbers, append=numbers[-1] + 1)
        second = (late + share * gaps)[doubled]
        faults += [TrueFault(name, "double pulse", time, float(tooth))
                   for time, tooth in zip(second.tolist(), numbers[doubled].tolist(), strict=True)]  # fmt: skip
        stamps, teeth = np.concatenate([stamps, second]), np.concatenate([teeth, numbers[doubled]])
    order = np.argsort(stamps, kind="stable")
    stamps, teeth = shown(stamps[order]), teeth[order]
    stamps, teeth = stamps[stamps >= 0], teeth[stamps >= 0]
    if pickup.tick:
        stamps = pickup.tick * np.floor(stamps / pickup.tick)
    apart = np.diff(stamps, prepend=-np.inf) > 0
    notes = [f"{len(stamps) - int(apart.sum())} pulses within one tick of the one before are not recorded"]
    channel = PulseChannel(name, stamps[apart], pickup.tick, () if apart.all() else tuple(notes))
    return CountedPulses(channel, teeth[apart], tuple(faults))
