"""Ranges of speed in rad/s in which a limit is exceeded or which have to be barred, and their texts in rpm."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.phrases import joined, phrase
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import FloatArray

WHOLE_RPM_RELATIVE = 1e-9
"""Share of a speed up to which its difference from a whole number of rpm counts as rounding."""


def whole_rpm(speed: float, rounded: Callable[[float], int]) -> int:
    """Whole number of rpm of a speed in rad/s, rounded up or down (``math.ceil``, ``math.floor``) if not whole.

    Examples
    --------
    >>> whole_rpm(4.9, math.floor), whole_rpm(4.9, math.ceil), whole_rpm(4.0 * math.pi, math.floor)
    (46, 47, 120)
    """
    rpm = speed * RPM
    nearest = round(rpm)
    return nearest if abs(rpm - nearest) <= WHOLE_RPM_RELATIVE * rpm else rounded(rpm)


@dataclass(frozen=True)
class SpeedSpan:
    """Range of speeds of the reference shaft from ``low`` to ``high``, rad/s; its text is rounded outward to 1 rpm.

    Examples
    --------
    >>> print(SpeedSpan(43.0, 47.0))
    410 to 449 rpm
    """

    low: float
    high: float

    def holds(self, speed: float) -> bool:
        """Whether a speed in rad/s lies in the speed range."""
        return self.low <= speed <= self.high

    def marks_any(self, speeds: Iterable[float | None]) -> bool:
        """Whether one of several speeds in rad/s lies in the range as a tachometer is marked, outward to 1 rpm.

        Examples
        --------
        >>> SpeedSpan(1.0, 114.4 / RPM).marks_any([None, 115.0 / RPM])
        True
        """
        low, high = self.rpm_outward
        marked = SpeedSpan(low / RPM, high / RPM).widened(WHOLE_RPM_RELATIVE)
        return any(speed is not None and marked.holds(speed) for speed in speeds)

    def widened(self, tolerance: float) -> SpeedSpan:
        """Speed range in rad/s, each end moved outward by the share ``tolerance`` of its speed."""
        return SpeedSpan(self.low * (1 - tolerance), self.high * (1 + tolerance))

    def within(self, other: SpeedSpan) -> SpeedSpan:
        """Part of a speed range in rad/s that lies in another speed range."""
        return SpeedSpan(max(self.low, other.low), min(self.high, other.high))

    def __str__(self) -> str:
        low, high = self.rpm_outward
        return phrase("{low} to {high} rpm", low=low, high=high)

    @property
    def rpm_outward(self) -> tuple[int, int]:
        """Lowest and highest speed of a range in whole rpm, rounded outward, as a tachometer is marked."""
        return whole_rpm(self.low, math.floor), whole_rpm(self.high, math.ceil)


def joined_spans(spans: Sequence[SpeedSpan]) -> tuple[SpeedSpan, ...]:
    """Speed ranges in rad/s in rising order, with overlapping ones joined.

    Examples
    --------
    >>> [(span.low, span.high) for span in joined_spans([SpeedSpan(3, 5), SpeedSpan(1, 2), SpeedSpan(4, 6)])]
    [(1, 2), (3, 6)]
    """
    merged: list[SpeedSpan] = []
    for span in sorted(spans, key=lambda span: span.low):
        if merged and span.low <= merged[-1].high:
            merged[-1] = SpeedSpan(merged[-1].low, max(merged[-1].high, span.high))
        else:
            merged.append(span)
    return tuple(merged)


def spans_above(speeds: FloatArray, values: FloatArray, allowed: FloatArray) -> tuple[SpeedSpan, ...]:
    """Speed ranges in rad/s in which values exceed the allowed ones, both taken as linear between the speeds.

    NaN exceeds nothing.

    Examples
    --------
    >>> spans = spans_above(np.array([1.0, 2, 3, 4]), np.array([0.0, 2, 2, 0]), np.ones(4))
    >>> [(span.low, span.high) for span in spans]
    [(1.5, 3.5)]
    """
    over = values - allowed
    above = np.where(np.isfinite(over), over > 0, False)
    spans: list[SpeedSpan] = []
    places = np.flatnonzero(above)
    for first, last in _runs(places):
        # Crossings by straight lines to the neighbours below the limit; at an end of the speeds there is none.
        low = _crossing(speeds, over, first, first - 1) if first else speeds[0]
        high = _crossing(speeds, over, last, last + 1) if last + 1 < len(speeds) else speeds[-1]
        spans.append(SpeedSpan(float(low), float(high)))
    return tuple(spans)


def range_end_remarks(span: SpeedSpan, limits: SpeedSpan, below: str, above: str) -> tuple[str, ...]:
    """Texts of remarks where a speed range reaches the lowest or highest examined speed, none where it reaches neither.

    Examples
    --------
    >>> range_end_remarks(SpeedSpan(43.0, 47.0), SpeedSpan(30.0, 45.0), "no lower speed was examined", "no higher one")
    ('the range ends at 429.7 rpm: no higher one',)
    """
    slack = 1e-9 * limits.high
    low = (f"the range begins at {limits.low * RPM:.1f} rpm: {below}",) if span.low <= limits.low + slack else ()
    high = (f"the range ends at {limits.high * RPM:.1f} rpm: {above}",) if span.high >= limits.high - slack else ()
    return (*low, *high)


def _runs(places: NDArray[np.integer[Any]]) -> list[tuple[int, int]]:
    """Pairs of first and last index, one for each run of consecutive indices."""
    pieces = np.split(places, np.flatnonzero(np.diff(places) > 1) + 1)
    return [(int(piece[0]), int(piece[-1])) for piece in pieces if len(piece)]


def _crossing(speeds: FloatArray, over: FloatArray, inside: int, outside: int) -> float:
    """Speed in rad/s at which a value falls to the allowed one on the straight line to a speed outside the range."""
    if not np.isfinite(over[outside]):
        return float(speeds[inside])
    # Straight line from over > 0 inside to over <= 0 outside: it is 0 at this share of the step.
    share = over[inside] / (over[inside] - over[outside])
    return float(speeds[inside] + share * (speeds[outside] - speeds[inside]))


def rpm_spans(spans: Iterable[SpeedSpan]) -> tuple[tuple[float, float], ...]:
    """Pairs of lowest and highest speed in rpm, one for every speed range."""
    return tuple((span.low * RPM, span.high * RPM) for span in spans)


def spans_below(spans: Iterable[SpeedSpan], highest: float | None) -> tuple[SpeedSpan, ...]:
    """Speed ranges (rad/s) that begin below the highest speed permitted (rad/s), all ranges if that is None."""
    return tuple(span for span in spans if highest is None or span.low < highest)


def span_words(spans: Iterable[SpeedSpan]) -> str:
    """Text of speed ranges in rpm, joined by commas."""
    return joined(", ", map(str, spans))


def permitted_words(spans: Iterable[SpeedSpan]) -> str:
    """Text in rpm of speed ranges (rad/s) that are permitted, rounded inward to 1 rpm; a word where there is none.

    Examples
    --------
    >>> permitted_words([SpeedSpan(4.05, 9.0), SpeedSpan(11.0, 12.0)])
    '39 to 85 rpm, 106 to 114 rpm'
    """
    ends = [(whole_rpm(span.low, math.ceil), whole_rpm(span.high, math.floor)) for span in spans]
    words = [phrase("{low} to {high} rpm", low=low, high=high) for low, high in ends if low <= high]
    return joined(", ", words) if words else phrase("none")


def restriction_words(passed: Sequence[SpeedSpan], highest: float | None, shaft: str = "") -> str:
    """Text in rpm of barred speeds and of the highest speed permitted, rounded down to 1 rpm, empty for neither.

    Examples
    --------
    >>> restriction_words([SpeedSpan(4.0, 4.5)], 10.25, " of crank")
    'at most 97 rpm of crank, 38 to 43 rpm barred'
    >>> restriction_words([SpeedSpan(4.0, 4.5)], None)
    '38 to 43 rpm'
    """
    words = span_words(passed)
    if highest is None:
        return joined("", (words, shaft)) if words else ""
    most = phrase("at most {speed} rpm", speed=whole_rpm(highest, math.floor))
    if not words:
        return joined("", (most, shaft)) if shaft else most
    return phrase("{most}{shaft}, {speeds} barred", most=most, shaft=shaft, speeds=words)


def in_condition(restriction: str, condition: str) -> str:
    """Text of a restriction of speeds with the condition in which it holds in front, if one is named.

    Examples
    --------
    >>> in_condition("at most 94 rpm of crank", "misfire")
    'in misfire: at most 94 rpm of crank'
    """
    template = "in {condition}: {restriction}" if condition else "{restriction}"
    return phrase(template, condition=condition, restriction=restriction)


def starts_sentence(rpm: float, shaft: str) -> str:
    """Sentence on the speeds below the lowest one examined, in rpm, which every start and stop passes.

    Examples
    --------
    >>> starts_sentence(675, "flywheel")
    'starts and stops not examined: speeds below 675 rpm of flywheel'
    """
    return phrase("starts and stops not examined: speeds below {speed:g} rpm of {shaft}", speed=rpm, shaft=shaft)


def utilisation_of(values: FloatArray, allowed: FloatArray) -> FloatArray:
    """Utilisation of a limit, the ratio of value to allowed value, without unit, in the shape of both.

    NaN where no value is allowed.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(np.isfinite(allowed), values / allowed, np.nan))
