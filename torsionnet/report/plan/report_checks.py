"""Checks that a report plan fits its model: names of sensors, inputs and configurations."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from torsionnet.base.errors import Fault, UsageError, unknown_name
from torsionnet.base.units import RPM
from torsionnet.model.channels import parse_sensor
from torsionnet.model.checks.names import declared, pair_faults
from torsionnet.model.configurations import parse_choice
from torsionnet.model.defining import variants
from torsionnet.report.plan.report_plan import ReportPlan

SPEED_ROUNDING = 1e-9
"""Share of a speed by which rounding of its unit may carry it out of a range."""

if TYPE_CHECKING:
    from torsionnet.model.definition import Definition


OVER_SPEED = {"orders": "orders over speed", "measure": "measurements over speed"}
"""Name in messages of what an entry of the plan shows over speed, by the entry."""


def check_report(definition: Definition, other: ReportPlan | None = None) -> list[Fault]:
    """Faults of the report plan of a model, or of another for it; sensors written out are left to the solver."""
    if (plan := other or definition.report) is None:
        return []
    faults = [
        fault.under("transfer_functions", index)
        for index, pair in enumerate(plan.transfer_functions)
        for fault in pair_faults(pair, definition)
    ]
    for key, outputs in {"orders": plan.orders, "measure": plan.measure}.items():
        faults += _over_speed(key, outputs, definition) if outputs else []
    chosen = [(("configurations", index), name) for index, name in enumerate(plan.configurations)]
    for path, name in [*chosen, *([(("normal",), plan.normal)] if plan.normal else [])]:
        try:
            parse_choice(name, definition.configurations)
        except UsageError as error:
            faults.append(replace(error.fault, path=path))
    faults += _idling(plan, definition) if plan.idling else []
    return [fault.under("report") for fault in faults]


def _over_speed(key: str, names: tuple[str, ...], definition: Definition) -> Iterator[Fault]:
    """Faults of outputs that are shown over speed, or measured there, in the entry ``key`` of the plan."""
    if definition.speeds is None or not definition.excitations:
        text = f"{OVER_SPEED[key]} need the entries speeds: and excitations: of the model"
        yield Fault(text, (key,), on_key=True, kind="missing-entry")
    nodes = {node for element in definition.elements.values() for node in element.ports.values()}
    for index, name in enumerate(names):
        if name not in definition.sensors and name not in nodes and parse_sensor(name) is None:
            known = [*definition.sensors, *nodes]
            yield unknown_name("sensor or node", name, known, (key, index), rest=declared(definition, "sensor"))


def _idling(plan: ReportPlan, definition: Definition) -> Iterator[Fault]:
    """Faults of speeds of idling without a shaft they belong to, and of those that are not calculated."""
    speeds = definition.speeds
    if speeds is None:
        text = "speeds of idling are those of the shaft of the entry speeds:, which the model lacks"
        yield Fault(text, ("idling",), on_key=True, kind="out-of-range")
        return
    conditions = [definition, *(condition for _, condition in variants(definition))]
    for index, speed in enumerate(plan.idling):
        if not any(holds_speed(condition, speed) for condition in conditions):
            low, high = speeds.values[0] * RPM, speeds.values[-1] * RPM
            text = f"{speeds.of} idles at {speed * RPM:.6g} rpm, but speeds: go from {low:.6g} to {high:.6g} rpm"
            text += (
                "; let them begin at the speed of idling, or make idling a condition of its own, as configurations: "
            )
            yield Fault(
                f"{text}{{running: {{}}, idling: {{speeds.range: 280..320 rpm}}}}",
                ("idling", index),
                kind="out-of-range",
            )


def holds_speed(definition: Definition, speed: float) -> bool:
    """Whether a speed in rad/s lies within the speeds that a condition of the model examines."""
    speeds = definition.speeds
    if speeds is None:
        return False
    return speeds.values[0] * (1 - SPEED_ROUNDING) <= speed <= speeds.values[-1] * (1 + SPEED_ROUNDING)
