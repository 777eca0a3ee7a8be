"""Vibration of one output over the speed of machinery, for the explore page: all orders together and the largest."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from torsionnet.app.explore.overlay import CONVENTIONS_BY_ANGLE, json_numbers, orders_of_test, tested_orders
from torsionnet.base.errors import UsageError
from torsionnet.base.units import RPM
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.checks.limit_checks import limit_subject
from torsionnet.machinery.limits import Limit
from torsionnet.machinery.limits.evidence import LimitSubject
from torsionnet.machinery.limits.shaft_limit import RoundSection
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.worst_response import WorstResponse
from torsionnet.machinery.verdicts.limit_check import FAIL, LimitVerdict
from torsionnet.model.channels import Sensor, named_sensor
from torsionnet.model.elements import Values

# Limits of a model on an output over speed, for the explore page: values allowed and ranges to be barred.

FEW_SPEEDS = 25
"""Number of speeds at which limits of a model with many cases of excitation are asked, to draw their curves alone."""
ROUGH_ENDS = "ends of barred ranges are found at the speeds of the plot; torsionnet limits finds them between these"
"""Note on barred ranges of the page, which are not refined as those of the command are."""
CURVES_ALONE = "torsionnet limits finds the ranges to be barred, in each case of excitation"
"""Note on limits of a model with many cases of excitation, whose barred ranges would take the page too long."""


def speed_limits(rig: Drivetrain, run: OrderResponse) -> dict[str, Any]:
    """Allowed half ranges of the first output at the speeds of its run, and ranges to be barred, as JSON data.

    Allowed values are in the SI unit of the output: of a limit of stress, the torque that causes that stress. No speeds
    are added to those of the run. With several cases of excitation there are curves and no ranges.

    Parameters
    ----------
    rig : Drivetrain
    run : OrderResponse
    """
    subject = limit_subject(rig.definition, rig.exact_values)
    output = run.outputs[0].name
    shown = named_sensor(output, rig.definition.sensors) or Sensor("angle", output)
    fitted = {name: limit.fitted(rig.definition.elements) for name, limit in rig.definition.limits.items()}
    concerned = {
        name: limit
        for name, limit in fitted.items()
        if not limit.switched_off(subject) and _factor(shown, limit.order_sensors(subject), 1.0, subject) is not None
    }
    if not concerned:
        return {"limits": [], "barred": [], "limit_notes": []}
    cheap = isinstance(run, WorstResponse)
    speeds = _few(run.speeds, concerned.values(), subject) if cheap else run.speeds
    try:
        verdicts = rig.check_limits(list(concerned), speeds=speeds, refine=False).verdicts
    except UsageError as error:
        return {"limits": [], "barred": [], "limit_notes": [str(error)]}
    curves = [
        {"name": _name(one), "allowed": json_numbers(np.interp(run.speeds, speeds, one.allowed / factor)),
         "in_passing": one.in_passing}
        for one, factor in _drawn(verdicts, concerned, shown, subject)
    ]  # fmt: skip
    drawn = {one["name"] for one in curves}
    others = [_name(one) for one in verdicts if _name(one) not in drawn]
    also = [f"torsionnet limits judges also {', '.join(others)}"] if others else []
    if cheap:
        return {"limits": curves, "barred": [], "limit_notes": [CURVES_ALONE, *also]}
    barred = [
        {"name": _name(one), "from": span.low * RPM, "to": span.high * RPM} for one in verdicts for span in one.barred
    ]
    return {
        "limits": curves,
        "barred": barred,
        "limit_notes": [*_failures(verdicts), *[ROUGH_ENDS][: len(barred)], *also],
    }


def _few(speeds: FloatArray, limits: Iterable[Limit], subject: LimitSubject) -> FloatArray:
    """Few speeds in rad/s from the first to the last, with those at which the limits' curves bend."""
    bends = np.array([speed for limit in limits for speed in limit.breaks(subject)])
    inside = bends[(bends > speeds[0]) & (bends < speeds[-1])]
    return np.unique(np.concatenate([np.linspace(speeds[0], speeds[-1], min(FEW_SPEEDS, len(speeds))), inside]))


def _drawn(
    verdicts: Sequence[LimitVerdict], limits: Mapping[str, Limit], shown: Sensor, subject: LimitSubject
) -> list[tuple[LimitVerdict, float]]:
    """Verdicts that judge the half range of the output, each with the factor from it to the judged value."""
    known: dict[tuple[str, str], float] = {}
    found = []
    for one in verdicts:
        judged = limits[one.limit].vibratory_sensors(one.criterion, subject) if len(one.values) else None
        factor = None if judged is None else _factor(shown, *judged, subject)
        if one.in_passing:  # what may be reached in passing is of the same quantity as what is permitted for long
            factor = factor or known.get((one.limit, one.quantity))
        if factor is not None:
            known[one.limit, one.quantity] = factor
            found.append((one, factor))
    return found


