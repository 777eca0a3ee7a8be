"""Times of pulses from the counts of a clock, whose counter may wrap, or from time stamps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import AnyNumber, Value
from torsionnet.base.entries.spec import Count, OneOf, Text, entry
from torsionnet.base.errors import Fault, UsageError, comma_list
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.signals.encoder import HYSTERESIS
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.pulse_channel import PulseChannel

# Entries on what a channel of pulses holds: counts of a counter, of which clock, times, or the signal of teeth.

SIGNAL_ENTRIES = ("level", "hysteresis", "edge", "pickup", "second")
"""Entries of a reading that describe the signal of teeth, which a counter does not have."""

WIDEST_COUNTER = 64
"""Most bits of a counter of pulses; wider ones are not built."""


@dataclass(frozen=True, kw_only=True)
class PulseReading(Declared):
    """Reading of the values of a channel of pulses: counts of a clock, which may wrap, times, or the signal of teeth.

    Without ``tick`` and ``clock`` the values are times of pulses in the unit of the channel.

    Examples
    --------
    >>> PulseReading(clock="80 MHz", bits=32).seconds
    1.25e-08
    >>> PulseReading(tick="12.5 ns").seconds
    1.25e-08
    """

    kind: ClassVar[str] = "pulse reading"
    article: ClassVar[str] = "a pulse reading"

    tick: float | None = entry(Value("time of one count of the counter", "time", exclusive=True), None)
    clock: float | None = entry(Value("instead: frequency that the counter counts", "frequency", exclusive=True), None)
    bits: int | None = entry(
        Count("width of the counter in bits, which begins at 0 again when it is full", lower=4, upper=WIDEST_COUNTER),
        None,
    )

    level: float | None = entry(AnyNumber("value that a tooth signal passes, in its unit; default: the middle"), None)
    hysteresis: float = entry(
        Value("share of its height by which a tooth signal must pass on either side", "1", exclusive=True, below=0.5),
        HYSTERESIS,
    )
    edge: str = entry(OneOf("which flanks of a tooth signal are pulses", ("rising", "falling")), "rising")
    pickup: str = entry(
        OneOf("whether a tooth signal switches, or grows with the speed", ("switching", "inductive")), "switching"
    )
    second: str = entry(Text("channel of a second track a quarter pitch further, which tells the direction"), "")

    def contradictions(self) -> list[Fault]:
        if self.tick is not None and self.clock is not None:
            return [Fault("tick and clock say the same thing; leave one out", ("clock",), kind="contradicting-entries")]
        if self.bits is not None and self.tick is None and self.clock is None:
            return [
                Fault(
                    "a counter of so many bits needs the time of its tick, or its clock",
                    ("bits",),
                    kind="missing-entry",
                )
            ]
        if self.seconds is not None and self.is_of_a_signal:
            return [
                Fault(
                    "a counter has no level, hysteresis, edge, pickup or second track", ("tick",), kind="needless-entry"
                )
            ]
        return []

    @property
    def is_of_a_signal(self) -> bool:
        """Whether an entry is given that only the signal of teeth has, as its level."""
        return any(getattr(self, name) != self.defaults()[name] for name in SIGNAL_ENTRIES)

    @property
    def seconds(self) -> float | None:
        """Time of one count in s, None where the values are times."""
        return 1 / self.clock if self.clock is not None else self.tick


LARGEST_EXACT = 2.0**53
"""Largest whole number up to which a double tells every count from the next."""
USUAL_BITS = (16, 24, 32, 48, 64)
"""Widths in bits of common counters, of which the narrowest that fits is proposed."""
NEAR_WRAP = 0.5
"""Share of the time of one wrap from which on an interval between pulses is so long that the next may be longer than
a whole wrap."""
SAME_INTERVAL = 0.25
"""Relative difference of neighbouring intervals, up to which the second is the first with one more wrap in it; a speed
changes by less from pulse to pulse, and a wrap that is left out changes the interval by half or more."""
MOST_LISTED = 3
"""Number of pulses that a message lists at most, so that it stays short."""


def pulse_channel(name: str, values: ArrayLike, reading: PulseReading, factor: float = 1.0) -> PulseChannel:
    """Times of pulses in s, shape (n,), with name and remarks, from counts of a clock or from time stamps.

    Time 0 is where the counter stands at 0. A counter that begins at 0 again when it is full is unwrapped. That it
    wrapped more than once between two pulses cannot be told from the counts; it shows in the intervals around, where
    one is close to the time of a wrap and the next is far shorter, and is refused.

    Parameters
    ----------
    name : str
        Name of the channel.
    values : (n,) array
        Counts, or times of the pulses. Values that are no numbers at the end, as a column shorter than the others of
        a text file has, are left out.
    reading : PulseReading
        Tick or clock and width of the counter; without either, the values are times.
    factor : float
        s per unit of the times, where the values are times.

    Raises
    ------
    UsageError
        Counts that are no whole numbers or do not fit the counter, times that do not rise, or an interval that may
        be longer than a wrap.

    Examples
    --------
    >>> channel = pulse_channel("n1", [65000, 65300, 64, 364], PulseReading(tick="1 us", bits=16))
    >>> channel.times.round(9).tolist()
    [0.065, 0.0653, 0.0656, 0.0659]
    >>> channel.notes[1]
    'unwrapped: 1 wrap of 16 bits'
    """
    raw = _numbers(name, values)
    seconds = reading.seconds
    if seconds is None:
        return PulseChannel(name, _checked_rising(name, raw * factor), notes=("times of pulses as recorded",))
    counts, remarks = _unwrapped(name, _whole(name, raw), reading)
    kept, double = _without_equal(counts)
    return PulseChannel(name, kept * seconds, seconds, (_clock_note(reading, seconds), *remarks, *double))


def lowest_speed(reading: PulseReading, teeth: int) -> float:
    """Speed in rad/s of a wheel below which its pulses are further apart than one wrap of the counter.

    Below it the counts do not tell how often the counter has wrapped. It is 0 for a counter that does not wrap.

    Examples
    --------
    >>> slow = lowest_speed(PulseReading(clock="80 MHz", bits=16), teeth=60)
    >>> round(slow * 60 / (2 * np.pi), 1)
    1220.7
    """
    if reading.bits is None or reading.seconds is None:
        return 0.0
    return 2 * np.pi / (teeth * reading.seconds * 2.0**reading.bits)


def _numbers(name: str, values: ArrayLike) -> FloatArray:
    raw = np.asarray(values, dtype=np.float64).ravel()
    finite = np.isfinite(raw)
    known = np.flatnonzero(finite)
    last = int(known[-1]) + 1 if len(known) else 0
    if not last:
        raise UsageError(f"{name}: there are no pulses, none of its {len(raw)} values is a number", kind="lost-pulses")
    missing = np.flatnonzero(~finite[:last])
    if len(missing):
        places = comma_list([f"{place}" for place in missing], MOST_LISTED)
        raise UsageError(
            f"{name}: values among the pulses are no numbers, {len(missing)} of them: pulses {places}; mend the record",
            kind="not-a-number",
        )
    return raw[:last]


def _checked_rising(name: str, times: FloatArray) -> FloatArray:
    fall = np.flatnonzero(np.diff(times) <= 0)
    if len(fall):
        at = int(fall[0])
        raise UsageError(
            f"{name}: times of pulses have to rise, {times[at + 1]:.9g} s follows {times[at]:.9g} s at pulse {at + 1}; "
            "if the channel holds the counts of a clock, give its tick or clock and its bits; if it is the signal of "
            "the teeth itself, give its level",
            kind="unordered-rows",
        )
    return times


def _whole(name: str, raw: FloatArray) -> FloatArray:
    off = np.flatnonzero(raw != np.rint(raw))
    if len(off):
        raise UsageError(
            f"{name}: counts are whole numbers, pulse {off[0]} has {raw[off[0]]:.9g}; if these are times, leave tick, "
            "clock and bits out",
            kind="wrong-form",
        )
    if float(np.abs(raw).max()) > LARGEST_EXACT:
        raise UsageError(
            f"{name}: counts above 2^53, as {np.abs(raw).max():.6g}, are no longer exact; take the first count off "
            "all of them before export",
            kind="too-large",
        )
    return raw


def _unwrapped(name: str, counts: FloatArray, reading: PulseReading) -> tuple[FloatArray, list[NoteOrText]]:
    """Counts that no longer wrap, and remarks on the wraps."""
    if reading.bits is None:
        fall = np.flatnonzero(np.diff(counts) < 0)
        if len(fall):
            at, largest = int(fall[0]), float(counts.max())
            likely = next(bits for bits in USUAL_BITS if largest < 2.0**bits)
            raise UsageError(
                f"{name}: the count falls from {counts[at]:.0f} to {counts[at + 1]:.0f} after pulse {at}, as that of a "
                f"counter that is full and begins again; give its bits ({likely} if it wraps at {2**likely})",
                kind="wrapped-count",
            )
        return counts, []
    span = 2.0**reading.bits
    remarks = list[NoteOrText]()
    # Two's complement: a counter of n bits that was read with a sign shows its upper half as count - 2^n.
    if (counts < 0).any() and float(counts.min()) >= -span / 2 and float(counts.max()) < span / 2:
        remarks.append(f"counts from {counts.min():.0f}: read as numbers of {reading.bits} bits without a sign")
        counts = np.where(counts < 0, counts + span, counts)
    beyond = np.flatnonzero((counts < 0) | (counts >= span))
    if len(beyond):
        raise UsageError(
            f"{name}: a counter of {reading.bits} bits counts from 0 to {span - 1:.0f}, pulse {beyond[0]} has "
            f"{counts[beyond[0]]:.0f}; correct bits",
            kind="contradicting-values",
        )
    # A fall is one wrap of 2^n counts; that there were more cannot be seen from the counts.
    steps = np.diff(counts)
    wraps = steps < 0
    steps = np.where(wraps, steps + span, steps)
    _check_wraps(name, steps, span, reading)
    unwrapped = counts[0] + np.concatenate([[0.0], np.cumsum(steps)])
    total = int(np.count_nonzero(wraps))
    remarks.append(f"unwrapped: {total} wrap{'s' * (total != 1)} of {reading.bits} bits")
    seconds = reading.seconds
    assert seconds is not None
    longest = float(steps.max()) * seconds if len(steps) else 0.0
    limit = f"pulses more than {span * seconds:.4g} s apart cannot be told from closer ones"
    limit += f": below {1 / (span * seconds):.4g} pulses a second"
    is_near = longest > NEAR_WRAP * span * seconds
    remarks.append(warning(f"{limit}; the longest interval is {longest:.4g} s") if is_near else limit)
    return unwrapped, remarks


def _check_wraps(name: str, steps: FloatArray, span: float, reading: PulseReading) -> None:
    """Raise an error where an interval fits those around it only with a whole wrap more than was counted."""
    before, after = steps[:-1], steps[1:]
    # A double pulse makes one interval short, and the next is as long as ever; a speed too low keeps them short.
    beyond, earlier = np.append(steps[2:], 0.0), np.insert(steps[:-2], 0, 0.0)
    # Of a shaft that slows down the later interval lacks a wrap, of one that speeds up the earlier.
    slower = (np.abs(after + span - before) < SAME_INTERVAL * before) & (beyond < NEAR_WRAP * before)
    faster = (np.abs(before + span - after) < SAME_INTERVAL * after) & (earlier < NEAR_WRAP * after)
    at = np.flatnonzero((before > NEAR_WRAP * span) & slower | (after > NEAR_WRAP * span) & faster)
    if not len(at):
        return
    pulse, seconds = int(at[0]) + 1, reading.seconds
    assert seconds is not None
    raise UsageError(
        f"{name}: around pulse {pulse} the interval jumps from {before[at[0]] * seconds:.4g} to "
        f"{after[at[0]] * seconds:.4g} s: the counter of {reading.bits} bits wraps after {span * seconds:.4g} s, and "
        f"has wrapped more often than its counts show; cut the record where it has more than "
        f"{1 / (span * seconds):.4g} pulses a second, or take a wider counter or a slower clock",
        kind="wrapped-count",
    )


def _without_equal(counts: FloatArray) -> tuple[FloatArray, tuple[NoteOrText, ...]]:
    """Counts without those equal to the one before, and a remark that counts these."""
    equal = np.flatnonzero(np.diff(counts) == 0) + 1
    if not len(equal):
        return counts, ()
    where = comma_list([f"pulse {place}" for place in equal], MOST_LISTED)
    kept: Any = np.delete(counts, equal)
    text = f"{len(equal)} pulse{'s' * (len(equal) > 1)} at the count of the one before left out: {where}"
    return kept, (warning(text),)


def _clock_note(reading: PulseReading, seconds: float) -> str:
    clock = f"a clock of {reading.clock:.9g} Hz" if reading.clock is not None else f"ticks of {seconds:.9g} s"
    return f"times from the counts of {clock}, 0 where the counter stands at 0"
