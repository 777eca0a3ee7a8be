"""Clock of a block of samples (sampling rate in Hz, start in s, or time stamps in s where they are not uniform)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import UTC, date, datetime, time, timedelta

import numpy as np

from torsionnet.base.delimited.number_rows import MOST_FAULTS
from torsionnet.base.errors import Fault
from torsionnet.base.notes import Note, warning
from torsionnet.base.remedies import remedy
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.records.rounded_times import rounded_grid
from torsionnet.signals.records.source import FileChannel, Source

UNIFORM_TOLERANCE = 0.01
"""Share of a sampling interval by which uniform time stamps may be off, as rounded decimals are."""
EXACT_TIMES = 4 * float(np.finfo(float).eps)
"""Share of their span by which even time stamps are off because of the arithmetic alone."""
SAME_RATE_TOLERANCE = 1e-3
"""Relative difference up to which a given sampling rate agrees with the time stamps, which may be rounded."""
SAME_INTERVAL_TOLERANCE = 5e-3
"""Relative difference up to which an interval in a header, perhaps of few digits, agrees with the time stamps."""
FEWEST_EQUAL_STAMPS, EQUAL_STAMPS_SHARE = 3, 0.01
"""Number of time stamps equal to the one before, and their share of all, from which they are no slip of a recorder."""
LATEST_TIME = 1e15
"""Largest time stamp in s, thirty million years, as larger ones are damage, in whatever unit a clock counted."""

UNUSUAL_RATE, USUAL_RATE, UNUSUAL_LENGTH = 20.0, 200.0, 3600.0
"""Sampling rates in Hz below which torsional vibration is never, or not for longer than these s, recorded."""


@dataclass(frozen=True)
class Clock:
    """Sampling rate in Hz, start in s, and time stamps (n,) in s of a block where they are not uniform.

    ``note`` says that rounded time stamps were taken for uniform ones.
    """

    rate: float
    start: float
    times: FloatArray | None = None
    note: str = ""


@dataclass(frozen=True)
class DayNumbers:
    """Numbers of days by which a program tells times, with the day ``origin`` of number 0, and the years it is for.

    In s such times would be sampled at more than ``least_rate`` Hz.
    """

    name: str
    origin: date
    shift: int
    least_rate: float

    def holds(self, stamps: FloatArray) -> bool:
        """Whether time stamps (n,) without a unit are such numbers of this century or the last."""
        least, most = (self.number(year) for year in (1970, 2100))
        span = float(stamps[-1] - stamps[0]) if len(stamps) > 1 else 0.0
        return least <= stamps[0] <= most and 0 < span * self.least_rate < len(stamps) - 1

    def number(self, year: int) -> int:
        """Number of the first day of a year."""
        return (date(year, 1, 1) - self.origin).days + self.shift

    def text(self, stamp: float) -> str:
        """Date and time of a number of days, to the millisecond."""
        day = datetime.combine(self.origin, time(), UTC) + timedelta(days=stamp - self.shift)
        return (day + timedelta(microseconds=500)).strftime("%Y-%m-%d %H:%M:%S.%f")[:-3]


DAY_NUMBERS = (
    DayNumbers("datenum of Matlab", date(1, 1, 1), 367, 1e5),
    DayNumbers("serial numbers of a spreadsheet", date(1899, 12, 30), 0, 1e6),
)
"""Numbers of days that are known by their size: in s they would be sampled at rates of no recorder of vibration."""


def clock_in_days(clock: FileChannel, stamps: FloatArray) -> tuple[FileChannel, str]:
    """Channel of time stamps (n,) with the unit of days where it has none and they are numbers of days, and a note."""
    kind = next((known for known in DAY_NUMBERS if known.holds(stamps)), None) if clock.unit in ("", "d") else None
    if kind is None:
        return clock, ""
    zero, taken = float(stamps[0]), "" if clock.unit else " has no unit and was taken for days;"
    note = f"{clock.name}{taken} counts from {kind.text(zero)} ({kind.name})"
    return replace(clock, unit="d", zero=zero), note


def value_faults(stamps: FloatArray, source: Source, first: int = 0) -> list[Fault]:
    """Faults of time stamps (n,) in s that are not finite or impossibly late, each with its position in the file."""
    assert source.time is not None
    column = source.time.name
    broken = np.flatnonzero(~np.isfinite(stamps))
    texts = {int(row): f"sample {first + row + 1} has no time stamp in {column}" for row in broken[:MOST_FAULTS]}
    beyond = np.flatnonzero(np.abs(stamps) > LATEST_TIME)
    texts |= {
        int(row): f"{column} has the time {stamps[row]:g} s, and no recording is that late; give its unit"
        for row in beyond[:1]
    }
    return [_fault(text, source, first + row) for row, text in texts.items()]


def order_faults(stamps: FloatArray, source: Source, first: int = 0) -> list[Fault]:
    """Faults of time stamps (n,) in s that do not increase, each with its position in the file."""
    assert source.time is not None
    column, texts = source.time.name, dict[int, str]()
    if is_coarse(stamps):
        return [_fault(_coarse_text(stamps, column), source, first + int(np.argmax(np.diff(stamps) == 0)) + 1)]
    for row in np.flatnonzero(np.diff(stamps) <= 0)[:MOST_FAULTS]:
        text = f"the time stamp {stamps[row + 1]:.9g} s follows {stamps[row]:.9g} s in {column}: time has to increase"
        text += "; where it begins again, save each record in a file of its own" if stamps[row + 1] <= stamps[0] else ""
        texts[int(row) + 1] = text
    return [_fault(text, source, first + row) for row, text in texts.items()]


def is_coarse(stamps: FloatArray) -> bool:
    """Whether time stamps never decrease and many are equal, being written in coarser steps than samples were taken."""
    steps = np.diff(stamps)
    return bool(
        np.all(steps >= 0) and np.count_nonzero(steps == 0) >= max(FEWEST_EQUAL_STAMPS, EQUAL_STAMPS_SHARE * len(steps))
    )


def _coarse_text(stamps: FloatArray, column: str) -> str:
    steps = np.diff(stamps)
    written = f"they are written in steps of {steps[steps > 0].min():.3g} s, " if steps.any() else ""
    text = f"{np.count_nonzero(steps == 0)} of {len(stamps)} time stamps in {column} equal the one before: {written}"
    return (
        f"{text}too coarse for the sampling; export them with more decimals, or give {remedy('sampling_rate=')} in Hz"
    )


def coarse_clock(stamps: FloatArray, rate: float, begin: float) -> Clock | Fault:
    """Clock of coarse time stamps (n,) in s for a sampling rate in Hz, or the fault that the two do not agree."""
    steps = np.diff(stamps)
    off = stamps - np.arange(len(stamps)) / rate
    if np.ptp(off) <= (1 + UNIFORM_TOLERANCE) * float(steps.max()):
        return Clock(rate, begin)
    return Fault(
        f"the time stamps do not fit samples at {rate:g} Hz; correct {remedy('sampling_rate=')}, or leave it out"
    )


def _fault(text: str, source: Source, row: int) -> Fault:
    assert source.time is not None
    return Fault(text, ("channels", source.time.name), position=source.place(int(row)))


def clock_of(stamps: FloatArray, rate: float | None, *, stamped: bool = False, scale: float = 1.0) -> Clock:
    """Clock (sampling rate in Hz, start in s, or all stamps) from time stamps (n,) in units of ``scale`` s.

    A known ``rate`` in Hz is kept where it agrees with them.

    >>> clock_of(np.array([1.0, 1.1, 1.2]), None).rate.__round__(9)
    10.0
    """
    times = np.asarray(stamps * scale)
    span = float(times[-1] - times[0]) if len(times) else 0.0
    start = float(times[0]) if len(times) else 0.0
    if len(times) < 2:
        return Clock(rate or 1.0, start)
    mean = (len(times) - 1) / span if span > 0 else 1.0
    if stamped or not span > 0:
        return Clock(rate or mean, start, times)
    even = start + np.arange(len(times)) / mean
    off = float(np.max(np.abs(times - even)))
    is_uniform = off * mean <= UNIFORM_TOLERANCE
    # Stamps that are even to the last bit were not rounded, such as whole multiples of 3 s.
    is_exact = off <= EXACT_TIMES * span
    grid = None if is_exact or (is_uniform and _rounded(mean) != mean) else rounded_grid(stamps, scale)
    if not is_uniform and grid is None:
        return Clock(rate or mean, start, times)
    known = rate if rate and abs(rate / mean - 1) < SAME_RATE_TOLERANCE else grid.rate if grid else _rounded(mean)
    if is_uniform or grid is None:
        return Clock(known, start)
    text = f"the time stamps are rounded ({grid.digits}) and were taken for uniform sampling at {grid.rate:.10g} Hz"
    return Clock(known, grid.start, note=text)


def _rounded(rate: float) -> float:
    """Sampling rate in Hz without the rounding errors of the time stamps it comes from."""
    plain = float(f"{rate:.7g}")
    return plain if abs(plain / rate - 1) < 1e-9 else rate


def time_unit_warnings(stamps: FloatArray, source: Source) -> tuple[Note, ...]:
    """Warning where time stamps without unit make a recording unusually slow or long, as ms taken for s do."""
    if source.time is None or source.time.unit or len(stamps) < 2:
        return ()
    span = float(stamps[-1] - stamps[0])
    rate = (len(stamps) - 1) / span
    if rate >= USUAL_RATE or (rate >= UNUSUAL_RATE and span <= UNUSUAL_LENGTH):
        return ()
    name = source.time.name
    text = f"{name} has no unit and was taken for s: sampled at {rate:.3g} Hz for {span:.6g} s"
    return (warning(f"{text}; if it is in ms, or counts ticks, give its unit"),)


def rate_fault(stamps: FloatArray, given: float | None) -> list[Fault]:
    """Fault of a given sampling rate in Hz that differs from that of the time stamps; empty where they agree."""
    if given is None or len(stamps) < 2:
        return []
    mean = (len(stamps) - 1) / float(stamps[-1] - stamps[0])
    if abs(given / mean - 1) < SAME_RATE_TOLERANCE:
        return []
    said = remedy("sampling_rate=", f"{given:g}")
    return [Fault(f"the time stamps say {mean:.6g} Hz, {said} was given; leave it out to use them")]


def interval_fault(stamps: FloatArray, source: Source) -> list[Fault]:
    """Fault of a sampling interval in the header that differs from that of the time stamps; empty where they agree."""
    stated = source.stated
    if stated is None or source.time is None or len(stamps) < 2:
        return []
    span, count = float(stamps[-1] - stamps[0]), len(stamps) - 1
    if abs(span - count * stated.seconds) <= max(SAME_INTERVAL_TOLERANCE * span, stated.seconds / 2):
        return []
    text = f"{stated.name} says {stated.seconds:g} s between samples, {source.time.name} goes in steps of "
    text += f"{span / count:.6g} s; correct the wrong one, or give {remedy('sampling_rate=')} in Hz if "
    text += f"{source.time.name} is right"
    return [Fault(text, position=stated.position)]