def _failures(verdicts: Iterable[LimitVerdict]) -> list[str]:
    """Sentences on the limits that fail or hold up to a highest speed."""
    failing = [f"{_name(one)}: {one.remarks[0]}" for one in verdicts if one.verdict == FAIL and one.remarks]
    return failing + [
        f"{_name(one)}: holds up to {one.highest * RPM:.4g} r/min" for one in verdicts if one.highest is not None
    ]


def _name(one: LimitVerdict) -> str:
    """Name of a limit with the symbol of its criterion, if it has one."""
    return one.limit if one.criterion in ("continuous", "all") else f"{one.limit} {one.criterion}"


def _factor(shown: Sensor, judged: Sequence[Sensor], factor: float, subject: LimitSubject) -> float | None:
    """Factor from the shown output to the judged value, None where it is something else.

    ``factor`` leads from the judged sensors to that value.
    """
    if shown in judged or shown in [replace(one, at=None) for one in judged]:
        return factor
    torque = any(one.of == shown.of and one.quantity == "torque" for one in judged)
    diameters = subject.elements[shown.of].diameters if shown.quantity == "stress" and torque else None
    if diameters is None:
        return None
    value = Values(subject.values)
    return factor * RoundSection(*(float(value(one)) for one in diameters)).modulus


MOST_ORDERS = 5
"""Largest number of orders over speed that are drawn beside their sum; more lines cannot be told apart."""
ROUGH_SPEEDS = 120
"""Number of speeds that are calculated while a slider moves; a plot has a few pixels for each."""


def runs(rig: Drivetrain) -> bool:
    """Whether the model has speeds and excitations."""
    return rig.definition.speeds is not None and bool(rig.definition.excitations)


def over_speed(
    rig: Drivetrain, output: str, *, rough: bool = False, test: str | os.PathLike[str] | None = None
) -> dict[str, Any]:
    """Half range of all orders and amplitudes of the largest ones over speed, as JSON data in SI with their units.

    With them the limits of the model that hold for the output, see :func:`.speed_limits`.

    Parameters
    ----------
    rig : Drivetrain
    output : str
    rough : bool
        At most :data:`ROUGH_SPEEDS` of the model's speeds.
    test : path, optional
        A file of measured orders, which are drawn instead of the largest ones.

    Raises
    ------
    UsageError
        The model has no speeds or excitations, or none act in this configuration.
    """
    given = rig.definition.speeds
    if given is None:
        raise UsageError("over speed the page needs the entries speeds: and excitations: of the model")
    speeds, thinned = _thinned(np.array(given.values), ROUGH_SPEEDS if rough else len(given.values))
    run = rig.order_response(output, speeds=speeds)
    unit = run.outputs[0].unit
    tested = tested_orders(run, orders_of_test(test, run.outputs[0]), MOST_ORDERS)
    return {
        "output": run.outputs[0].name,
        "units": {angle: shown.unit(unit) for angle, shown in CONVENTIONS_BY_ANGLE.items()},
        "scales": {angle: shown.scale(unit) for angle, shown in CONVENTIONS_BY_ANGLE.items()},
        "reference": run.reference,
        "rated": float(given.rated) * RPM if given.rated else None,
        "range": [min(given.values) * RPM, max(given.values) * RPM],
        "rpm": json_numbers(run.rpm),
        "total": run.sum_label,
        "half_range": json_numbers(run.half_range[:, 0]),
        "orders": [{"name": one["name"], "magnitude": one.pop("curve")} for one in tested] or _largest(run),
        "tested": tested,
        "count": len(run.lines),
        "thinned": thinned,
        **speed_limits(rig, run),
    }


def _thinned(speeds: FloatArray, most: int) -> tuple[FloatArray, bool]:
    """Selection of at most ``most`` speeds in rad/s, first and last among them, and whether any were left out."""
    if len(speeds) <= most:
        return speeds, False
    return speeds[np.linspace(0, len(speeds) - 1, most).round().astype(int)], True


def _largest(run: OrderResponse) -> list[dict[str, Any]]:
    """Names of the orders with the largest amplitudes and these over speed, in SI, the largest one first."""
    sizes = np.abs(run.values[:, :, 0])
    chosen = np.argsort(-sizes.max(axis=0), kind="stable")[:MOST_ORDERS]
    return [{"name": str(run.lines[line]), "magnitude": json_numbers(sizes[:, line])} for line in chosen.tolist()]
