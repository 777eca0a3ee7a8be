"""Rows of a report on components: each criterion of each limit where its value is nearest to what is allowed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from torsionnet.base.conventions import Conventions
from torsionnet.base.entries.spec import not_none
from torsionnet.machinery.excitations.engine_entries import EngineEntries
from torsionnet.machinery.limits import Limit
from torsionnet.machinery.limits.coupling import DamperLimit, temperature_words
from torsionnet.machinery.limits.curve import CurveLimit
from torsionnet.machinery.limits.machine_angle import MachineAngleLimit
from torsionnet.machinery.verdicts.limit_check import LimitVerdict
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion, WorstLimit
from torsionnet.machinery.verdicts.rule_factors import RuleSymbol, RuleWords
from torsionnet.model.channels import named_sensor
from torsionnet.model.definition import Definition
from torsionnet.report.document_tree import Cell, NumberText
from torsionnet.report.report_text import as_words, unit

# Units of values as engineers of machinery write them: kN m, kW, N/mm2, mrad or degrees.

KILO = {"W": "kW", "W/m^2": "kW/m^2"}
"""Unit of a thousand, by SI unit, for what machinery has in thousands."""
KILO_FROM = 1e3
"""Torque in N m from which on it is given in kN m, as on the drawings of engines."""


FACTOR_UNITS = {"m": (1e3, "mm"), "m^3": (1e6, "cm^3"), "Pa": (1e-6, "N/mm^2"), "1": (1.0, "")}
"""Factor and unit in which rules state the factors of a shaft, by SI unit."""


def engineering_unit(unit: str, conventions: Conventions, size: float = 1e3) -> tuple[float, str]:
    """Factor from an SI unit to the unit of engineers, without unit, and the name of that unit.

    ``size`` is that of the values in SI units, by which torques of small plants stay in N m.

    Examples
    --------
    >>> engineering_unit("N*m", Conventions(), 25e3), engineering_unit("rad", Conventions())
    ((0.001, 'kN*m'), (1000.0, 'mrad'))
    >>> engineering_unit("Pa", Conventions())
    (1e-06, 'N/mm^2')
    """
    if unit in KILO:
        return 1e-3, KILO[unit]
    if unit == "rad" and conventions.angle == "rad":
        return 1e3, "mrad"
    if unit == "N*m" and size >= KILO_FROM:
        return 1e-3, "kN*m"
    return conventions.scale(unit), conventions.unit(unit)


GROUPS = {
    "shafts": ("iacs_m68", "fatigue"),
    "crankshaft": (),
    "couplings": ("coupling",),
    "gears": ("gear",),
    "dampers": ("damper",),
    "generators": ("machine_angle",),
    "other components": ("curve",),
}
"""Rules of limits, by the kind of component that they are for, in the order of the report."""
CRITERIA: dict[str, RuleWords] = {
    "tau_C": ("stress, continuous operation",),
    "tau_T": ("stress, quick passage",),
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
    "angle": ("electrical angle",),
}
"""Words for what is compared, by the criterion of a limit."""


@dataclass(frozen=True)
class ComponentRow:
    """Value of a component beside the value allowed, in units of engineers, at the worst speed and condition.

    Attributes
    ----------
    group : str
        Kind of component.
    limit, of : str
        Name of the limit, and of the element, node or output that it is about.
    what : tuple of str and RuleSymbol
        What is compared.
    criterion : str
        Symbol of the value allowed.
    value, allowed : float or None
        None where it was not judged.
    unit : str
    utilisation : float or None
    rpm : float or None
        Speed of the reference shaft.
    configuration, case : str
        The worst condition, and the worst case in it, such as the cylinder that misfires.
    verdict : str
    remark : str
        Why it was not judged.
    """

    group: str
    limit: str
    of: str
    what: RuleWords
    criterion: str
    value: float | None
    allowed: float | None
    unit: str
    utilisation: float | None
    rpm: float | None
    configuration: str
    case: str
    verdict: str
    remark: str = ""


def component_rows(found: LimitConclusion, model: Definition, conventions: Conventions) -> tuple[ComponentRow, ...]:
    """Rows of the criteria of all limits of a model, each at its worst, in the order of ``GROUPS``.

    Heat of dampers is given per cooling area where its limit is, the angle of generators also in mechanical degrees.
    """
    order = {name: place for place, name in enumerate(model.limits)}
    worst = sorted(found.worst(), key=lambda one: order[one.verdict.limit])
    rows = [row for one in worst for row in _rows(one, model, conventions)]
    return tuple(sorted(rows, key=lambda row: list(GROUPS).index(row.group)))


def throws(model: Definition) -> tuple[str, ...]:
    """Names of the elements between two cylinders of an engine or compressor that are switched on, in their order.

    Examples
    --------
    >>> import torsionnet as tn
    >>> throws(tn.load("two_stroke_ship").definition)
    ('crank1', 'crank2', 'crank3', 'crank4', 'crank5')
    """
    cylinders = _cylinders(model)
    return tuple(
        one.name
        for one in model.active
        if len(set(one.ports.values())) == 2 and all(node in cylinders for node in one.ports.values())
    )


def _cylinders(model: Definition) -> set[str]:
    """Names of the nodes on which cylinders act."""
    engines = (one for one in model.excitations.values() if isinstance(one, EngineEntries))
    return {node for engine in engines for node in engine.cylinders.values()}


def group_of(limit: Limit, model: Definition) -> str:
    """Kind of component that a limit is about, a key of ``GROUPS``."""
    if isinstance(limit, CurveLimit):
        sensor = named_sensor(limit.output, model.sensors)
        if sensor and sensor.is_on_element and _cylinders(model).intersection(model.elements[sensor.of].ports.values()):
            return "crankshaft"
    return next((name for name, rules in GROUPS.items() if limit.kind in rules), "other components")


def _rows(worst: WorstLimit, model: Definition, conventions: Conventions) -> Iterator[ComponentRow]:
    check, one = worst.check, worst.verdict
    limit = model.limits[one.limit].fitted(model.elements)
    what = CRITERIA.get(one.criterion, (f"{one.quantity}, {one.criterion}",))
    row = ComponentRow(
        group_of(limit, model), one.limit, one.of, what, one.criterion, None, None, "", None, None,
        check.configuration, "", worst.gravest,
    )  # fmt: skip
    at = one.worst
    if at is None:
        yield replace(row, remark="; ".join(one.remarks))
        return
    hottest = one.steady_temperature
    row = replace(
        row,
        utilisation=worst.utilisation,
        rpm=worst.rpm,
        case=one.case,
        remark="" if hottest is None else temperature_words(hottest),
    )
    yield from _sized(row, limit, float(one.values[at]), float(one.allowed[at]), one.unit, conventions)


def _sized(
    row: ComponentRow, limit: Limit, value: float, allowed: float, unit: str, conventions: Conventions
) -> Iterator[ComponentRow]:
    """Rows of one criterion with its value and the value allowed, from SI units, in units of engineers."""
    if isinstance(limit, DamperLimit) and unit == "W" and limit.power_per_area is not None:
        area = not_none(limit.area)
        row = replace(row, what=(f"power loss per area, {area:g} m²",))
        value, allowed, unit = value / area, allowed / area, "W/m^2"
    scale, shown = engineering_unit(unit, conventions, max(value, allowed))
    if isinstance(limit, MachineAngleLimit):
        scale, shown = Conventions(angle="deg").scale(unit), "deg"
        yield replace(row, value=value * scale, allowed=allowed * scale, unit=shown)
        scale /= limit.pole_pairs
        row = replace(row, what=("the same angle, mechanical",))
    yield replace(row, value=value * scale, allowed=allowed * scale, unit=shown)


# Values of limits in a report: torques in kN m, stresses in N/mm2, angles in the unit of the report.

DIGITS = 3
"""Significant digits of stresses, torques and shares: a torsional calculation is not known better."""


def limit_scale(si_unit: str, conventions: Conventions) -> float:
    """Factor from the SI unit of a limit to the unit in which a report shows its values."""
    return engineering_unit(si_unit, conventions)[0]


def limit_unit(si_unit: str, conventions: Conventions) -> str:
    """Name of the unit in which a report shows values of an SI unit.

    >>> limit_unit("N*m", Conventions()), limit_unit("Pa", Conventions())
    ('kN·m', 'N/mm²')
    """
    return unit(engineering_unit(si_unit, conventions)[1])


def limit_number(value: float, si_unit: str, conventions: Conventions) -> NumberText:
    """Number of a value in SI in the unit in which a report shows it."""
    return NumberText(value * limit_scale(si_unit, conventions), DIGITS)


def component(one: LimitVerdict) -> str:
    """Words for the component that a limit is about, by the name of the limit in the model."""
    return as_words(one.limit)


def order_list(orders: list[tuple[str, float]], one: LimitVerdict, conventions: Conventions) -> Cell:
    """Names of orders with their amplitudes in the unit of a limit as one text, such as "engine 6: 46.3"."""
    numbers = ((name, limit_number(size, one.unit, conventions)) for name, size in orders)
    return "; ".join(f"{as_words(name)}: {number}" for name, number in numbers)
