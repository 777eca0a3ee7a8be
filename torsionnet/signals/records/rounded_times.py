"""Uniform grid of samples whose time stamps were rounded to some digits, so that their intervals only seem to vary."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from torsionnet.signals.recording import FloatArray

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

    >>> found = rounded_grid(np.round(np.arange(20) / 25.6e3, 6))
    >>> found.rate, found.start, found.digits
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
        ends = _end(low, high, least, 1), _end(low, high, most, -1)
        if ends[0] is None or ends[1] is None or not 0 < ends[0] <= ends[1]:
            continue
        if 2.01 * float(np.min(half)) > ends[1] and not np.all(np.diff(stamps) > 0):
            continue
        rate = _plainest(low, high, (ends[0], ends[1]), scale)
        lines = np.arange(last + 1) / (rate * scale)
        start = float(np.clip(0.0, np.max(low - lines), np.min(high - lines)))
        return RoundedGrid(rate, float(stamps[0] + start) * scale, digits)
    return None


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
    return np.asarray(10.0 ** (powers + 1 - digits))


def _end(low: FloatArray, high: FloatArray, interval: float, way: int) -> float | None:
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
