"""Measured half ranges beside the calculated ones, the limit curve and the barred ranges of speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table
from torsionnet.base.units import RPM
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.checks.limit_checks import limit_subject
from torsionnet.machinery.verdicts.limit_check import LimitCheck, LimitVerdict, utilisation_of
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan, spans_above
from torsionnet.model.channels import Sensor, named_sensor
from torsionnet.signals.orders.tracked_orders import TrackedOrders

KEEPS, EXCEEDS, EXCEEDS_BARRED, NOT_COVERED = "keeps the limit", "exceeds the limit", "only in barred range", "no limit"
"""Verdicts on a measured half range: below the limit at every measured speed; above it at a speed that may be run;
above it at barred speeds alone; no measured speed has a limit."""
JOINED = 1e-9
"""Relative difference up to which a measured speed belongs to the range of calculated ones."""


@dataclass(frozen=True, eq=False)
class MeasuredRangeRow:
    """Measured, calculated and allowed half range of one criterion in SI over speed in rpm, with a verdict."""

    limit: str
    criterion: str
    channel: str
    speeds: Annotated[FloatArray, Out(json="speeds_rpm")]
    measured: FloatArray
    calculated: FloatArray
    allowed: FloatArray
    verdict: str
    sentence: str


@dataclass(frozen=True, eq=False)
class MeasuredRange:
    """Measured half range of a limited quantity in SI over speed in rad/s, beside the calculated and allowed one.

    Attributes
    ----------
    limited : LimitVerdict
        The calculated side.
    channel : str
        Channel of the test.
    speeds : (n,) array
        rad/s, rising.
    measured, calculated, allowed : (n,) arrays
        In the SI unit of the limit; ``allowed`` is NaN where the rule covers no speed.
    barred : tuple of SpeedSpan
        Speeds barred by any limit in this condition.
    """

    limited: LimitVerdict
    channel: str
    speeds: FloatArray
    measured: FloatArray
    calculated: FloatArray
    allowed: FloatArray
    barred: tuple[SpeedSpan, ...] = ()

    @property
    def utilisation(self) -> FloatArray:
        """Ratio of the measured value to the value allowed, without unit, shape (n,); NaN where none is allowed."""
        return utilisation_of(self.measured, self.allowed)

    @property
    def above(self) -> tuple[SpeedSpan, ...]:
        """Ranges of speed in rad/s in which the measured value exceeds the value allowed."""
        return spans_above(self.speeds, self.measured, self.allowed)

    @property
    def _free(self) -> FloatArray:
        """Whether each measured speed may be run, as it lies in no barred range."""
        return np.array([not any(span.holds(speed) for span in self.barred) for speed in self.speeds.tolist()])

    @property
    def verdict(self) -> str:
        """Name of the verdict on the measured half range beside the limit."""
        found = self.utilisation
        if not np.isfinite(found).any():
            return NOT_COVERED
        over = np.where(np.isfinite(found), found > 1, False)
        if not over.any():
            return KEEPS
        return EXCEEDS if (over & self._free).any() else EXCEEDS_BARRED

    @property
    def sentence(self) -> str:
        """Sentence on where the measured half range is nearest to the limit, and where it passes it."""
        found = self.utilisation
        if not np.isfinite(found).any():
            return phrase("the rule covers none of the measured speeds of {channel}", channel=self.channel)
        shown = np.where(self._free, found, np.nan) if self.verdict == EXCEEDS else found
        at = int(np.nanargmax(shown))
        template = "measured at most {share:.3g} % of the limit, at {speed:.5g} rpm"
        if self.verdict != KEEPS:
            template += "; above it from {spans}" + ("" if self.verdict == EXCEEDS else ", which is barred")
        return phrase(
            template, share=100 * found[at], speed=self.speeds[at] * RPM, spans=joined(", ", map(str, self.above))
        )

    @property
    def peak_difference(self) -> float:
        """Difference of the largest half ranges, (measured - calculated)/calculated in per cent."""
        largest = float(self.calculated.max())
        return 100 * (float(self.measured.max()) / largest - 1) if largest else float("nan")

    def row(self) -> MeasuredRangeRow:
        """Measured half range as plain data for JSON, values in SI, speeds in rpm."""
        one = self.limited
        return MeasuredRangeRow(
            one.limit, one.criterion, self.channel, self.speeds * RPM, self.measured, self.calculated, self.allowed,
            self.verdict, self.sentence,
        )  # fmt: skip


def measured_range(
    check: LimitCheck, limited: LimitVerdict, channel: str, speeds: FloatArray, measured: FloatArray
) -> MeasuredRange | None:
    """Measured half range (SI) of a limit at the speeds in rad/s that the check examined; None without such a speed."""
    low, high = check.speeds[0] * (1 - JOINED), check.speeds[-1] * (1 + JOINED)
    inside = (speeds >= low) & (speeds <= high) & np.isfinite(measured)
    if not inside.any():
        return None
    at = speeds[inside]
    # A check that adds speeds has them close around maxima and crossings: straight lines between them do.
    values, allowed = (np.interp(at, check.speeds, one) for one in (limited.values, limited.allowed))
    return MeasuredRange(limited, channel, at, measured[inside], values, allowed, check.barred)


def measured_range_table(title: str, ranges: Sequence[MeasuredRange], conventions: Conventions = SI) -> Table:
    """Table of the largest measured and calculated half ranges beside the limit, with speeds in rpm and a verdict."""
    columns = (
        Column("limit"),
        Column("criterion"),
        Column("channel"),
        Column("measured", digits=5),
        Column("at", "rpm", 5),
        Column("calculated", digits=5),
        Column("at", "rpm", 5),
        Column("unit"),
        Column("difference of peaks", "%", 4),
        Column("utilisation", digits=4),
        Column("verdict"),
    )
    rows = []
    for one in ranges:
        scale, unit = conventions.scale(one.limited.unit), conventions.unit(one.limited.unit)
        first, second = int(one.measured.argmax()), int(one.calculated.argmax())
        known = one.utilisation[np.isfinite(one.utilisation)]
        peaks = (
            float(one.measured[first]) * scale, float(one.speeds[first] * RPM),
            float(one.calculated[second]) * scale, float(one.speeds[second] * RPM), unit,
        )  # fmt: skip
        worst = float(known.max()) if known.size else None
        rows.append(
            (one.limited.limit, one.limited.criterion, one.channel, *peaks, one.peak_difference, worst, one.verdict)
        )
    notes = ["half ranges (max - min)/2; differences are (measured - calculated)/calculated at the measured speeds"]
    notes += [f"{one.limited.limit}, {one.limited.criterion}: {one.sentence}" for one in ranges]
    return Table(title, columns, tuple(rows), tuple(notes))


# Measured half ranges of tracked channels beside the limits that judge them.


def measured_ranges(
    drivetrain: AssembledModel, check: LimitCheck, tracked: Sequence[TrackedOrders]
) -> tuple[MeasuredRange, ...]:
    """Measured half ranges, in the SI unit of each limit, beside the check of the same condition.

    A channel belongs to a limit if it has the name of the limited output, as a sensor of the model or written out, such
    as ``torque(shaft)``. The measured torque of a shaft becomes the stress that its limit judges, or stress is
    taken as it is.

    Parameters
    ----------
    drivetrain : Drivetrain
        In the configuration that was tested.
    check : LimitCheck
    tracked : sequence of TrackedOrders
        With half ranges.

    Raises
    ------
    UsageError
        No channel has a half range, or none belongs to a limit on a half range.
    """
    given = [one for one in tracked if one.half_range is not None]
    if not given:
        raise UsageError(
            "the file has no half ranges, which limits judge: torsionnet track writes them as columns NAME half_range"
        )
    subject = limit_subject(drivetrain.definition, drivetrain.exact_values)
    found: list[MeasuredRange] = []
    wanted: list[str] = []
    for verdict in check.verdicts:
        limit = drivetrain.definition.limits[verdict.limit].fitted(drivetrain.definition.elements)
        judged = limit.vibratory_sensors(verdict.criterion, subject) if len(verdict.values) else None
        if judged is None:
            continue
        sensors, factor = judged
        wanted += map(str, sensors)
        for one in given:
            scale = _factor(one, sensors, factor, drivetrain)
            if scale is None or one.half_range is None:
                continue
            rising = np.argsort(one.speeds, kind="stable")
            beside = measured_range(check, verdict, one.name, one.speeds[rising], one.half_range[rising] * scale)
            found += [beside] if beside else []
    if not found:
        names = ", ".join(dict.fromkeys(wanted)) or "none"
        raise UsageError(
            f"no measured half range belongs to a limit: the channels are {', '.join(one.name for one in given)}, and "
            f"limits judge the half range of {names} at {check.rpm[0]:g} to {check.rpm[-1]:g} rpm; name the channels so"
        )
    return tuple(found)


def _factor(one: TrackedOrders, sensors: Sequence[Sensor], factor: float, drivetrain: AssembledModel) -> float | None:
    """Factor from the half range of a channel to the limited value; None if the channel is of something else."""
    sensor = named_sensor(one.name, drivetrain.definition.sensors) or Sensor("angle", one.name)
    if sensor in sensors or sensor in [replace(own, at=None) for own in sensors]:  # gauges anywhere along the shaft
        return factor if one.quantity == sensor.quantity else None
    stress = any(sensor.of == own.of and own.quantity == "torque" for own in sensors)
    return 1.0 if sensor.quantity == one.quantity == "stress" and stress else None
