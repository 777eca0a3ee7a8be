"""Measured half ranges beside the calculated ones, the limit curve and the barred ranges of speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.base.units import RPM
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.checks.section_checks import limit_subject
from torsionnet.machinery.verdicts.limit_check import LimitCheck
from torsionnet.machinery.verdicts.limit_verdict import LimitVerdict
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan, spans_above, utilisation_of
from torsionnet.model.channels import Sensor, named_sensor
from torsionnet.signals.orders.tracked_orders import TrackedOrders

KEEPS, EXCEEDS, EXCEEDS_BARRED, NOT_COVERED = "keeps the limit", "exceeds the limit", "only in barred range", "no limit"
"""Verdicts on a measured half range: below the limit at every measured speed; above it at a speed that may be run;
above it at barred speeds alone; no measured speed has a limit."""
JOINED = 1e-9
"""Relative difference up to which a measured speed belongs to the range of calculated ones."""


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

    SHOWN: ClassVar = (
        "limited.limit", "limited.criterion", "channel", "rpm", "measured", "calculated", "allowed", "verdict",
        "sentence", "largest_measured", "rpm_measured", "largest_calculated", "rpm_calculated", "unit",
        "peak_difference", "largest_utilisation",
    )  # fmt: skip

    limited: LimitVerdict
    channel: Annotated[str, Out("channel")]
    speeds: FloatArray
    measured: FloatArray
    calculated: FloatArray
    allowed: FloatArray
    barred: tuple[SpeedSpan, ...] = ()

    @property
    def rpm(self) -> Annotated[FloatArray, Out(json="speeds_rpm")]:
        """Measured speeds in r/min, shape (n,)."""
        return np.asarray(self.speeds * RPM)

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
    def verdict(self) -> Annotated[str, Out("verdict")]:
        """Name of the verdict on the measured half range beside the limit."""
        utilisation = self.utilisation
        if not np.isfinite(utilisation).any():
            return NOT_COVERED
        over = np.where(np.isfinite(utilisation), utilisation > 1, False)
        if not over.any():
            return KEEPS
        return EXCEEDS if (over & self._free).any() else EXCEEDS_BARRED

    @property
    def sentence(self) -> str:
        """Sentence on where the measured half range is nearest to the limit, and where it passes it."""
        utilisation = self.utilisation
        if not np.isfinite(utilisation).any():
            return phrase("the rule covers none of the measured speeds of {channel}", channel=self.channel)
        shown = np.where(self._free, utilisation, np.nan) if self.verdict == EXCEEDS else utilisation
        at = int(np.nanargmax(shown))
        template = "measured at most {share:.3g} % of the limit, at {speed:.5g} rpm"
        if self.verdict != KEEPS:
            template += "; above it from {spans}" + ("" if self.verdict == EXCEEDS else ", which is barred")
        return phrase(
            template, share=100 * utilisation[at], speed=self.speeds[at] * RPM, spans=joined(", ", map(str, self.above))
        )

    @property
    def unit(self) -> Annotated[str, Out("unit", json=None, unit_of="unit")]:
        """SI unit of the half ranges."""
        return self.limited.unit

    @property
    def largest_measured(self) -> Annotated[float, Out("measured", json=None, digits=5, unit_of="unit")]:
        """Largest measured half range in SI."""
        return float(self.measured.max())

    @property
    def rpm_measured(self) -> Annotated[float, Out("at", "rpm", json=None, digits=5)]:
        """Speed in rpm of the largest measured half range."""
        return float(self.rpm[self.measured.argmax()])

    @property
    def largest_calculated(self) -> Annotated[float, Out("calculated", json=None, digits=5, unit_of="unit")]:
        """Largest calculated half range in SI at the measured speeds."""
        return float(self.calculated.max())

    @property
    def rpm_calculated(self) -> Annotated[float, Out("at", "rpm", json=None, digits=5)]:
        """Speed in rpm of the largest calculated half range."""
        return float(self.rpm[self.calculated.argmax()])

    @property
    def largest_utilisation(self) -> Annotated[float | None, Out("utilisation", json=None, digits=4)]:
        """Largest ratio of the measured value to the value allowed; None where no speed has a finite one."""
        known = self.utilisation[np.isfinite(self.utilisation)]
        return float(known.max()) if known.size else None

    @property
    def peak_difference(self) -> Annotated[float, Out("difference of peaks", "%", json=None, digits=4)]:
        """Difference of the largest half ranges, (measured - calculated)/calculated in per cent."""
        largest = self.largest_calculated
        return 100 * (self.largest_measured / largest - 1) if largest else float("nan")


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
    values, allowed = (np.interp(at, check.speeds, curve) for curve in (limited.values, limited.allowed))
    return MeasuredRange(limited, channel, at, measured[inside], values, allowed, check.barred)


def measured_range_table(title: str, ranges: Sequence[MeasuredRange], conventions: Conventions = SI) -> Table:
    """Table of the largest measured and calculated half ranges beside the limit, with speeds in rpm and a verdict."""
    columns = (
        "limited.limit", "limited.criterion", "channel", "largest_measured", "rpm_measured", "largest_calculated",
        "rpm_calculated", "unit", "peak_difference", "largest_utilisation", "verdict",
    )  # fmt: skip
    notes = ["half ranges (max - min)/2; differences are (measured - calculated)/calculated at the measured speeds"]
    notes += [f"{measured.limited.limit}, {measured.limited.criterion}: {measured.sentence}" for measured in ranges]
    return result_table(title, ranges, MeasuredRange, columns, conventions, notes)


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
    given = [orders for orders in tracked if orders.half_range is not None]
    if not given:
        raise UsageError(
            "the file has no half ranges, which limits judge: torsionnet track writes them as columns NAME half_range",
            kind="missing-column",
        )
    subject = limit_subject(drivetrain.definition, drivetrain.exact_values)
    ranges: list[MeasuredRange] = []
    wanted: list[str] = []
    for verdict in check.verdicts:
        limit = drivetrain.definition.limits[verdict.limit].fitted(drivetrain.definition.elements)
        judged = limit.vibratory_sensors(verdict.criterion, subject) if len(verdict.values) else None
        if judged is None:
            continue
        sensors, factor = judged
        wanted += map(str, sensors)
        for orders in given:
            scale = _factor(orders, sensors, factor, drivetrain)
            if scale is None or orders.half_range is None:
                continue
            # A run-down is measured from high speeds to low ones; the ranges above the limit need rising speeds.
            rising = np.argsort(orders.speeds, kind="stable")
            beside = measured_range(
                check, verdict, orders.name, orders.speeds[rising], orders.half_range[rising] * scale
            )
            ranges += [beside] if beside else []
    if not ranges:
        names = ", ".join(dict.fromkeys(wanted)) or "none"
        channels = ", ".join(orders.name for orders in given)
        raise UsageError(
            f"no measured half range belongs to a limit: the channels are {channels}, and "
            f"limits judge the half range of {names} at {check.rpm[0]:g} to {check.rpm[-1]:g} rpm; name the channels "
            "so",
            kind="unlike-results",
        )
    return tuple(ranges)


def _factor(
    channel: TrackedOrders, sensors: Sequence[Sensor], factor: float, drivetrain: AssembledModel
) -> float | None:
    """Factor from the half range of a channel to the limited value; None if the channel is of something else."""
    sensor = named_sensor(channel.name, drivetrain.definition.sensors) or Sensor("angle", channel.name)
    if sensor in sensors or sensor in [replace(own, at=None) for own in sensors]:  # gauges anywhere along the shaft
        return factor if channel.quantity == sensor.quantity else None
    stress = any(sensor.of == own.of and own.quantity == "torque" for own in sensors)
    return 1.0 if sensor.quantity == channel.quantity == "stress" and stress else None
