"""Passage of a barred range of speeds, slowly and quickly, upwards and downwards, against the limit that bars it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.checks.section_checks import limit_subject
from torsionnet.machinery.mean.mean_solution import means_of
from torsionnet.machinery.passage.passage_response import PassageResponse
from torsionnet.machinery.passage.passage_solution import passage_response
from torsionnet.machinery.verdicts.limit_check import LimitCheck
from torsionnet.machinery.verdicts.limit_verdict import LimitVerdict
from torsionnet.machinery.verdicts.operating_instructions import PassedRange
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan
from torsionnet.model.channels import Sensor

TOTALS = ("T_Kmax", "twist", "tau_F")
"""Criteria of limits on the mean value and vibration together, which hold while a speed is passed."""
KEPT, EXCEEDED, NOT_LIMITED = "kept", "exceeded", "no limit"
"""Words for the outcome of a passage, limit in passing kept, limit in passing exceeded, no such limit; the last where
the rule has none."""


@dataclass(frozen=True, eq=False)
class RangePassage:
    """Passage of a barred range at an even rate in a given time, from a steady start outside of it.

    Attributes
    ----------
    check : LimitCheck
    verdict : LimitVerdict
        The limit that bars the range, or one on mean and vibration together that holds in passing.
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
    mean : (n_speeds,) array, optional
        Size of the mean part of the value at the speeds of the check, in SI; None where vibration alone is judged.
    """

    SHOWN: ClassVar = (
        "named", "direction", "seconds", "rpm", "largest", "steady", "allowed_there", "in_passing", "unit",
        "cycles", "seconds_above", "outcome",
    )  # fmt: skip

    check: LimitCheck
    verdict: LimitVerdict
    low: float
    high: float
    seconds: Annotated[float, Out("time", "s")]
    response: PassageResponse
    sensors: tuple[str, ...]
    factor: float
    mean: FloatArray | None = None

    @property
    def unit(self) -> Annotated[str, Out("unit", unit_of="unit")]:
        """SI unit of the value that the limit judges."""
        return self.verdict.unit

    @property
    def named(self) -> Annotated[str, Out("limit")]:
        """Name of the limit, with its criterion where it has several, or that is one on mean and vibration together."""
        own = self.verdict
        steady = (verdict for verdict in self.check.verdicts if verdict.limit == own.limit and not verdict.in_passing)
        several = len({verdict.criterion for verdict in steady if verdict.orders is not None}) > 1
        return f"{own.limit} {own.criterion}" if several or own.in_passing else own.limit

    @property
    def is_upward(self) -> bool:
        return bool(self.response.speeds[-1] > self.response.speeds[0])

    @property
    def direction(self) -> Annotated[str, Out("direction")]:
        """Direction of the passage, ``up`` or ``down``."""
        return "up" if self.is_upward else "down"

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
        """Value that the limit allows in continuous operation, in SI, at each time of the passage, shape (n_t,).

        NaN where the limit holds in passing as well and says none.
        """
        if self.verdict.in_passing:
            return np.full(len(self.response.times), math.nan)
        return self._at_speeds(self.verdict.allowed)

    @property
    def allowed_in_passing(self) -> FloatArray:
        """Value that the limit allows during a passage, in SI, at each time of the passage, shape (n_t,).

        NaN where the limit says none.
        """
        others = [verdict.allowed for verdict in self._in_passing]
        if not others:
            return np.full(len(self.response.times), math.nan)
        return self._at_speeds(np.min(others, axis=0))

    @property
    def criterion_in_passing(self) -> str:
        """Name of the criterion that limits the passage; empty where there is none."""
        return ", ".join(verdict.criterion for verdict in self._in_passing)

    @property
    def _in_passing(self) -> list[LimitVerdict]:
        """Verdicts on those criteria of the barring limit that hold even while its barred range is passed."""
        own = self.verdict
        return [
            verdict
            for verdict in self.check.verdicts
            if verdict.in_passing
            and (verdict.limit, verdict.unit, verdict.quantity) == (own.limit, own.unit, own.quantity)
        ]

    def _at_speeds(self, over_speed: FloatArray) -> FloatArray:
        return np.interp(self.response.speeds, self.check.speeds, over_speed)

    @cached_property
    def _envelope(self) -> tuple[FloatArray, FloatArray]:
        """Times in s, and the value that the limit judges at each, in its SI unit, both (n,)."""
        times, sizes = self.response.envelope(self.output)
        values = self.factor * sizes
        if self.mean is not None:
            # |T_mean| + T_v: the mean torque is that of steady operation at the speed of each time.
            values = values + np.interp(times, self.response.times, self._at_speeds(self.mean))
        return times, values

    @cached_property
    def _largest_inside(self) -> tuple[float, float]:
        """Time in s and size in SI of the largest value in the range, as it is marked in whole rpm.

        Of all values where one outside of it, while vibration dies away, is above what is allowed in passing.
        """
        times, values = self._envelope
        inside = self._inside(times)
        counted = np.where(inside, values, 0.0)
        if np.any(self._over_passing & ~inside) and not np.any(self._over_passing & inside):
            counted = values
        at = int(np.argmax(counted))
        return float(times[at]), float(counted[at])

    def _inside(self, times: FloatArray) -> NDArray[np.bool_]:
        """Whether the speed at each time lies in the range as it is marked, outward to 1 rpm."""
        low, high = SpeedSpan(self.low, self.high).rpm_outward
        rpm = np.interp(times, self.response.times, self.response.rpm)
        return np.asarray((rpm >= low) & (rpm <= high))

    @property
    def _over_passing(self) -> NDArray[np.bool_]:
        """Whether the value is above what is allowed in passing at each time of the envelope."""
        times, values = self._envelope
        return np.asarray(values > np.interp(times, self.response.times, self.allowed_in_passing))

    @cached_property
    def beyond(self) -> tuple[float, float, float] | None:
        """Speed in rpm, value and value of steady vibration there in SI, outside of the range.

        The largest one above what is allowed in continuous operation, while vibration dies away; None where it is not.
        """
        times, values = self._envelope
        allowed = np.interp(times, self.response.times, self.allowed)
        rpm = np.interp(times, self.response.times, self.response.rpm)
        steady = np.interp(rpm, self.check.rpm, self.verdict.values)
        # What steady vibration exceeds, too, is another range to be barred.
        over = np.where((values > allowed) & (steady <= allowed) & ~self._inside(times), values, 0.0)
        at = int(np.argmax(over))
        return (float(rpm[at]), float(over[at]), float(steady[at])) if over[at] else None

    @property
    def rpm(self) -> Annotated[float, Out("speed", "rpm", digits=4)]:
        """Speed in rpm at which the value is largest in the range while it is passed."""
        return float(np.interp(self._largest_inside[0], self.response.times, self.response.rpm))

    @property
    def largest(self) -> Annotated[float, Out("largest value", digits=4, unit_of="unit")]:
        """Largest value that the limit judges in the range, in its SI unit: a half range, or with its mean."""
        return self._largest_inside[1]

    @property
    def steady(self) -> Annotated[float, Out("steady", digits=4, unit_of="unit")]:
        """Largest value of steady vibration in the range, in SI."""
        inside = (self.check.speeds >= self.low) & (self.check.speeds <= self.high)
        return float(self.verdict.values[inside].max(initial=0.0))

    @property
    def allowed_there(self) -> Annotated[float | None, Out("allowed", digits=4, unit_of="unit")]:
        """Value in SI that the limit allows in continuous operation where the passage has its largest value.

        None where the limit says none.
        """
        return self._there(self.allowed)

    @property
    def in_passing(self) -> Annotated[float | None, Out("in passing", digits=4, unit_of="unit")]:
        """Value in SI that the limit allows in passing there; None where the limit says none."""
        return self._there(self.allowed_in_passing)

    def _there(self, over_time: FloatArray) -> float | None:
        amount = float(np.interp(self._largest_inside[0], self.response.times, over_time))
        return amount if math.isfinite(amount) else None

    @property
    def cycles(self) -> Annotated[float | None, Out("cycles above allowed")]:
        """Number of cycles of vibration above the value allowed in continuous operation; None where none is."""
        if self.verdict.in_passing:
            return None
        # The response counts cycles in the unit of its sensor.
        return self.response.cycles_above(self.allowed / self.factor, self.output)

    @property
    def seconds_above(self) -> Annotated[float | None, Out("time above", "s", digits=3)]:
        """Time in s in which the half range is above the value allowed in continuous operation; None where none is."""
        if self.verdict.in_passing:
            return None
        return self.response.seconds_above(self.allowed / self.factor, self.output)

    @property
    def outcome(self) -> Annotated[str, Out("limit in passing")]:
        """Outcome of the passage, whether the limit in passing is kept, or that there is none."""
        if self.in_passing is None:
            return NOT_LIMITED
        return EXCEEDED if self._over_passing.any() else KEPT


def passage_table(
    passages: Sequence[RangePassage], conventions: Conventions = SI, barred: PassedRange | None = None
) -> Table:
    """Table of passages of one barred range with a row for each time and direction, in the units shown.

    Limits of ``barred`` on mean and vibration together that are in no passage have a row with their steady value.
    """
    table = result_table("passage of a barred range", passages, RangePassage, conventions=conventions)
    judged = [passage.verdict for passage in passages]
    steady = [verdict for verdict in totals_in_passing(barred) if verdict not in judged] if barred else []
    return replace(
        table, rows=(*table.rows, *(_steady_row(barred, verdict, conventions) for verdict in steady if barred))
    )


def _steady_row(barred: PassedRange, verdict: LimitVerdict, conventions: Conventions) -> tuple[object, ...]:
    """Row of a limit whose steady value is the largest that is known while a range is passed."""
    speeds = barred.check.speeds
    inside = (speeds >= barred.span.low) & (speeds <= barred.span.high)
    at = int(np.argmax(np.where(inside, verdict.utilisation, -1.0)))
    scale = conventions.scale(verdict.unit)
    value, allowed = (float(values[at]) for values in (verdict.values, verdict.allowed))
    return (
        f"{verdict.limit} {verdict.criterion}", "steady", None, float(barred.check.rpm[at]), None, value * scale, None,
        allowed * scale, conventions.unit(verdict.unit), None, None, EXCEEDED if value > allowed else KEPT,
    )  # fmt: skip


# Passages of a barred range of speeds, from the response to all orders along speeds that run evenly through it.

RUN_UP_SHARE = 0.25
"""Share of the width of a barred range by which a passage begins before it and ends behind it, where vibration is small
and steady."""


def range_passages(
    drivetrain: AssembledModel, barred: PassedRange, seconds: Sequence[float]
) -> tuple[RangePassage, ...]:
    """Passages of a barred range up and down in given times in s, judged by each barring limit.

    Limits on mean and vibration together, as T_Kmax of couplings, hold in passing and judge them, too. Speeds run
    evenly, and begin and end a quarter of the range outside of it, as far as speeds are examined there.
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
    judged: list[tuple[LimitVerdict, list[Sensor], float, FloatArray | None]] = []
    # Springs and dampers in place of hysteretic laws are equal to these at the resonance of the barring limit alone:
    # there a coupling of another resonance keeps the steady value.
    totals = () if drivetrain.assembly.system.dynamic else totals_in_passing(barred)
    for verdict in (*barred.verdicts, *totals):
        limit = drivetrain.definition.limits[verdict.limit].fitted(drivetrain.definition.elements)
        asked = limit.passing_sensors if verdict.in_passing else limit.vibratory_sensors
        sensors_and_factor = asked(verdict.criterion, subject)
        if sensors_and_factor is not None:
            mean = None
            if verdict.in_passing:
                values = means_of(drivetrain, sensors_and_factor[0][0], check.speeds).values[:, 0]
                mean = np.asarray(sensors_and_factor[1] * np.abs(values))
            judged.append((verdict, *sensors_and_factor, mean))
    sensors = list(dict.fromkeys(sensor for _, those, *_ in judged for sensor in those))
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
                RangePassage(check, verdict, low, high, duration, run, tuple(map(str, those)), factor, mean)
                for verdict, those, factor, mean in judged
            ]
    return tuple(passages)


def totals_in_passing(barred: PassedRange) -> tuple[LimitVerdict, ...]:
    """Verdicts on mean and vibration together, such as T_Kmax of couplings, which hold while a range is passed."""
    return tuple(verdict for verdict in barred.check.verdicts if verdict.criterion in TOTALS and len(verdict.values))
