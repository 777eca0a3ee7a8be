"""Operating instructions from checks of limits, with speeds to pass, highest speeds, values and markings."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.phrases import extended, phrase
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.machinery.verdicts.limit_check import (
    FAIL,
    LimitCheck,
    LimitVerdict,
    by_range,
    listed_names,
    starts_words,
)
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan, joined_spans, spans_above, spans_below


@dataclass(frozen=True, eq=False)
class Instruction:
    """Instruction to the crew on a range of speeds in rpm, with the limit behind it and what is to be done.

    Attributes
    ----------
    conditions : tuple of str
        The configuration in which it holds; conditions are never joined.
    shaft : str
        Node whose speed the tachometer shows.
    tolerance : float
        Relative error of the tachometer that is in the speeds.
    from_rpm, to_rpm : int or None
        Speeds rounded outward to 1 rpm; None where there is no such end.
    limit, criterion : str
        Limit that decides: of those with the least permitted passage one for passing, else the most used one.
    limits : tuple of str
        Names and criteria of all limits that restrict speeds of the range, the decisive one first.
    value, allowed, allowed_in_passing : float
        The largest value of the decisive limit there, and what it may be in continuous operation and in passing at that
        speed, SI; NaN where no rule says it.
    unit, action, marking : str
    """

    conditions: tuple[str, ...]
    condition: Annotated[str, Out("condition", json=None)]
    shaft: str
    tolerance: Annotated[float, Out(json="tachometer_tolerance")]
    from_rpm: Annotated[int | None, Out("from", "rpm")]
    to_rpm: Annotated[int | None, Out("to", "rpm")]
    limit: str
    criterion: str
    limits: tuple[str, ...]
    value: Annotated[float, Out("value", digits=4)]
    allowed: Annotated[float, Out("allowed", digits=4)]
    allowed_in_passing: Annotated[float, Out("in passing", digits=4)]
    unit: Annotated[str, Out("unit")]
    action: str
    marking: str

    @property
    def tachometer(self) -> Annotated[str, Out("tachometer", json=None, after="condition")]:
        """Text of the node whose speed the tachometer shows, with the tachometer's relative error in per cent."""
        return f"{self.shaft} ± {100 * self.tolerance:g} %" if self.tolerance else self.shaft

    @property
    def limited_by(self) -> Annotated[str, Out("limit", json=None, after="to_rpm")]:
        """Text of the names and criteria of all limits that restrict the speed range, the decisive one first."""
        return "; ".join(self.limits)

    @property
    def instruction(self) -> Annotated[str, Out("action and marking", json=None, after="unit")]:
        """Text of what the crew has to do in a speed range, and of how the range is marked."""
        return extended(self.action, f"; {self.marking}")


UNRESTRICTED = "No restrictions from {low:g} to {high:g} rpm of {shaft}{where}; {starts}."
UNRESTRICTED_ELSEWHERE = "No other restrictions from {low:g} to {high:g} rpm of {shaft}{where}; {starts}."
"""Notes on the speeds that no instruction restricts."""
NOTICE = "notice at each control station"
"""Marking of every range for the crew."""
PASS_QUICKLY, PASS_WITHIN, NOT_AT_ALL = range(3)
"""Ranks of what limits permit in a speed range, rising with gravity: passing without stopping, in a time, none."""


@dataclass(frozen=True, eq=False)
class _Place:
    """Verdict on a limit, a speed range (rad/s) that it restricts, and how that range may be passed.

    ``at`` is the index of the speed of largest utilisation in the range.
    """

    check: LimitCheck
    verdict: LimitVerdict
    span: SpeedSpan
    passage: int

    @property
    def at(self) -> int:
        speeds = self.check.speeds
        inside = (speeds >= self.span.low) & (speeds <= self.span.high)
        return int(np.argmax(np.where(inside, np.nan_to_num(self.verdict.utilisation), -1.0)))

    @property
    def utilisation(self) -> float:
        return float(self.verdict.utilisation[self.at])

    @property
    def named(self) -> str:
        """Text of the name and criterion of the limit."""
        return f"{self.verdict.limit}, {self.verdict.criterion}"


@dataclass(frozen=True, eq=False)
class PassedRange:
    """Speed range (rad/s) that the crew passes without stopping in one condition, with the verdicts that bar it.

    Attributes
    ----------
    span : SpeedSpan
        rad/s, not rounded.
    places : tuple
        Limits that bar speeds of the range.
    """

    span: SpeedSpan
    places: tuple[_Place, ...]

    @property
    def check(self) -> LimitCheck:
        """Check of limits in the condition in which the range is barred."""
        return self.places[0].check

    @property
    def verdicts(self) -> tuple[LimitVerdict, ...]:
        """Verdicts that bar a speed range, sorted so that the most used limit comes first."""
        places = sorted(self.places, key=lambda place: -place.utilisation)
        return tuple(dict.fromkeys(place.verdict for place in places))

    @property
    def utilisation(self) -> float:
        """Largest utilisation of a limit in a speed range, ratio of value to value allowed, without unit."""
        return max(place.utilisation for place in self.places)

    @property
    def seconds_to_pass(self) -> float | None:
        """Shortest time in s in which a limit wants the speed range to be passed; None where none is given."""
        return min((at for one in self.places if (at := one.verdict.seconds_to_pass) is not None), default=None)


def passed_ranges(checks: Sequence[LimitCheck]) -> tuple[PassedRange, ...]:
    """Speed ranges (rad/s) to be passed without stopping in each condition, joined where those of limits overlap."""
    return tuple(found for check in checks for found in _joined(list(_passed(check))))


