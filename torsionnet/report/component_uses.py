"""Components of a drivetrain with the criteria nearest to what is allowed, also at rated speed in other conditions."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias, TypeVar

import numpy as np

from torsionnet.base.conventions import Conventions
from torsionnet.base.entries.spec import not_none
from torsionnet.base.number_text import NumberText
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.units import RPM
from torsionnet.machinery.excitations.engine_entries import EngineEntries
from torsionnet.machinery.excitations.speed_range import SpeedRange
from torsionnet.machinery.limits import Limit
from torsionnet.machinery.limits.coupling import DamperLimit
from torsionnet.machinery.limits.curve import CurveLimit
from torsionnet.machinery.limits.machine_angle import MachineAngleLimit
from torsionnet.machinery.limits.shaft_limit import in_all_words
from torsionnet.machinery.orders.operating_groups import cached_total_ratio
from torsionnet.machinery.verdicts.condition_peaks import ConditionPeaks, JudgedPoint
from torsionnet.machinery.verdicts.limit_check import LimitCheck
from torsionnet.machinery.verdicts.limit_checking import limits_at
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion, WorstLimit
from torsionnet.machinery.verdicts.limit_verdict import RuleSymbol, RuleWords
from torsionnet.model.channels import Sensor, named_sensor
from torsionnet.model.definition import Definition
from torsionnet.model.elements import Shaft
from torsionnet.report.condition_tables import component_cell, same_value
from torsionnet.report.document_tree import Cell, Heading, TableBlock, TableGroup
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_tables import merge_equal_rows
from torsionnet.report.report_text import DIGITS, as_words, engineering_unit, limit_number, limit_scale

# Components of a drivetrain with each criterion of each limit where its value is nearest to what is allowed.

GROUPS = {
    "shafts": ("iacs_m68", "generating_set_shaft", "fatigue"),
    "crankshaft": (),
    "couplings": ("coupling",),
    "gears": ("gear",),
    "dampers": ("damper",),
    "generators": ("machine_angle",),
    "other components": ("curve",),
}
"""Rules of limits, by the kind of component that they are for, in the order of the report."""
CRITERIA: dict[str, RuleWords] = {
    **dict.fromkeys(in_all_words("tau_C"), ("stress, continuous operation",)),
    **dict.fromkeys(in_all_words("tau_T"), ("stress, quick passage",)),
    "tau_W": ("stress against fatigue",),
    "tau_F": ("stress against yield",),
    "continuous": ("half range, continuous operation",),
    "in passing": ("half range, quick passage",),
    "T_v": ("vibratory torque",),
    "hammer": ("vibratory against mean torque, reversal of tooth load",),
    "T_KN": ("mean torque, ", RuleSymbol("T", "KN")),
    "T_KW": ("vibratory torque, ", RuleSymbol("T", "KW")),
    "T_Kmax": ("mean and vibratory torque, ", RuleSymbol("T", "Kmax")),
    "P_KV": ("power loss, ", RuleSymbol("P", "KV")),
    "P": ("power loss",),
    "temperature": ("temperature above ambient",),
    "twist": ("mean and vibratory twist",),
    "vibratory twist": ("vibratory twist",),
    "electrical angle": ("electrical angle",),
}
"""Words for what is compared, by the criterion of a limit."""


@dataclass(frozen=True)
class ComponentUse:
    """Value of a component beside the value allowed, in units of engineers, at rated speed and at its worst.

    Attributes
    ----------
    group : str
        Kind of component, a key of ``GROUPS``.
    worst : WorstLimit
        Limit and criterion with the speed and the condition.
    what : tuple of str and RuleSymbol
        What is compared.
    value, allowed : float or None
        At the worst speed and condition; None where it was not judged.
    unit : str
    rated_value, rated_allowed : float or None
        At rated speed in the normal condition; None where that was not judged, NaN where no value is allowed there.
    """

    group: str
    worst: WorstLimit
    what: RuleWords
    value: float | None = None
    allowed: float | None = None
    unit: str = ""
    rated_value: float | None = None
    rated_allowed: float | None = None

    @property
    def rated_utilisation(self) -> float | None:
        """Ratio of value to allowed value at rated speed in the normal condition, None where there is none."""
        return self.rated_value / self.rated_allowed if self.rated_value is not None and self.rated_allowed else None

    def scaled(self, scale: float, unit: str) -> ComponentUse:
        """Use of the component with all values times a factor, in another unit."""
        value, allowed, rated_value, rated_allowed = (
            None if size is None else size * scale
            for size in (self.value, self.allowed, self.rated_value, self.rated_allowed)
        )
        return replace(
            self, unit=unit, value=value, allowed=allowed, rated_value=rated_value, rated_allowed=rated_allowed
        )


def component_uses(
    judged: LimitConclusion, model: Definition, conventions: Conventions, normal: ConditionPeaks | None = None
) -> tuple[ComponentUse, ...]:
    """Criteria of all limits of a model, each at its worst and at rated speed, in the order of ``GROUPS``.

    ``normal`` has the limits of the normal condition at rated speed.

    Heat of dampers is given per cooling area where its limit is, the angle of generators also in mechanical degrees.
    """
    order = {name: place for place, name in enumerate(model.limits)}
    worst = sorted(judged.worst(), key=lambda limit: order[limit.verdict.limit])
    uses = [use for limit in worst for use in _uses(limit, model, conventions, normal)]
    return tuple(sorted(uses, key=lambda use: list(GROUPS).index(use.group)))


def _uses(
    worst: WorstLimit, model: Definition, conventions: Conventions, normal: ConditionPeaks | None
) -> Iterator[ComponentUse]:
    verdict, at = worst.verdict, worst.verdict.worst
    limit = model.limits[verdict.limit].fitted(model.elements)
    what = CRITERIA.get(verdict.criterion, (f"{verdict.quantity}, {verdict.criterion}",))
    use = ComponentUse(group_of(limit, model), worst, what)
    if at is None:
        yield use
        return
    use = replace(use, value=float(verdict.values[at]), allowed=float(verdict.allowed[at]))
    if normal is not None and normal.rated is not None:
        named = verdict.limit, verdict.criterion
        own = (
            rated_verdict
            for rated_verdict in normal.points.verdicts
            if (rated_verdict.limit, rated_verdict.criterion) == named
        )
        rated = next((rated_verdict for rated_verdict in own if len(rated_verdict.values)), None)
        if rated is not None:
            there = float(rated.values[normal.rated]), float(rated.allowed[normal.rated])
            use = replace(use, rated_value=there[0], rated_allowed=there[1])
    if isinstance(limit, DamperLimit) and verdict.unit == "W" and limit.power_per_area is not None:
        area = not_none(limit.area)
        scale, shown = engineering_unit("W/m^2", conventions)
        yield replace(use, what=(phrase("power loss per area, {area:g} m²", area=area),)).scaled(scale / area, shown)
    elif isinstance(limit, MachineAngleLimit):
        # The angle of a generator is electrical first; divided by its pole pairs it is that of the shaft.
        scale, shown = limit_scale(verdict.unit, conventions)
        yield use.scaled(scale, shown)
        yield replace(use, what=("the same angle, mechanical",)).scaled(scale / limit.pole_pairs, shown)
    else:
        yield use.scaled(*limit_scale(verdict.unit, conventions))


def _cylinders(model: Definition) -> set[str]:
    """Names of the nodes on which cylinders act."""
    engines = (excitation for excitation in model.excitations.values() if isinstance(excitation, EngineEntries))
    return {node for engine in engines for node in engine.cylinders.values()}


def limited_element(limit: Limit, model: Definition) -> str:
    """Name of the element that a limit is about, by itself or by the output that it limits; empty where none is."""
    sensor = named_sensor(limit.output, model.sensors) if isinstance(limit, CurveLimit) else None
    if sensor is not None:
        return sensor.of if sensor.is_on_element else ""
    return getattr(limit, "element", "")


def group_of(limit: Limit, model: Definition) -> str:
    """Kind of component that a limit is about, a key of ``GROUPS``."""
    element = model.elements.get(limited_element(limit, model))
    if isinstance(limit, CurveLimit) and element is not None:
        if _cylinders(model).intersection(element.ports.values()):
            return "crankshaft"
        if isinstance(element, Shaft):
            return "shafts"
    return next((name for name, rules in GROUPS.items() if limit.kind in rules), "other components")


# Table of a report with what limits judge at rated speed in further conditions, beside the normal one.

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
