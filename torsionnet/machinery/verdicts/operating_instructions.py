"""Operating instructions from checks of limits, with speeds to pass, highest speeds, values and markings."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.base.units import RPM
from torsionnet.machinery.verdicts.limit_check import LimitCheck, by_range, starts_words
from torsionnet.machinery.verdicts.limit_verdict import FAIL, LimitVerdict, listed_names
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan, joined_spans, span_words


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
    rpm : float
        Speed at which the decisive limit has its largest value in the range.
    value, allowed, allowed_in_passing : float
        That value, and what it may be in continuous operation and in passing at that speed, SI; NaN where no rule says
        it.
    unit, action, marking : str
    elsewhere : str
        Conditions in which a range may be passed that may not be passed in this one; empty where that is not asked.
    besides : str
        What else is said of the range: a speed that has to stay free and does not, and a passage that no limit judges.
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
    rpm: Annotated[float, Out("at", "rpm", digits=4)]
    value: Annotated[float, Out("value", digits=4)]
    allowed: Annotated[float, Out("allowed", digits=4)]
    allowed_in_passing: Annotated[float, Out("in passing", digits=4)]
    unit: Annotated[str, Out("unit")]
    action: str
    marking: str
    elsewhere: str = ""
    besides: str = ""

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
        """Text of what the crew has to do in a speed range, where else it may be passed, and how it is marked."""
        return joined("; ", filter(None, (self.action, self.besides, self.elsewhere, self.marking)))


ONLY_PASSED = (
    "Speeds outside of {low:.6g} to {high:.6g} rpm of {shaft} are to be passed without stopping{where}: {limits}."
)
"""Note on speeds outside of the speed bands of limits, which are judged in the bands alone."""
UNRESTRICTED = "No restrictions from {low:g} to {high:g} rpm of {shaft}{where}; {starts}."
UNRESTRICTED_ELSEWHERE = "No other restrictions from {low:g} to {high:g} rpm of {shaft}{where}; {starts}."
"""Notes on the speeds that no instruction restricts."""
FAILS = "Not to be run as it is: {limits} not kept; {starts}."
FAILS_NORMALLY = (
    "Not kept in normal operation: {limits}; only the remaining speeds may be run, which the conditions list; {starts}."
)
FAILS_ELSEWHERE = (
    "Not kept in single conditions: {limits}; there only the remaining speeds may be run, if there are any; {starts}."
)
"""Notes on limits that do not hold: where the first condition permits no speed, or some, and in other conditions."""
RED, NOTICE = "tachometer red, notice at each control station", "notice at each control station"
"""Markings for the crew of a ship, of a range and of a highest speed."""
NOT_FREE = "the speed for safe navigation, {speed:.5g} rpm, does not stay free"
BEGINS = "it begins where {limit} is exceeded"
NOT_JUDGED = "the passage is not judged: no limit in passing is given"
NOT_JUDGED_BY = "no limit in passing is given for {limits}"
"""Texts on a range that is barred at a speed that has to stay free, on one that begins below what decides on it, and on
one of which no limit says what it bears."""
PASS_QUICKLY, PASS_WITHIN, NOT_AT_ALL = range(3)
"""Ranks of what limits permit in a speed range, rising with gravity: passing without stopping, in a time, none."""
MOST_WAYS = 2
"""Largest number of conditions that are named in which a range may be passed instead."""


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
        return joined(", ", (self.verdict.limit, phrase(self.verdict.criterion)))


@dataclass(frozen=True, eq=False)
class PassedRange:
    """Speed range (rad/s) that is restricted in one condition, with the verdicts of all limits that restrict it.

    Attributes
    ----------
    span : SpeedSpan
        rad/s, not rounded.
    places : tuple
        Limits that restrict speeds of the range.
    """

    span: SpeedSpan
    places: tuple[_Place, ...]

    @property
    def check(self) -> LimitCheck:
        """Check of limits in the condition in which the range is barred."""
        return self.places[0].check

    @property
    def passage(self) -> int:
        """Least passage that any limit permits in the range, such as ``PASS_QUICKLY``."""
        return max(place.passage for place in self.places)

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
    def harmless(self) -> bool:
        """Whether the range is not to be run, but does no harm in passing, by all limits that restrict it."""
        return all(place.verdict.harmless for place in self.places)

    @property
    def seconds_to_pass(self) -> float | None:
        """Shortest time in s in which a limit wants the speed range to be passed; None where none is given."""
        return min((at for place in self.places if (at := place.verdict.seconds_to_pass) is not None), default=None)


def passed_ranges(checks: Sequence[LimitCheck]) -> tuple[PassedRange, ...]:
    """Speed ranges (rad/s) to be passed without stopping in each condition, joined where those of limits overlap.

    Ranges that one limit lets pass and another does not are not among them, nor those that do no harm in passing.
    """
    ranges = (passed for check in checks for passed in restricted_ranges(check))
    return tuple(passed for passed in ranges if passed.passage != NOT_AT_ALL and not passed.harmless)


def refused_ranges(checks: Sequence[LimitCheck]) -> tuple[PassedRange, ...]:
    """Speed ranges (rad/s) that must not be passed to higher speeds in each condition, the lowest of each condition."""
    refused = (barred for check in checks for barred in restricted_ranges(check) if barred.passage == NOT_AT_ALL)
    return tuple(barred for barred in refused if barred.span.high < barred.check.speeds[-1])


def restricted_ranges(check: LimitCheck) -> tuple[PassedRange, ...]:
    """Speed ranges (rad/s) restricted in one condition in rising order, up to the first that must not be passed.

    They are the union of the ranges of all limits: what one of them refuses is refused.
    """
    ranges = [
        PassedRange(span, tuple(place for place in _forbidden_ranges(check) if span.holds(place.span.low)))
        for span in joined_spans([place.span for place in _forbidden_ranges(check)])
    ]
    return tuple(restricted for restricted in ranges if check.highest is None or restricted.span.low <= check.highest)


def operating_instructions(
    checks: Sequence[LimitCheck], title: Callable[[str], str] | None = None
) -> tuple[Instruction, ...]:
    """Instructions to the crew from checks of limits of one model, with rows of their own for every condition.

    Ranges of several limits that overlap in a condition are one, and the limit with the least permitted passage decides
    on it: a range that one shaft may pass is not passed where another one may not. What lies above such a range is not
    reached in that condition and has no rows. Conditions with a cylinder out come last. Speeds to be barred are rounded
    outward to 1 rpm, the highest speed permitted is rounded down. ``title`` gives the title of a configuration by its
    name; default: the name.
    """
    ordered = sorted(checks, key=lambda check: check.misfiring)
    return tuple(
        instruction(restricted, title or str, checks) for check in ordered for restricted in restricted_ranges(check)
    )


def instruction_table(checks: Sequence[LimitCheck], conventions: Conventions = SI, title: str = "") -> Table:
    """Table of operating instructions from checks of limits of one model, with a note on any other restriction."""
    rows = operating_instructions(checks)
    shown = [_in_units(row, conventions) for row in rows]
    return result_table(title or "operating instructions", shown, Instruction, notes=last_notes(checks))


def last_notes(checks: Sequence[LimitCheck], named: Callable[[Sequence[str]], str] = listed_names) -> list[str]:
    """Sentences on the speeds that no instruction restricts, or one on the limits that do not hold.

    The first check is that of the normal condition. There is one for all conditions examined at the same speeds, and
    one for all that run in the same speed band, outside of which they only pass. ``named`` makes a text of the names of
    configurations.
    """
    failed = dict.fromkeys(verdict.limit for check in checks for verdict in check.verdicts if verdict.verdict == FAIL)
    failed |= dict.fromkeys(name for check in checks if check.run_up for name in check.run_up.names(FAIL))
    starts, outside = starts_words(checks), list(_only_passed(checks, named))
    if failed:
        template = FAILS_ELSEWHERE
        if checks[0].verdict == FAIL:
            starts_hold = checks[0].run_up is None or checks[0].run_up.verdict != FAIL
            template = FAILS_NORMALLY if checks[0].permitted and starts_hold else FAILS
        return [phrase(template, limits=listed_names(list(failed)), starts=starts), *outside]
    template = UNRESTRICTED_ELSEWHERE if any(map(restricted_ranges, checks)) else UNRESTRICTED
    notes, ranges = [], by_range(checks, running=True)
    for (low, high), alike in ranges.items():
        where = _where(alike, named) if len(ranges) > 1 else ""
        notes.append(phrase(template, low=low, high=high, shaft=checks[0].reference, where=where, starts=starts))
    return [*notes, *outside]


def _only_passed(checks: Sequence[LimitCheck], named: Callable[[Sequence[str]], str]) -> Iterator[str]:
    """Sentences on the speeds that are only passed, as limits are judged in their speed bands alone."""
    for (low, high), alike in by_range(checks, running=True).items():
        passing = [check for check in alike if check.running and (low, high) not in by_range([check])]
        names = dict.fromkeys(verdict.limit for check in passing for verdict in check.verdicts if verdict.running)
        if passing:
            limits = phrase("{limit} not judged there", limit=listed_names(list(names)))
            where = _where(passing, named) if len(passing) < len(checks) else ""
            yield phrase(ONLY_PASSED, low=low, high=high, shaft=checks[0].reference, where=where, limits=limits)


def _where(checks: Sequence[LimitCheck], named: Callable[[Sequence[str]], str]) -> str:
    return phrase(" in {names}", names=named([check.configuration for check in checks]))


def _forbidden_ranges(check: LimitCheck) -> Iterator[_Place]:
    """Yield the ranges that limits bar, those that they refuse, and the ones above the highest speed they permit."""
    for verdict in check.verdicts:
        for span in verdict.barred:
            yield _Place(check, verdict, span, PASS_QUICKLY if verdict.seconds_to_pass is None else PASS_WITHIN)
        for span in verdict.refused:
            yield _Place(check, verdict, span, NOT_AT_ALL)
        if verdict.highest is not None:
            yield _Place(check, verdict, SpeedSpan(verdict.highest, float(check.speeds[-1])), NOT_AT_ALL)


def instruction(
    restricted: PassedRange, title: Callable[[str], str] = str, checks: Sequence[LimitCheck] = ()
) -> Instruction:
    """Instruction to the crew on a restricted range; ``checks`` are those of the conditions where it may be passed."""
    places = sorted(
        restricted.places, key=lambda place: (-place.passage, not place.verdict.in_passing, -place.utilisation)
    )
    decisive, check = places[0], restricted.check
    verdict, at = decisive.verdict, decisive.at
    low, high, action, marking = _action(restricted)
    same = [other for other in check.verdicts if (other.limit, other.quantity) == (verdict.limit, verdict.quantity)]
    steady, passing = ([float(two.allowed[at]) for two in same if two.in_passing is way] for way in (False, True))
    return Instruction(
        (check.configuration,), title(check.configuration) or "as written", check.reference,
        max(place.verdict.tolerance for place in places), low, high, verdict.limit, verdict.criterion,
        tuple(dict.fromkeys(place.named for place in places)), float(check.rpm[at]), float(verdict.values[at]),
        min(steady, default=math.nan), min(passing, default=math.nan), verdict.unit, action, marking,
        _elsewhere(restricted, checks, title), _besides(restricted, decisive),
    )  # fmt: skip


def _besides(restricted: PassedRange, decisive: _Place) -> str:
    """Text of what makes a range begin, of speeds that have to stay free, and of a passage that is not judged."""
    first = min(restricted.places, key=lambda place: place.span.low)
    begins = restricted.passage == NOT_AT_ALL and first.span.low < decisive.span.low
    free = {
        verdict.not_free
        for verdict in restricted.verdicts
        if verdict.not_free is not None and restricted.span.holds(verdict.not_free)
    }
    said = [phrase(NOT_FREE, speed=speed * RPM) for speed in sorted(free)]
    said += [phrase(BEGINS, limit=first.named)] if begins and first.named != decisive.named else []
    said += _not_judged(restricted) if restricted.passage != NOT_AT_ALL and not restricted.harmless else []
    return joined("; ", said) if said else ""


def _not_judged(restricted: PassedRange) -> list[str]:
    """Text of the limits of a range that say nothing of what is borne in passing; none where all of them do."""
    limits = dict.fromkeys(place.verdict.limit for place in restricted.places)
    judged = {
        verdict.limit
        for place in restricted.places
        for verdict in restricted.check.verdicts
        if verdict.in_passing and verdict.limit == place.verdict.limit and math.isfinite(verdict.allowed[place.at])
    }
    if not judged:
        return [phrase(NOT_JUDGED)]
    missing = [name for name in limits if name not in judged]
    return [phrase(NOT_JUDGED_BY, limits=listed_names(missing))] if missing else []


def _action(restricted: PassedRange) -> tuple[int, int | None, str, str]:
    """Ends of a range in whole rpm, what the crew does about it, and how it is marked."""
    (low, high), check = restricted.span.rpm_outward, restricted.check
    marked = phrase(RED) if check.propels else ""
    if restricted.harmless:
        return low, high, phrase("not to be run with load; it may be passed"), marked
    if restricted.passage == PASS_QUICKLY:
        return low, high, phrase("pass without stopping"), marked
    if restricted.passage == PASS_WITHIN:
        within = restricted.seconds_to_pass or 0.0
        return low, high, phrase("pass without stopping within {time:g} s", time=within), marked
    if restricted.span.low <= check.speeds[0]:
        return low, high, phrase("not to be run or passed: no speed is permitted"), marked
    if restricted.span.high < check.speeds[-1]:
        return low, high, phrase("not to be run or passed: not above {speed} rpm", speed=low), marked
    if check.propels:
        return low, None, phrase("not above {speed} rpm, reduce power", speed=low), phrase(NOTICE)
    if check.rated is not None and check.rated >= restricted.span.low:
        return low, None, phrase("not above {speed} rpm; rated speed is not permitted", speed=low), ""
    return low, None, phrase("not above {speed} rpm", speed=low), ""


def _elsewhere(restricted: PassedRange, checks: Sequence[LimitCheck], title: Callable[[str], str]) -> str:
    """Text of the conditions in which a range may be passed that must not be passed in this one, or that none is there.

    Empty where the range may be passed, or reaches to the highest speed. A misfire is not chosen: only conditions with
    a cylinder out count where one is out, and only others where none is.
    """
    span, own = restricted.span, restricted.check
    if restricted.passage != NOT_AT_ALL or span.high >= own.speeds[-1]:
        return ""
    every = [check for check in checks if check.highest is None or check.highest > span.high]
    if not every:
        return phrase("no condition examined reaches higher speeds")
    ways = [check for check in every if check.misfiring is own.misfiring]
    if not ways and own.misfiring:
        return phrase("higher speeds only once the fault is mended")
    if not ways:
        return phrase("higher speeds only with a cylinder out")
    changes = {check.configuration: _changes(own.configuration, check.configuration) for check in ways}
    ways = [check for check in ways if changes[check.configuration] == min(changes.values())]
    return joined("; ", [_way(check, span, title) for check in ways[:MOST_WAYS]])


def _changes(first: str, second: str) -> int:
    """Number of choices in which two configurations differ."""
    return len(set(first.split(",")) ^ set(second.split(",")))


def _way(check: LimitCheck, span: SpeedSpan, title: Callable[[str], str]) -> str:
    """Text of how a range is passed in a condition that permits it."""
    condition = title(check.configuration)
    barred = [other for other in check.passed if other.low <= span.high and other.high >= span.low]
    run = [other.within(span) for other in check.permitted if other.low < span.high and other.high > span.low]
    if barred:
        return phrase("pass {speeds} in condition {condition}", speeds=span_words(barred), condition=condition)
    return phrase("{speeds} are free in condition {condition}", speeds=span_words(run or [span]), condition=condition)


def _in_units(row: Instruction, conventions: Conventions) -> Instruction:
    scale = conventions.scale(row.unit)
    return replace(
        row,
        value=row.value * scale,
        allowed=row.allowed * scale,
        allowed_in_passing=row.allowed_in_passing * scale,
        unit=conventions.unit(row.unit),
    )
