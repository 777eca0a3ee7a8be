"""Channel of a record with the pulses of a wheel: its wheel, how the channel is read, and the pulses it holds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from torsionnet.base.entries.spec import Text, entry
from torsionnet.base.errors import Fault, UsageError, did_you_mean
from torsionnet.signals.encoder import HIGH_PERCENTILE, LOW_PERCENTILE, flanks, holds_pulse_times
from torsionnet.signals.rotation.counter import PulseReading
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.quadrature import quadrature_pulses
from torsionnet.signals.rotation.wheel import Wheel

if TYPE_CHECKING:
    from torsionnet.signals.recording import FloatArray, Recording

HEIGHT_PARTS, LEAST_EVEN_HEIGHT = 10, 0.6
"""Number of parts of a record whose heights are compared, and least ratio of the smallest to the largest of a signal
that switches; below it, its hysteresis loses pulses."""


@dataclass(frozen=True, kw_only=True)
class WheelChannel(PulseReading, Wheel):
    """A channel of pulses: the wheel that it sees, and how its values are read.

    Examples
    --------
    >>> channel = WheelChannel(teeth=60, missing_teeth=2, tick="12.5 ns", bits=32)
    >>> channel.missing_teeth, channel.seconds
    (2, 1.25e-08)
    """

    kind: ClassVar[str] = "wheel channel"
    article: ClassVar[str] = "a wheel"
    form: ClassVar[str] = "{teeth: 60, ...}"

    index: str = entry(Text("channel of an index pulse, once in a turn of the wheel or in several"), "")

    def contradictions(self) -> list[Fault]:
        return [*PulseReading.contradictions(self), *Wheel.contradictions(self)]


def wheel_pulses(recording: Recording, name: str, reading: PulseReading) -> PulseChannel:
    """Pulses of a channel of a record, from its pulse times or from the signal of the teeth, times in s.

    With a second track the pulses have a direction.

    Raises
    ------
    UsageError
        There is no such channel, or it holds no pulses.

    Examples
    --------
    >>> from torsionnet.signals.recording import Recording, Signal
    >>> teeth = np.sin(2 * np.pi * 50 * np.arange(1000) / 10e3)
    >>> record = Recording((Signal("n1", "", teeth),), sampling_rate=10e3)
    >>> len(wheel_pulses(record, "n1", PulseReading(level=0.5)))
    5
    """
    stored = {channel.name: channel for channel in recording.pulses}
    if name in stored:
        if reading.second:
            raise UsageError(
                f"{name}: the record holds times of its pulses, and {reading.second} tells the direction only where "
                "both tracks were sampled: of times the flank that falls is missing; leave second out, and cut the "
                "record where the shaft turns back",
                kind="missing-data",
            )
        return stored[name]
    if name not in recording.names:
        known = [*stored, *recording.names]
        hint = did_you_mean(name, known)
        raise UsageError(
            f'no channel is named "{name}"{hint}; there is {", ".join(known) or "none"}', kind="unknown-channel"
        )
    values, times = recording[name].values, recording.time
    if not reading.is_of_a_signal and holds_pulse_times(values):
        return PulseChannel(name, values, notes=("times of pulses as recorded",))
    first = _flanks(name, values, times, reading)
    spacing = float((times[-1] - times[0]) / max(len(times) - 1, 1))
    if reading.pickup == "switching":
        _refuse_growing(name, values)
    note = f"flanks of a tooth signal sampled every {spacing:.4g} s, {reading.edge}"
    if reading.second:
        second = _flanks(reading.second, recording[reading.second].values, times, reading)
        return quadrature_pulses(name, first, second, edge=reading.edge, notes=(f"{note}; {reading.second} beside it",))
    return PulseChannel(name, first[1 if reading.edge == "falling" else 0], notes=(note,))


def _flanks(name: str, values: FloatArray, times: FloatArray, reading: PulseReading) -> tuple[FloatArray, FloatArray]:
    try:
        return flanks(
            values, times, level=reading.level, hysteresis=reading.hysteresis,
            pickup="inductive" if reading.pickup == "inductive" else "switching",
        )  # fmt: skip
    except UsageError as error:
        raise UsageError(f"{name}: {error}", kind=error.kind) from None


def _refuse_growing(name: str, values: FloatArray) -> None:
    """Refuse a signal without direct component whose height changes along the record, read as one that switches."""
    parts = [part for part in np.array_split(values, HEIGHT_PARTS) if len(part)]
    heights = [float(np.ptp(np.percentile(part, [LOW_PERCENTILE, HIGH_PERCENTILE]))) for part in parts]
    if min(heights) < LEAST_EVEN_HEIGHT * max(heights):
        raise UsageError(
            f"{name}: the signal of the teeth is between {min(heights):.3g} and {max(heights):.3g} high along the "
            "record, as that of an inductive pickup, which grows with the speed: read it as such (pickup: inductive), "
            "or cut the record to where the shaft turns",
            kind="disturbed-signal",
        )


def counted_reading(reading: PulseReading) -> PulseReading:
    """Reading of the counts or times of a channel alone, without the entries of a wheel."""
    return PulseReading(**{name: getattr(reading, name) for name in ("tick", "clock", "bits")})
