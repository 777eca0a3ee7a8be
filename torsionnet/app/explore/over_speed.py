"""Vibration of one output over the speed of machinery, for the explore page: all orders together and the largest."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from torsionnet.app.explore.page_numbers import CONVENTIONS_BY_ANGLE, json_numbers
from torsionnet.app.explore.speed_limits import speed_limits
from torsionnet.app.explore.tested_orders import orders_of_test, tested_orders
from torsionnet.base.errors import UsageError
from torsionnet.base.units import RPM
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.orders.order_response import OrderResponse

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
