"""Limits of a model in one condition: the responses they want to see, then the verdict of each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.core.errors import UsageError, meant_or
from torsionnet.model.channels import Sensor
from torsionnet.model.checks.limits_fit import limit_subject
from torsionnet.model.elements import Values
from torsionnet.model.limits import Limit, limit_rules
from torsionnet.model.limits.evidence import Evidence
from torsionnet.model.limits.subject import LimitSubject
from torsionnet.model.power_flow import power_flows, power_sensors
from torsionnet.response.frequency_response import FloatArray
from torsionnet.response.limit_check import LimitCheck
from torsionnet.response.order_response import OrderResponse
from torsionnet.solve.mean_response import mean_response
from torsionnet.solve.order_response import order_response

NO_CYCLE = "the shafts have no short common cycle: half ranges of the shafts are added"
MISFIRING = "a cylinder misfires in this condition"


def check_limits(
    drivetrain: AssembledModel,
    limits: str | Iterable[str] | None = None,
    *,
    speeds: ArrayLike | None = None,
    excitations: Iterable[str] | None = None,
) -> LimitCheck:
    """See :meth:`torsionnet.Drivetrain.check_limits`."""
    chosen = {name: limit.fitted(drivetrain.definition.elements)
              for name, limit in _chosen(drivetrain.definition.limits, limits).items()}  # fmt: skip
    subject = limit_subject(drivetrain.definition, drivetrain.exact_values)
    here = [limit for limit in chosen.values() if not limit.switched_off(subject)]
    run = order_response(drivetrain, _seen(subject, here), speeds=speeds, excitations=excitations)
    means, why = _means(drivetrain, subject, here, run)
    evidence = Evidence(run, means, why, subject)
    verdicts = tuple(verdict for name, limit in chosen.items() for verdict in limit.verdicts(name, evidence))
    notes = [NO_CYCLE] * (run.revolutions is None) + [MISFIRING] * subject.misfiring
    return LimitCheck(
        run.speeds, run.reference, verdicts, tuple(map(str, run.lines)), drivetrain.title, drivetrain.configuration,
        subject.misfiring, tuple(notes),
    )  # fmt: skip


def _chosen(known: Mapping[str, Limit], names: str | Iterable[str] | None) -> dict[str, Limit]:
    if not known:
        rules = ", ".join(limit_rules())
        raise UsageError(
            f"the model has no limits; they stand in its entry limits: {{name: {{rule: ...}}}}, rules are {rules}"
        )
    wanted = list(known) if names is None else [names] if isinstance(names, str) else list(names)
    for name in wanted:
        if name not in known:
            hint = meant_or(name, known, f"there are {', '.join(known)}")
            raise UsageError(f'no limit is named "{name}"{hint}')
    return {name: known[name] for name in wanted}


def _seen(subject: LimitSubject, limits: Sequence[Limit]) -> list[Sensor]:
    """All sensors that the limits want, every one once."""
    found = [sensor for limit in limits for sensor in limit.seen(subject)]
    for limit in limits:
        for name in limit.powered():
            found += power_sensors(power_flows(subject.active[name], Values(subject.values)))
    if not found:
        raise UsageError("everything that the limits are about is switched off in this condition")
    return list(dict.fromkeys(found))


def _means(
    drivetrain: AssembledModel, subject: LimitSubject, limits: Sequence[Limit], run: OrderResponse
) -> tuple[dict[Sensor, FloatArray], str]:
    """Mean values over speed of what the limits want averaged, and why some of them are not known."""
    sensors = list(dict.fromkeys(sensor for limit in limits for sensor in limit.averaged(subject)))
    try:
        values = mean_response(drivetrain, sensors, run.speeds).values if sensors else np.empty((0, 0))
    except UsageError as error:
        if len(sensors) == 1:
            return {}, str(error)
        return _one_by_one(drivetrain, sensors, run)
    return dict(zip(sensors, values.T, strict=False)), ""


def _one_by_one(
    drivetrain: AssembledModel, sensors: Sequence[Sensor], run: OrderResponse
) -> tuple[dict[Sensor, FloatArray], str]:
    """As some of them are not determined."""
    found: dict[Sensor, FloatArray] = {}
    why = ""
    for sensor in sensors:
        try:
            found[sensor] = mean_response(drivetrain, sensor, run.speeds).values[:, 0]
        except UsageError as error:
            why = str(error)
    return found, why
