"""Components of a drivetrain with each criterion of each limit where its value is nearest to what is allowed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from torsionnet.base.conventions import Conventions
from torsionnet.base.entries.spec import not_none
from torsionnet.base.phrases import phrase
from torsionnet.machinery.excitations.engine_entries import EngineEntries
from torsionnet.machinery.limits import Limit
from torsionnet.machinery.limits.coupling import DamperLimit
from torsionnet.machinery.limits.curve import CurveLimit
from torsionnet.machinery.limits.machine_angle import MachineAngleLimit
from torsionnet.machinery.limits.society_rules import in_all_words
from torsionnet.machinery.verdicts.condition_peaks import ConditionPeaks
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion, WorstLimit
from torsionnet.machinery.verdicts.limit_verdict import RuleSymbol, RuleWords
from torsionnet.model.channels import named_sensor
from torsionnet.model.definition import Definition
from torsionnet.model.elements import Shaft
from torsionnet.report.report_units import engineering_unit, limit_scale

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