def operating_instructions(checks: Sequence[LimitCheck]) -> tuple[Instruction, ...]:
    """Instructions to the crew from checks of limits of one model, with rows of their own for every condition.

    Ranges of several limits that overlap in a condition are one, and the limit with the least permitted passage decides
    on it: a range that one shaft may pass is not passed where another one may not. Conditions with a cylinder out come
    last. Speeds to be barred are rounded outward to 1 rpm, the highest speed permitted is rounded down.
    """
    ordered = sorted(checks, key=lambda check: check.misfiring)
    return tuple(_instruction(found) for check in ordered for found in _joined([*_passed(check), *_refused(check)]))


def instruction_table(checks: Sequence[LimitCheck], conventions: Conventions = SI, title: str = "") -> Table:
    """Table of operating instructions from checks of limits of one model, with a note on any other restriction."""
    rows = operating_instructions(checks)
    failed = dict.fromkeys(one.limit for check in checks for one in check.verdicts if one.verdict == FAIL)
    failed |= dict.fromkeys(name for check in checks if check.run_up for name in check.run_up.names(FAIL))
    shown = [_in_units(one, conventions) for one in rows]
    starts = starts_words(checks)
    if failed:
        template = "Not to be run as it is: {limits} not kept; {starts}."
        notes = [phrase(template, limits=listed_names(list(failed)), starts=starts)]
    else:
        notes = list(_unrestricted(checks, UNRESTRICTED_ELSEWHERE if rows else UNRESTRICTED, starts))
    return result_table(title or "operating instructions", shown, Instruction, notes=notes)


def _unrestricted(checks: Sequence[LimitCheck], template: str, starts: str) -> Iterator[str]:
    """Sentences on the speeds that nothing restricts, one for all conditions that were examined at the same speeds."""
    ranges = by_range(checks)
    for (low, high), alike in ranges.items():
        names = listed_names([check.configuration for check in alike])
        where = phrase(" in {names}", names=names) if len(ranges) > 1 else ""
        yield phrase(template, low=low, high=high, shaft=checks[0].reference, where=where, starts=starts)


def _passed(check: LimitCheck) -> Iterator[_Place]:
    """Yield the ranges that limits bar below the highest speed that all of them permit."""
    for one in check.verdicts:
        for span in spans_below(one.barred, check.highest):
            yield _Place(check, one, span, PASS_QUICKLY if one.seconds_to_pass is None else PASS_WITHIN)


def _refused(check: LimitCheck) -> Iterator[_Place]:
    """Yield the ranges that may not even be passed, and the one above the highest speed permitted."""
    for one in check.verdicts:
        if one.highest is not None:
            yield _Place(check, one, SpeedSpan(one.highest, float(check.speeds[-1])), NOT_AT_ALL)
        elif one.verdict == FAIL:
            # A limit that no range can be barred for permits no passage either: it does not hold.
            above = [span.widened(one.tolerance) for span in spans_above(check.speeds, one.values, one.allowed)]
            ends = SpeedSpan(float(check.speeds[0]), float(check.speeds[-1]))
            for span in spans_below(above, check.highest):
                yield _Place(check, one, span.within(ends), NOT_AT_ALL)


def _joined(places: Sequence[_Place]) -> Iterator[PassedRange]:
    for span in joined_spans([place.span for place in places]):
        yield PassedRange(span, tuple(place for place in places if span.low <= place.span.low <= span.high))


def _instruction(found: PassedRange) -> Instruction:
    places = sorted(found.places, key=lambda place: (-place.passage, not place.verdict.in_passing, -place.utilisation))
    decisive, check = places[0], found.check
    one, at = decisive.verdict, decisive.at
    low, high, action, marking = _action(found, decisive.passage)
    same = [other for other in check.verdicts if (other.limit, other.quantity) == (one.limit, one.quantity)]
    passing = [float(other.allowed[at]) for other in same if other.in_passing]
    return Instruction(
        (check.configuration,), check.configuration or "as written", check.reference,
        max(place.verdict.tolerance for place in places), low, high, one.limit, one.criterion,
        tuple(dict.fromkeys(place.named for place in places)), float(one.values[at]), float(one.allowed[at]),
        min(passing, default=math.nan), one.unit, action, marking,
    )  # fmt: skip


def _action(found: PassedRange, passage: int) -> tuple[int, int | None, str, str]:
    """Ends of a range in whole rpm, what the crew does about it, and how it is marked."""
    low, high = found.span.rpm_outward
    reduced = any(place.verdict.highest is not None and place.passage == NOT_AT_ALL for place in found.places)
    if reduced and found.span.low > found.check.speeds[0]:
        return low, None, phrase("not above {speed} rpm, reduce power", speed=low), NOTICE
    action = {
        PASS_QUICKLY: "pass without stopping",
        PASS_WITHIN: phrase("pass without stopping within {time:g} s", time=found.seconds_to_pass or 0.0),
        NOT_AT_ALL: "not to be run or passed",
    }[passage]
    return low, high, action, "tachometer red, notice at each control station"


def _in_units(one: Instruction, conventions: Conventions) -> Instruction:
    scale = conventions.scale(one.unit)
    return replace(
        one,
        value=one.value * scale,
        allowed=one.allowed * scale,
        allowed_in_passing=one.allowed_in_passing * scale,
        unit=conventions.unit(one.unit),
    )
