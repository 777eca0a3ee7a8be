"""Passage of a barred range of speeds, slowly and quickly, upwards and downwards, against the limit that bars it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated

import numpy as np

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.checks.limit_checks import limit_subject
from torsionnet.machinery.passage.passage_response import PassageResponse
from torsionnet.machinery.passage.passage_solution import passage_response
from torsionnet.machinery.verdicts.limit_check import LimitCheck, LimitVerdict
from torsionnet.machinery.verdicts.operating_instructions import PassedRange
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan

KEPT, EXCEEDED, NOT_LIMITED = "kept", "exceeded", "no limit"
"""Words for the outcome of a passage, limit in passing kept, limit in passing exceeded, no such limit; the last where
the rule has none."""


@dataclass(frozen=True, eq=False)
class PassageRow:
    """Passage of a barred range with its largest value in SI, and how often and how long the limit is exceeded."""

    limit: Annotated[str, Out("limit")]
    direction: Annotated[str, Out("direction")]
    seconds: Annotated[float, Out("time", "s")]
    rpm: Annotated[float, Out("speed", "rpm", digits=4)]
    peak: Annotated[float, Out("largest value", digits=4)]
    steady: Annotated[float, Out("steady", digits=4)]
    allowed: Annotated[float, Out("allowed", digits=4)]
    in_passing: Annotated[float | None, Out("in passing", digits=4)]
    unit: Annotated[str, Out("unit")]
    cycles: Annotated[float, Out("cycles above allowed")]
    seconds_above: Annotated[float, Out("time above", "s", digits=3)]
    verdict: Annotated[str, Out("limit in passing")]


@dataclass(frozen=True, eq=False)
class RangePassage:
    """Passage of a barred range at an even rate in a given time, from a steady start outside of it.

    Attributes
    ----------
    check : LimitCheck
    verdict : LimitVerdict
        The limit that bars the range.
    low, high : float
        Ends of the range, rad/s.
    seconds : float
        From one end to the other.
    response : PassageResponse
        Of the sensors of all limits that bar the range.
    sensors : tuple of str
        Names of those of this limit.
    factor : float
        Value of the limit over the reading of a sensor, both in SI.
    """

    check: LimitCheck
    verdict: LimitVerdict
    low: float
    high: float
    seconds: float
    response: PassageResponse
    sensors: tuple[str, ...]
    factor: float

    @property
    def is_upward(self) -> bool:
        return bool(self.response.speeds[-1] > self.response.speeds[0])

    @cached_property
    def output(self) -> str:
        """Name of the sensor with the largest value along the passage."""
        return max(self.sensors, key=lambda name: self.response.peak(name).half_range)

    @property
    def values(self) -> FloatArray:
        """Vibration that the limit judges, in its SI unit, over the time of the passage, shape (n_t,)."""
        return np.asarray(self.factor * self.response.of(self.output))

    @property
    def allowed(self) -> FloatArray:
        """Value that the limit allows in continuous operation, in SI, at each time of the passage, shape (n_t,)."""
        return self._at_speeds(self.verdict.allowed)

    @property
    def allowed_in_passing(self) -> FloatArray:
        """Value that the limit allows during a passage, in SI, at each time of the passage, shape (n_t,).

        NaN where the limit says none.
        """
        others = [one.allowed for one in self._in_passing]
        if not others:
            return np.full(len(self.response.times), math.nan)
        return self._at_speeds(np.min(others, axis=0))

    @property
    def criterion_in_passing(self) -> str:
        """Name of the criterion that limits the passage; empty where there is none."""
        return ", ".join(one.criterion for one in self._in_passing)

    @property
    def _in_passing(self) -> list[LimitVerdict]:
        """Verdicts on those criteria of the barring limit that hold even while its barred range is passed."""
        own = self.verdict
        return [
            one
            for one in self.check.verdicts
            if one.in_passing and (one.limit, one.unit, one.quantity) == (own.limit, own.unit, own.quantity)
        ]

    def _at_speeds(self, over_speed: FloatArray) -> FloatArray:
        return np.interp(self.response.speeds, self.check.speeds, over_speed)

    @property
    def row(self) -> PassageRow:
        """Plain data of a passage, with its largest value in SI, and cycles and time in s above the value allowed."""
        run, name = self.response, self.output
        peak = run.peak(name)
        times, sizes = run.envelope(name)
        value = self.factor * peak.half_range
        allowed, passing = (
            float(np.interp(peak.time, run.times, line)) for line in (self.allowed, self.allowed_in_passing)
        )
        over = self.factor * sizes > np.interp(times, run.times, self.allowed_in_passing)
        inside = (self.check.speeds >= self.low) & (self.check.speeds <= self.high)
        limited = math.isfinite(passing)
        # The response counts cycles in the unit of its sensor.
        level = self.allowed / self.factor
        return PassageRow(
            self.verdict.limit,
            "up" if self.is_upward else "down", self.seconds, peak.rpm, value,
            float(self.verdict.values[inside].max(initial=0.0)), allowed, passing if limited else None,
            self.verdict.unit, run.cycles_above(level, name), run.seconds_above(level, name),
            (EXCEEDED if over.any() else KEPT) if limited else NOT_LIMITED,
        )  # fmt: skip


def passage_table(passages: Sequence[RangePassage], conventions: Conventions = SI) -> Table:
    """Table of passages of one barred range with a row for each time and direction, in the units shown."""
    rows = []
    for one in passages:
        row = one.row
        scale = conventions.scale(row.unit)
        passing = None if row.in_passing is None else row.in_passing * scale
        peak, steady, allowed = row.peak * scale, row.steady * scale, row.allowed * scale
        shown = conventions.unit(row.unit)
        rows.append(replace(row, peak=peak, steady=steady, allowed=allowed, in_passing=passing, unit=shown))
    return result_table("passage of a barred range", rows, PassageRow)


# Passages of a barred range of speeds, from the response to all orders along speeds that run evenly through it.

RUN_UP_SHARE = 0.25
"""Share of the width of a barred range by which a passage begins before it and ends behind it, where vibration is small
and steady."""


def range_passages(
    drivetrain: AssembledModel, barred: PassedRange, seconds: Sequence[float]
) -> tuple[RangePassage, ...]:
    """Passages of a barred range up and down in given times in s, judged by each barring limit.

    Speeds run evenly, and begin and end a quarter of the range outside of it, as far as speeds are examined there.
    Empty where no limit judges a vibratory value, as those of heat.

    Parameters
    ----------
    drivetrain : AssembledModel
        In the configuration of the check of the range.
    barred : PassedRange
    seconds : sequence of float
        s, from one end of the range to the other.
    """
    check = barred.check
    subject = limit_subject(drivetrain.definition, drivetrain.exact_values)
    judged = []
    for verdict in barred.verdicts:
        limit = drivetrain.definition.limits[verdict.limit].fitted(drivetrain.definition.elements)
        found = limit.vibratory_sensors(verdict.criterion, subject)
        judged += [] if found is None else [(verdict, *found)]
    sensors = list(dict.fromkeys(sensor for _, those, _ in judged for sensor in those))
    if not sensors:
        return ()
    low, high = barred.span.low, barred.span.high
    wide = RUN_UP_SHARE * (high - low)
    whole = SpeedSpan(low - wide, high + wide).within(SpeedSpan(float(check.speeds[0]), float(check.speeds[-1])))
    passages = []
    for duration in seconds:
        # The rate of the barred range itself, also along the run-up beside it.
        times = np.array([0.0, duration * (whole.high - whole.low) / (high - low)])
        for ends in ((whole.low, whole.high), (whole.high, whole.low)):
            run = passage_response(drivetrain, sensors, times, ends, speed_of=check.reference)
            passages += [
                RangePassage(check, verdict, low, high, duration, run, tuple(map(str, those)), factor)
                for verdict, those, factor in judged
            ]
    return tuple(passages)
