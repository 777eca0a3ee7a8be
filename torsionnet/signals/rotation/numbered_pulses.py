"""Pulses of a toothed wheel with the tooth of each, by the gap of the wheel or by an index pulse."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.core.errors import UsageError
from torsionnet.response.measured.pulse_channel import PulseChannel
from torsionnet.response.recording import FloatArray
from torsionnet.signals.pulses import Pulses, repaired_pulses
from torsionnet.signals.rotation.wheel import Wheel

AFTER_GAP = "the first after the gap"
AFTER_INDEX = "the first after the pulse of {name}"
FIRST_OF_RECORD = "that of the first pulse of {name}: valid within that record only"


@dataclass(frozen=True, eq=False)
class NumberedPulses:
    """Pulses of a toothed wheel, repaired, with a number for each that counts its teeth on from turn to turn.

    Attributes
    ----------
    times : (n,) array
        s.
    numbers : (n,) int array
        Tooth of each pulse, as ``numbers % teeth``, missing and lost ones counted.
    first : str
        Which tooth is 0, in words.
    known : bool
        Whether another record of the wheel has the same tooth 0.
    remarks : tuple of str
        Repairs, with their counts.
    """

    times: FloatArray
    numbers: NDArray[np.intp]
    first: str
    known: bool
    remarks: tuple[str, ...] = ()


def numbered_pulses(channel: PulseChannel, wheel: Wheel, index: PulseChannel | None = None) -> NumberedPulses:
    """Pulses of a wheel with their teeth; tooth 0 is the first after the gap, or after an index pulse.

    Without either it is that of the first pulse, which is another one in each record.

    Raises
    ------
    UsageError
        Pulses that cannot be repaired, no gap where the wheel has one, or index pulses that do not return each turn.

    Examples
    --------
    >>> pulses = numbered_pulses(PulseChannel("wheel", np.arange(40) / 100), Wheel(teeth=8))
    >>> pulses.numbers[-1].item(), pulses.first
    (39, 'that of the first pulse of wheel: valid within that record only')
    """
    try:
        found = repaired_pulses(channel.times, wheel.teeth if wheel.missing_teeth else 0)
    except UsageError as error:
        raise UsageError(f"{channel.name}: {error}") from None
    remarks = tuple(f"{channel.name}: {text}" for text in found.remarks)
    if wheel.missing_teeth:
        shift, first = _after_gap(channel.name, found, wheel), AFTER_GAP
    elif index is not None:
        shift, first = _after_index(channel.name, found, wheel, index), AFTER_INDEX.format(name=index.name)
    else:
        return NumberedPulses(found.times, found.numbers, FIRST_OF_RECORD.format(name=channel.name), False, remarks)
    return NumberedPulses(found.times, found.numbers - shift + wheel.teeth, first, True, remarks)


def _after_gap(name: str, found: Pulses, wheel: Wheel) -> int:
    """Number, below ``teeth``, of the first tooth after the gap."""
    gaps = found.missing.counts == wheel.missing_teeth
    places = (found.numbers[found.missing.after[gaps]] + 1 + wheel.missing_teeth) % wheel.teeth
    phases, often = np.unique(places, return_counts=True)
    turns = (found.numbers[-1] - found.numbers[0]) // wheel.teeth
    if not len(phases) or often.max() < turns / 2:
        raise UsageError(
            f"{name}: no gap of {wheel.missing_teeth} teeth that returns every {wheel.teeth} pulses; check the number "
            "of teeth, missing ones included, and of missing teeth"
        )
    if (often == often.max()).sum() > 1:
        raise UsageError(
            f"{name}: {(often == often.max()).sum()} gaps return each turn; which is the wheel's is not told"
        )
    return int(phases[often.argmax()])


def _after_index(name: str, found: Pulses, wheel: Wheel, index: PulseChannel) -> int:
    """Number, below ``teeth``, of the first tooth after the index pulse."""
    inside = index.times[(index.times > found.times[0]) & (index.times <= found.times[-1])]
    places = found.numbers[np.searchsorted(found.times, inside)] % wheel.teeth
    if not len(places):
        raise UsageError(f"{index.name} has no pulse while {name} turns: it cannot tell which tooth is the first")
    phases, often = np.unique(places, return_counts=True)
    if len(phases) > 1:
        text = ", ".join(f"{count} before tooth {phase}" for phase, count in zip(phases, often, strict=True))
        raise UsageError(
            f"{index.name} does not fall before the same tooth of {name} in each turn ({text}, counted from its first "
            f"pulse): the wheel has not {wheel.teeth} teeth, pulses are lost, or the index falls on an edge; move it "
            "by half a pitch"
        )
    return int(phases[0])
