"""Places, condition and measured files of the measurement plan of a report."""

from __future__ import annotations

from dataclasses import dataclass

from torsionnet.base.errors import UsageError
from torsionnet.machinery.limits.iacs_m68 import IacsM68
from torsionnet.machinery.limits.shaft_limit import ShaftLimit
from torsionnet.machinery.orders.order_comparison import order_comparison
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.model.channels import Sensor, named_sensor
from torsionnet.model.element_base.round_section import section_fault
from torsionnet.report.measured_orders import MeasuredFile, free_end
from torsionnet.report.report_data import Case, ReportData
from torsionnet.signals.orders.tracked_orders import MeasuredOrder

MEANS = {"torque": "torque by strain gauges", "angle": "angle by torsiograph or encoder"}
"""Words on how quantities are measured on board, by quantity."""


@dataclass(frozen=True, eq=False)
class MeasuringPlace:
    """Sensor of the plan, its name in the model or written out, and how it is measured."""

    name: str
    sensor: Sensor

    @property
    def means(self) -> str:
        """Quantity that is measured, and with what."""
        return MEANS.get(self.sensor.quantity, self.sensor.quantity)


def measuring_places(subject: ReportData) -> tuple[MeasuringPlace, ...]:
    """Places of the measurement plan of a report, each with the sensor to measure with.

    Those named, else the free end of the engine and the shaft used most.
    """
    definition = subject.model.definition
    named = {sensor: name for name, sensor in definition.sensors.items()}
    asked = subject.request.plan.measure
    if asked:
        sensors = [named_sensor(name, definition.sensors) or Sensor("angle", name) for name in asked]
    else:
        end, shaft = free_end(definition), _most_used_shaft(subject)
        sensors = [Sensor("angle", end)] if end else []
        sensors += [Sensor("torque", shaft)] if shaft else []
    if subject.request.measured and not sensors:
        raise UsageError(
            "the model names no place to measure at; name sensors in report: {measure: [...]}", kind="missing-entry"
        )
    return tuple(MeasuringPlace(named.get(sensor, str(sensor)), sensor) for sensor in sensors)


def _most_used_shaft(subject: ReportData) -> str:
    """Name of the accessible shaft used most by a limit of stress, else of the first shaft with a sensor; or empty."""
    definition, judged = subject.model.definition, subject.limit_conclusion
    worst = [worst_limit for worst_limit in judged.worst() if worst_limit.utilisation is not None] if judged else []
    limits = [definition.limits[worst_limit.verdict.limit] for worst_limit in worst]
    shafts = [limit for limit in limits if isinstance(limit, ShaftLimit)]
    if shafts:
        return str(min(shafts, key=_is_in_the_stern_tube).element)
    measured = [sensor.of for sensor in definition.sensors.values() if sensor.quantity == "torque"]
    return next((name for name in measured if section_fault(definition.elements[name]) is None), "")


def _is_in_the_stern_tube(limit: ShaftLimit) -> bool:
    """Whether a shaft is a propeller shaft, most of which lies in the stern tube, where no strain gauge is seen."""
    return isinstance(limit, IacsM68) and limit.shaft == "propeller"


def files_by_case(subject: ReportData) -> tuple[tuple[Case, tuple[MeasuredFile, ...]], ...]:
    """Files with measured orders by the condition they were measured in, in the order they were given."""
    files_by_name: dict[str, list[MeasuredFile]] = {}
    for file in subject.request.measured:
        name = file.configuration or (subject.judged_cases[0].configuration if len(subject.judged_cases) == 1 else "")
        if not name and subject.model.configurations:
            names = ", ".join(case.configuration for case in subject.judged_cases)
            text = "a measurement is of one configuration"
            raise UsageError(
                f"{file.path.name}: {text}; write CONFIGURATION={file.path.name}, there are {names}",
                kind="unknown-configuration",
            )
        files_by_name.setdefault(name, []).append(file)
    known = {case.configuration: case for case in subject.judged_cases}
    return tuple(
        (known.get(name) or Case(name, subject.model.configured(name) if name else subject.model), tuple(files))
        for name, files in files_by_name.items()
    )


def within_calculated(
    file: MeasuredFile, run: OrderResponse, name: str, orders: tuple[MeasuredOrder, ...]
) -> tuple[MeasuredOrder, ...]:
    """Measured orders of a place, if any was measured at orders and speeds that are calculated.

    Raises
    ------
    UsageError
        None was; the message names the file.
    """
    try:
        order_comparison(run, name, orders)
    except UsageError as error:
        low, high = float(run.rpm.min()), float(run.rpm.max())
        text = f"the file has to have orders and speeds of {run.reference} from {low:.6g} to {high:.6g} rpm"
        raise UsageError(f"{file.path.name}: {error}; {text}", kind=error.kind) from None
    return orders
