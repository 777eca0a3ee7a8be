"""Measured half ranges of tracked channels beside the limits that judge them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.machinery.checks.limit_checks import limit_subject
from torsionnet.machinery.verdicts.limit_check import LimitCheck
from torsionnet.machinery.verdicts.measured_range import MeasuredRange, measured_range
from torsionnet.model.channels import Sensor, named_sensor
from torsionnet.signals.orders.tracked_orders import TrackedOrders


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
