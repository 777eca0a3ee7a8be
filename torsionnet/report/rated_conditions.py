"""Table of a report with what limits judge at rated speed in further conditions, beside the normal one."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias, TypeVar

import numpy as np

from torsionnet.base.number_text import NumberText
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.units import RPM
from torsionnet.machinery.excitations.speed_range import SpeedRange
from torsionnet.machinery.limits.machine_angle import MachineAngleLimit
from torsionnet.machinery.orders.operating_groups import cached_total_ratio
from torsionnet.machinery.verdicts.condition_peaks import JudgedPoint
from torsionnet.machinery.verdicts.limit_check import LimitCheck
from torsionnet.machinery.verdicts.limit_checking import limits_at
from torsionnet.model.channels import Sensor
from torsionnet.report.condition_tables import component_cell, same_value
from torsionnet.report.document_tree import Cell, Heading, TableBlock, TableGroup
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_tables import merge_equal_rows
from torsionnet.report.report_text import as_words
from torsionnet.report.report_units import DIGITS, limit_number

MOST_CRITERIA, MOST_CONDITIONS = 8, 20
"""Largest number of criteria and of further conditions in the table, those of which a limit is used most."""
SAME_SPEED = 1e-9
"""Relative difference up to which a speed of a check is the rated one."""
RatedPoints: TypeAlias = dict[tuple[str, str], JudgedPoint]
"""Values at rated speed in one condition, by limit and criterion."""
Name = TypeVar("Name")
NOTE = (
    "Half ranges as limits judge them; listed are conditions and components of which a value differs by more than 5 % "
    "from normal operation. Allowed: in normal operation, for continuous operation; what follows the mean torque is "
    "judged by that of the condition."
)


def rated_elsewhere(subject: ReportData) -> TableBlock | None:
    """Table of the values at rated speed in further conditions, of components in which one differs from the normal.

    None where none does, or rated speed is not in the range.
    """
    peaks = subject.normal_peaks
    if peaks is None or peaks.rated is None or subject.limit_conclusion is None:
        return None
    normal, speed = _points(peaks.points, peaks.rated), float(peaks.points.speeds[peaks.rated])
    checks = [check for check in subject.limit_conclusion.checks if check.configuration != peaks.check.configuration]
    others = {check.configuration: points for check in checks if (points := _at(subject, check, speed))}
    # Components in which a condition differs from the normal one, the most used first.
    used = {name: max(_used(those, name) for those in (normal, *others.values())) for name in normal}
    differing = [name for name in normal if any(_differs(those, normal, name) for those in others.values())]
    shown = _most_used(differing, used, MOST_CRITERIA)
    strongest = {key: max((_used(those, name) for name in shown), default=0.0) for key, those in others.items()}
    # Conditions that differ in none of the components shown have no row.
    apart = [key for key, those in others.items() if any(_differs(those, normal, name) for name in shown)]
    if not apart:
        return None
    kept = _most_used(apart, strongest, MOST_CONDITIONS)
    columns = (
        Heading("Condition"),
        *(Heading(component_cell(subject, normal[name].verdict), numeric=True) for name in shown),
        Heading("Used most", "%", numeric=True),
    )
    allowed = [limit_number(normal[name].continuous, normal[name].verdict.unit, subject.conventions) for name in shown]
    rows: list[tuple[Cell, ...]] = [(phrase("Allowed"), *allowed, "")]
    for key, those in ((peaks.check.configuration, normal), *((key, others[key]) for key in kept)):
        values = [_number(subject, those.get(name)) for name in shown]
        most = max(_used(those, name) for name in shown)
        rows.append((subject.titles.of(key), *values, NumberText(100 * most, DIGITS)))
    caption = phrase("Components at rated speed, {speed:.6g} rpm, by condition", speed=speed * RPM)
    groups = (TableGroup(merge_equal_rows(rows)),)
    return TableBlock((caption,), columns, groups, ((NOTE,),), len(apart) - len(kept))


def _most_used(names: Sequence[Name], used: Mapping[Name, float], most: int) -> list[Name]:
    """The names that use most, in their order."""
    return sorted(sorted(names, key=lambda name: -used[name])[:most], key=names.index)


def _differs(points: RatedPoints, normal: RatedPoints, name: tuple[str, str]) -> bool:
    """Whether a criterion has another value than in the normal condition."""
    return name in points and not same_value(points[name].value, normal[name].value)


def _points(check: LimitCheck, at: int) -> RatedPoints:
    """Values of every criterion for continuous operation at one speed of a check, by limit and criterion."""
    return {
        (verdict.limit, verdict.criterion): JudgedPoint(check, verdict, at)
        for verdict in check.verdicts
        if not verdict.in_passing and len(verdict.values) and math.isfinite(verdict.values[at])
    }


def _at(subject: ReportData, check: LimitCheck, speed: float) -> RatedPoints:
    """Values of a condition at a speed in rad/s; none where it does not run there."""
    if not check.speeds[0] * (1 - SAME_SPEED) <= speed <= check.speeds[-1] * (1 + SAME_SPEED):
        return {}
    at = int(np.argmin(abs(check.speeds - speed)))
    if abs(check.speeds[at] / speed - 1) > SAME_SPEED:
        check, at = limits_at(subject.judged_case(check).drivetrain, np.array([speed])), 0
    return _points(check, at)


def _used(points: RatedPoints, name: tuple[str, str]) -> float:
    """Utilisation of a criterion; 0 without a limit there."""
    share = points[name].utilisation if name in points else 0.0
    return 0.0 if math.isnan(share) else share


def _number(subject: ReportData, point: JudgedPoint | None) -> Cell:
    return "" if point is None else limit_number(point.value, point.verdict.unit, subject.conventions)


def cyclic_irregularities(subject: ReportData) -> Iterator[str]:
    """Yield the sentence on the cyclic irregularity of each generator at rated speed in the conditions that run there.

    It is (w_max - w_min)/w_mean of the rotor's speed over a cycle, twice the half range of all orders over the mean.
    """
    speeds = subject.model.definition.speeds
    generators = [limit for limit in subject.model.definition.limits.values() if isinstance(limit, MachineAngleLimit)]
    if speeds is None or speeds.rated is None:
        return
    for node in dict.fromkeys(limit.node for limit in generators):
        conditions_by_irregularity: dict[str, list[str]] = {}
        for case in subject.judged_cases[: MOST_CONDITIONS + 1]:
            if not _runs_at(case.drivetrain.definition.speeds, speeds.rated):
                continue
            run = case.drivetrain.order_response(Sensor("velocity", node), speeds=np.array([speeds.rated]))
            mean = speeds.rated * abs(float(cached_total_ratio(case.drivetrain, node, run.reference)))
            # delta = (w_max - w_min)/w_mean, said as 1/300: the inverse is what is written.
            if swing := 2 * float(run.half_range[0, 0]):
                conditions_by_irregularity.setdefault(f"1/{NumberText(mean / swing, DIGITS)}", []).append(
                    case.configuration
                )
        known = [name for names in conditions_by_irregularity.values() for name in names]
        each = [
            phrase("{value} in {conditions}", value=share, conditions=where) if where else share
            for share, names in conditions_by_irregularity.items()
            for where in [subject.titles.several(names, known)]
        ]
        if each:
            yield phrase(
                "Cyclic irregularity of {node} at {speed:.6g} rpm, (ω_max − ω_min)/ω_mean of all orders: {values}.",
                node=as_words(node),
                speed=speeds.rated * RPM,
                values=joined("; ", each),
            )


def _runs_at(speeds: SpeedRange | None, speed: float) -> bool:
    return speeds is not None and speeds.values[0] * (1 - SAME_SPEED) <= speed <= speeds.values[-1] * (1 + SAME_SPEED)
