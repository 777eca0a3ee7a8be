"""Passages of a barred range of speeds, from the response to all orders along speeds that run evenly through it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.machinery.checks.limit_checks import limit_subject
from torsionnet.machinery.passage.passage_solution import passage_response
from torsionnet.machinery.verdicts.operating_instructions import PassedRange
from torsionnet.machinery.verdicts.range_passage import RangePassage
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan

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
        times = np.array([0.0, duration * (whole.high - whole.low) / (high - low)])
        for ends in ((whole.low, whole.high), (whole.high, whole.low)):
            run = passage_response(drivetrain, sensors, times, ends, speed_of=check.reference)
            passages += [
                RangePassage(check, verdict, low, high, duration, run, tuple(map(str, those)), factor)
                for verdict, those, factor in judged
            ]
    return tuple(passages)
