"""Drift and offset between the clocks of two measuring systems, and records brought from one clock to the other.

A time t of the first clock is offset + (1 + drift) t on the second. At 1500 rpm, 50 ppm are 162 degrees of order 6
after 60 s, and 0.1 ms are 5.4 degrees.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import NoteOrText
from torsionnet.signals.recording import FloatArray, Recording
from torsionnet.signals.resampling import interpolated_at

HALF_WIDTH_DEVIATIONS = 1.96
"""Half width of the 95 % interval of a normal variable over its standard deviation."""
COMMON = (
    "record one rotation or one signal on both systems, best a pulse per turn, and start them together or change the "
    "speed during the record"
)
"""Advice on what makes the clocks of two systems comparable."""
MOST_DRIFT = 2e-3
"""Largest drift between two clocks that is looked for; quartz clocks differ by 1e-4 or less."""
MOVED = "on the clock of the first system"
"""Note on what was brought from the clock of a second system to that of the first."""


@dataclass(frozen=True)
class ClockDrift:
    """Drift of a second clock against a first, and its offset in s, with half widths of their 95 % intervals.

    Attributes
    ----------
    drift : float
        Seconds that the second clock gains per second of the first; 50e-6 are 50 ppm.
    drift_half_width : float
    offset : float
        Time in s of the second clock at time 0 of the first.
    offset_half_width : float
        s; infinite where nothing tells the offset.
    period : float
        Time in s by whole multiples of which the offset is open: that of a turn at steady speed, or of a periodic
        signal; 0 where it is not.
    remarks : tuple of str
        From what they were found, and what stays open.
    """

    drift: float
    drift_half_width: float
    offset: float
    offset_half_width: float
    period: float = 0.0
    remarks: tuple[NoteOrText, ...] = ()

    def to_first(self, times: FloatArray) -> FloatArray:
        """Times in s on the first clock of times in s on the second, shape (n,)."""
        return np.asarray((np.asarray(times, dtype=float) - self.offset) / (1 + self.drift))

    def to_second(self, times: FloatArray) -> FloatArray:
        """Times in s on the second clock of times in s on the first, shape (n,)."""
        return np.asarray(self.offset + (1 + self.drift) * np.asarray(times, dtype=float))


def variance_factor(left: FloatArray) -> float:
    """Factor on the variance of means of errors that follow each other alike, by their correlation to the next."""
    power = float(np.sum(left**2))
    share = float(np.sum(left[1:] * left[:-1])) / power if power else 0.0
    share = min(max(share, 0.0), 0.95)
    return (1 + share) / (1 - share)


def on_first_clock(recording: Recording, clocks: ClockDrift, like: Recording | None = None) -> Recording:
    """Recording of the second system with its times in s on the clock of the first, and a note that counts them.

    With ``like``, a record of the first system, its signals are interpolated, band-limited, at the samples of that
    one as far as they reach; else they keep their samples, whose rate is then that on the first clock.

    Examples
    --------
    >>> from torsionnet.signals.recording import Signal
    >>> record = Recording((Signal("T", "torque", np.zeros(10)),), sampling_rate=1000.0, start=0.5)
    >>> moved = on_first_clock(record, ClockDrift(50e-6, 0.0, 0.5, 0.0))
    >>> round(moved.sampling_rate, 6), moved.start
    (1000.05, 0.0)
    """
    times = None if recording.times is None else clocks.to_first(recording.times)
    start = float(clocks.to_first(np.array([recording.start]))[0])
    pulses = tuple(
        replace(
            channel, times=clocks.to_first(channel.times), notes=(*channel.notes, "on the clock of the first system")
        )
        for channel in recording.pulses
    )
    counted = f"{len(recording)} samples" if recording.signals else ""
    counted = ", ".join(filter(None, [counted, *(f"{len(one)} pulses of {one.name}" for one in pulses)]))
    note = f"{MOVED}, by {1e6 * clocks.drift:.4g} ppm and {clocks.offset:.6g} s: {counted}"
    rate = recording.sampling_rate * (1 + clocks.drift)
    moved = replace(recording, sampling_rate=rate, start=start, times=times, pulses=pulses)
    moved = moved.with_notes(note, *clocks.remarks)
    if like is None or not recording.signals:
        return moved
    if times is not None:
        raise UsageError("signals with uneven time stamps cannot be brought to another clock; resample them first")
    inside = (like.time >= start) & (like.time <= start + (len(recording) - 1) / rate)
    if not inside.any():
        raise UsageError(f"the two records have no time in common on one clock; {COMMON}")
    even = like.time[inside]
    signals = tuple(
        replace(one, values=interpolated_at(one.values, rate, start, even, like.sampling_rate)) for one in recording
    )
    return replace(moved, signals=signals, sampling_rate=like.sampling_rate, start=float(even[0])).with_notes(
        f"{len(even)} samples interpolated at those of the first system"
    )
