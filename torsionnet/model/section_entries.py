"""Entries for the sections of a model file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from torsionnet.core.entries.composite import Named, Nested, Typed
from torsionnet.core.entries.words import NAME_SCHEMA, name_fault
from torsionnet.core.expression_reading import check_name
from torsionnet.model.channels import INPUT, SENSOR
from torsionnet.model.configurations import AxesEntry
from torsionnet.model.element_base.element_table import ElementTable, element_kinds
from torsionnet.model.parameters import PARAMETER

if TYPE_CHECKING:
    from torsionnet.model.bench.plan import Plan
    from torsionnet.model.excitations.order_excitation import OrderExcitation
    from torsionnet.model.excitations.speed_range import SpeedRange
    from torsionnet.model.limits.limit import Limit
    from torsionnet.model.load.load_section import Load
    from torsionnet.model.report.report_plan import ReportPlan
    from torsionnet.model.scenarios.scenario import Scenario


def _plan() -> type[Plan]:
    from torsionnet.model.bench.plan import Plan  # loads numpy, which most models can do without

    return Plan


def _speeds() -> type[SpeedRange]:
    from torsionnet.model.excitations.speed_range import SpeedRange

    return SpeedRange


def _load() -> type[Load]:
    from torsionnet.model.load.load_section import Load

    return Load


def _excitation_kinds() -> Mapping[str, type[OrderExcitation]]:
    from torsionnet.model.excitations import excitation_kinds  # loads numpy, which most models can do without

    return excitation_kinds()


def _limit_rules() -> Mapping[str, type[Limit]]:
    from torsionnet.model.limits import limit_rules

    return limit_rules()


def _scenario_kinds() -> Mapping[str, type[Scenario]]:
    from torsionnet.model.scenarios.scenario import scenario_kinds

    return scenario_kinds()


def _report() -> type[ReportPlan]:
    from torsionnet.model.report.report_plan import ReportPlan

    return ReportPlan


PARAMETERS = Named(
    "named values with unit, or expressions of other parameters", PARAMETER, refused=check_name, names=NAME_SCHEMA
)
ELEMENTS = ElementTable(
    "the parts of the drivetrain by name, each attached to nodes",
    Typed("what kind of element this is", element_kinds, "element", "element"),
    names=NAME_SCHEMA,
    fewest=1,
)
INPUTS = Named("excitations by name", INPUT, refused=name_fault, names=NAME_SCHEMA)
SENSORS = Named("measured quantities by name", SENSOR, refused=name_fault, names=NAME_SCHEMA)
CONFIGURATIONS = AxesEntry("axes of alternatives, gear: {II: {tau: 7.96}}; the name of a single axis may be left out")
SPEEDS = Nested("at which speeds running machinery is examined", _speeds, "speeds", optional=True)
LOAD = Nested("who absorbs the power, how that follows the speed, and who drives", _load, "load", optional=True)
EXCITATIONS = Named(
    "what runs and excites the drivetrain by orders of its speed, by name",
    Typed("what kind of excitation this is", _excitation_kinds, "excitation", "order_excitation"),
    refused=name_fault,
    names=NAME_SCHEMA,
)
LIMITS = Named(
    "what elements may bear while the machinery runs, by name",
    Typed("which rule says so", _limit_rules, "limit", "limit", key="rule"),
    refused=name_fault,
    names=NAME_SCHEMA,
)
SCENARIOS = Named(
    "what happens to the drivetrain over time, by name",
    Typed("what kind of scenario this is", _scenario_kinds, "scenario", "scenario"),
    refused=name_fault,
    names=NAME_SCHEMA,
)
BENCH = Nested("a virtual test: excitation, exciter, sensors, data acquisition", _plan, "bench", optional=True)
REPORT = Nested("what torsionnet report writes about the model", _report, "report", optional=True)
