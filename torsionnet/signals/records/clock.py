"""Clock of a block of samples (sampling rate in Hz, start in s, or time stamps in s where they are not uniform)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import UTC, date, datetime, time, timedelta

import numpy as np

from torsionnet.base.delimited.number_rows import MOST_FAULTS
from torsionnet.base.errors import Fault, remedy
from torsionnet.base.notes import Note, warning
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.records.source import FileChannel, Source

# Uniform grid of samples whose time stamps were rounded to some digits, so that their intervals only seem to vary.

MOST_DIGITS = 13
"""Most decimals or significant digits that are looked for in time stamps, as double precision has few more."""
PLAIN_DIGITS = 4
"""Most digits of a plain sampling rate or interval, as 25.6 kHz and 0.2 ms have, which are preferred to others."""
LOOKED_AT = 64
"""Number of time stamps whose digits are looked at first, as those of all take long."""
MOST_STEPS = 60
"""Most steps to an end of the intervals that rounded time stamps allow; each takes a corner of a polygon away."""


@dataclass(frozen=True)
class RoundedGrid:
    """Uniform grid (rate in Hz, start in s) that gives time stamps when rounded to ``digits``, as these words say."""

    rate: float
    start: float
    digits: str


def rounded_grid(stamps: FloatArray, scale: float = 1.0) -> RoundedGrid | None:
    """Uniform grid within half a unit of the last digit of all time stamps (n,), or None where there is none.

    ``stamps`` are as the file has them, in units of ``scale`` s. Of the rates that fit, that of the fewest digits is
    taken; a real jitter or drift of more than half a unit fits none. Stamps may be equal where others, as the first
    ones of single precision, are finer than the sampling.

    >>> grid = rounded_grid(np.round(np.arange(20) / 25.6e3, 6))
    >>> grid.rate, grid.start, grid.digits
    (25600.0, 0.0, '6 decimals')
    """
    last = len(stamps) - 1
    if last < 1 or not stamps[-1] > stamps[0]:
        return None
    # Which way a tie was rounded hangs on the last bit of a number.
    slack = np.finfo(float).eps * float(np.max(np.abs(stamps)))
    for digits, written, half in _roundings(stamps):
        away = written - stamps[0]
        low, high = away - half - slack, away + half + slack
        least, most = (float(low[-1] - high[0]) / last, float(high[-1] - low[0]) / last)
        ends = _extreme_interval(low, high, least, 1), _extreme_interval(low, high, most, -1)
        if ends[0] is None or ends[1] is None or not 0 < ends[0] <= ends[1]:
            continue
        if 2.01 * float(np.min(half)) > ends[1] and not np.all(np.diff(stamps) > 0):
            continue
        rate = _plainest(low, high, (ends[0], ends[1]), scale)
        lines = np.arange(last + 1) / (rate * scale)
        start = float(np.clip(0.0, np.max(low - lines), np.min(high - lines)))
        return RoundedGrid(rate, float(stamps[0] + start) * scale, digits)
    return None


LEAST_POWER = -290
"""Power of ten of the smallest time stamps whose digits are looked at."""


def _roundings(stamps: FloatArray) -> Iterator[tuple[str, FloatArray, FloatArray]]:
    """Yield the roundings that time stamps show: words, the stamps so rounded, and half a unit of the last digit."""
    few = stamps[:: max(1, len(stamps) // LOOKED_AT)]
    for digits in range(MOST_DIGITS):
        if all(_are_whole(some * 10.0**digits) for some in (few, stamps)):
            words = f"{digits} decimal{'s' * (digits > 1)}" if digits else "whole numbers"
            yield words, stamps, np.full(len(stamps), 0.5 * 10.0**-digits)
            break
    with np.errstate(over="ignore"):
        single = stamps.astype(np.float32)
    # The shortest text of a number in single precision is another number in double precision.
    if np.array_equal(single, stamps) or all(float(str(np.float32(value))) == value for value in few):
        yield "single precision", single.astype(float), 0.5 * np.spacing(np.abs(single)).astype(float)
    for digits in range(2, MOST_DIGITS):
        if all(_are_whole(some / _unit(some, digits)) for some in (few, stamps)):
            yield f"{digits} significant digits", stamps, 0.5 * _unit(stamps, digits)
            break
    yield "double precision", stamps, 0.5 * np.spacing(np.abs(stamps))


def _are_whole(counts: FloatArray) -> bool:
    """Whether time stamps in units of a digit are whole numbers, and not only for want of further digits."""
    doubt = 4 * np.finfo(float).eps * float(np.max(np.abs(counts), initial=1.0))
    return bool(doubt < 0.05 and np.all(np.abs(counts - np.rint(counts)) <= doubt))


def _unit(stamps: FloatArray, digits: int) -> FloatArray:
    sizes = np.abs(stamps)
    powers = np.floor(np.log10(np.where(sizes > 0, sizes, np.min(sizes[sizes > 0], initial=1.0))))
    # Below some 1e-290 there are no such units: nothing may be divided by zero.
    return np.asarray(10.0 ** (np.maximum(powers, LEAST_POWER) + 1 - digits))


def _extreme_interval(low: FloatArray, high: FloatArray, interval: float, way: int) -> float | None:
    """Least (``way`` 1) or largest (-1) sampling interval of a grid between two bounds (n,), from one beyond it.

    The room between the bounds, less k intervals, is a concave function of the interval, made of straight pieces:
    Newton's steps along them come to its zero from without, and end where it has none.
    """
    number = np.arange(len(low))
    for _ in range(MOST_STEPS):
        lines = number * interval
        above, below = int(np.argmin(high - lines)), int(np.argmax(low - lines))
        room = float(high[above] - lines[above] - (low[below] - lines[below]))
        if room >= 0:
            return interval
        if (below - above) * way <= 0:
            return None
        # The slope of the room over the interval is below - above, the numbers of its two bounds.
        step = -room / (below - above)
        interval = interval + step if interval + step != interval else float(np.nextafter(interval, np.inf * way))
    return None


def _plainest(low: FloatArray, high: FloatArray, ends: tuple[float, float], scale: float) -> float:
    """Rate in Hz of an interval between its ends that is, or whose interval is, a number of few digits."""
    middle = (ends[0] + ends[1]) / 2 * scale
    # Few time stamps allow many rates; recorders rather have plain rates than plain intervals.
    for digits in (range(1, PLAIN_DIGITS + 1), range(PLAIN_DIGITS + 1, MOST_DIGITS)):
        rates = [float(f"{1 / middle:.{count}g}") for count in digits]
        for rate in (*rates, *(1 / float(f"{middle:.{count}g}") for count in digits)):
            interval = 1 / (rate * scale)
            lines = np.arange(len(low)) * interval if ends[0] <= interval <= ends[1] else None
            if lines is not None and np.max(low - lines) <= np.min(high - lines):
                return rate
    return 1 / middle


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
    return [_fault(text, source, first + row, "not-finite") for row, text in texts.items()]


def order_faults(stamps: FloatArray, source: Source, first: int = 0) -> list[Fault]:
    """Faults of time stamps (n,) in s that do not increase, each with its position in the file."""
    assert source.time is not None
    column, texts = source.time.name, dict[int, str]()
    if is_coarse(stamps):
        return [
            _fault(
                _coarse_text(stamps, column), source, first + int(np.argmax(np.diff(stamps) == 0)) + 1, "unordered-rows"
            )
        ]
    for row in np.flatnonzero(np.diff(stamps) <= 0)[:MOST_FAULTS]:
        text = f"the time stamp {stamps[row + 1]:.9g} s follows {stamps[row]:.9g} s in {column}: time has to increase"
        text += "; where it begins again, save each record in a file of its own" if stamps[row + 1] <= stamps[0] else ""
        texts[int(row) + 1] = text
    return [_fault(text, source, first + row, "unordered-rows") for row, text in texts.items()]


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
        f"the time stamps do not fit samples at {rate:g} Hz; correct {remedy('sampling_rate=')}, or leave it out",
        kind="contradicting-values",
    )


def _fault(text: str, source: Source, row: int, kind: str) -> Fault:
    assert source.time is not None
    return Fault(text, ("channels", source.time.name), position=source.place(int(row)), kind=kind)


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
    return [
        Fault(
            f"the time stamps say {mean:.6g} Hz, {said} was given; leave it out to use them",
            kind="contradicting-values",
        )
    ]


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
    return [Fault(text, position=stated.position, kind="contradicting-values")]
