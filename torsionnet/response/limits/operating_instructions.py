"""Operating instructions from checks of limits, with speeds to pass, highest speeds, values and markings."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from torsionnet.core.result_rows import Out
from torsionnet.response.conventions import SI, Conventions
from torsionnet.response.limits.limit_check import FAIL, LimitCheck, LimitVerdict, listed_names
from torsionnet.response.limits.speed_spans import SpeedSpan, joined_spans, whole_rpm
from torsionnet.response.table import Table, result_table


@dataclass(frozen=True, eq=False)
class Instruction:
    """Instruction to the crew on a range of speeds in rpm, with the limit behind it and what is to be done.

    Attributes
    ----------
    conditions : tuple of str
        Configurations in which it holds.
    shaft : str
        Node whose speed the tachometer shows.
    tolerance : float
        Relative error of the tachometer that is in the speeds.
    from_rpm, to_rpm : int or None
        Speeds rounded outward to 1 rpm; None where there is no such end.
    limit, criterion : str
        Limit that is used most in the range.
    value, allowed, allowed_in_passing : float
        Its largest value there, and what it may be in continuous operation and in passing at that speed, SI; NaN where
        no rule says it.
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
        """Text of the name and criterion of the limit with the largest utilisation in the instruction's speed range."""
        return f"{self.limit}, {self.criterion}"

    @property
    def instruction(self) -> Annotated[str, Out("action and marking", json=None, after="unit")]:
        """Text of what the crew has to do in a speed range, and of how the range is marked."""
        return f"{self.action}; {self.marking}"


@dataclass(frozen=True, eq=False)
class _Place:
    """Verdict on a limit, a speed range (rad/s) that it bars, and index of the speed there of largest utilisation."""

    check: LimitCheck
    verdict: LimitVerdict
    span: SpeedSpan
    at: int

    @property
    def utilisation(self) -> float:
        return float(self.verdict.utilisation[self.at])


@dataclass(frozen=True, eq=False)
class PassedRange:
    """Speed range (rad/s) that the crew passes without stopping, with the verdicts that bar it in several conditions.

    Attributes
    ----------
    span : SpeedSpan
        rad/s, not rounded.
    places : tuple
        Limits with their conditions.
    """

    span: SpeedSpan
    places: tuple[_Place, ...]

    @property
    def worst(self) -> tuple[LimitCheck, LimitVerdict]:
        """Check of limits, and its verdict, with the largest utilisation in a speed range to be passed."""
        found = max(self.places, key=lambda place: place.utilisation)
        return found.check, found.verdict

    @property
    def verdicts(self) -> tuple[LimitVerdict, ...]:
        """Verdicts that bar a speed range in its worst condition, sorted so that the most used limit comes first."""
        check, first = self.worst
        others = (one.verdict for one in self.places if one.check is check)
        return (first, *dict.fromkeys(one for one in others if one is not first))

    @property
    def utilisation(self) -> float:
        """Largest utilisation of a limit in a speed range, ratio of value to value allowed, without unit."""
        return max(place.utilisation for place in self.places)

    @property
    def seconds_to_pass(self) -> float | None:
        """Shortest time in s in which a limit wants the speed range to be passed; None where none is given."""
        return min((at for one in self.places if (at := one.verdict.seconds_to_pass) is not None), default=None)


def passed_ranges(checks: Sequence[LimitCheck]) -> tuple[PassedRange, ...]:
    """Speed ranges (rad/s) to be passed without stopping, joined where those of limits and conditions overlap."""
    passed = [place for one in checks for place in _passed(one)]
    return tuple(
        PassedRange(span, tuple(place for place in passed if span.low <= place.span.low <= span.high))
        for span in joined_spans([place.span for place in passed])
    )


def operating_instructions(checks: Sequence[LimitCheck]) -> tuple[Instruction, ...]:
    """Instructions to the crew from checks of limits of one model; ranges that overlap in several conditions are one.

    Conditions with a cylinder out and with normal firing are kept apart. Speeds to be barred are rounded outward to
    1 rpm, the highest speed permitted is rounded down.
    """
    found: list[Instruction] = []
    for misfiring in (False, True):
        those = [one for one in checks if one.misfiring == misfiring]
        for one in passed_ranges(those):
            seconds, action = one.seconds_to_pass, "pass without stopping"
            if seconds is not None:
                action = f"pass without stopping within {seconds:g} s"
            marking = "tachometer red, notice at each control station"
            found.append(_instruction(one.places, *one.span.rpm_outward, action, marking))
        reduced = [place for one in those for place in _reduced(one)]
        if reduced:
            highest = whole_rpm(min(place.span.low for place in reduced), math.floor)
            action, marking = f"not above {highest} rpm, reduce power", "notice at each control station"
            found.append(_instruction(reduced, highest, None, action, marking))
    return tuple(found)


def instruction_table(checks: Sequence[LimitCheck], conventions: Conventions = SI, title: str = "") -> Table:
    """Table of operating instructions from checks of limits of one model, with a note on any other restriction."""
    rows = operating_instructions(checks)
    failed = dict.fromkeys(one.limit for check in checks for one in check.verdicts if one.verdict == FAIL)
    shown = [_in_units(one, conventions) for one in rows]
    last = "No other restrictions." if rows else "No restrictions."
    if failed:
        last = f"Not to be run as it is: {listed_names(list(failed))} not kept."
    return result_table(title or "operating instructions", shown, Instruction, notes=[last])


def _passed(check: LimitCheck) -> Iterator[_Place]:
    for one in check.verdicts:
        for span in one.passed:
            yield _Place(check, one, span, _worst(check, one, span))


def _reduced(check: LimitCheck) -> Iterator[_Place]:
    for one in check.verdicts:
        if one.highest is not None:
            span = SpeedSpan(one.highest, float(check.speeds[-1]))
            yield _Place(check, one, span, _worst(check, one, span))


def _worst(check: LimitCheck, one: LimitVerdict, span: SpeedSpan) -> int:
    inside = (check.speeds >= span.low) & (check.speeds <= span.high)
    return int(np.argmax(np.where(inside, np.nan_to_num(one.utilisation), -1.0)))


def _instruction(places: Sequence[_Place], low: int, high: int | None, action: str, marking: str) -> Instruction:
    worst = max(places, key=lambda place: place.utilisation)
    check, one, at = worst.check, worst.verdict, worst.at
    conditions = tuple(dict.fromkeys(place.check.configuration for place in places))
    same = [other for other in check.verdicts if (other.limit, other.quantity) == (one.limit, one.quantity)]
    passing = [float(other.allowed[at]) for other in same if other.in_passing]
    return Instruction(
        conditions, listed_names([name or "as written" for name in conditions]), check.reference,
        max(place.verdict.tolerance for place in places), low, high, one.limit, one.criterion,
        float(one.values[at]), float(one.allowed[at]), min(passing, default=math.nan), one.unit, action, marking,
    )  # fmt: skip


def _in_units(one: Instruction, conventions: Conventions) -> Instruction:
    scale = conventions.scale(one.unit)
    return replace(
        one,
        value=one.value * scale,
        allowed=one.allowed * scale,
        allowed_in_passing=one.allowed_in_passing * scale,
        unit=conventions.unit(one.unit),
    )
