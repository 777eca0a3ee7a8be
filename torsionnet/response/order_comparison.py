"""Comparison of measured order amplitudes over speed with calculated ones."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from torsionnet.core.errors import UsageError
from torsionnet.core.units import RPM
from torsionnet.response.conventions import SI, Conventions
from torsionnet.response.frequency_response import FloatArray
from torsionnet.response.order_response import OrderResponse
from torsionnet.response.table import Column, Table

SAME_ORDER_DIFFERENCE = 1e-3
"""Relative difference up to which two orders are the same: a tracked order has few digits."""


@dataclass(frozen=True, eq=False)
class MeasuredOrder:
    """Measured amplitude of one order over speed.

    Attributes
    ----------
    order : float
        Vibrations per revolution of the reference shaft.
    speeds : (n,) array
        Speeds in rad/s, rising.
    amplitude : (n,) array
        Peak amplitudes, SI.
    """

    order: float
    speeds: FloatArray
    amplitude: FloatArray


@dataclass(frozen=True, eq=False)
class ComparedOrder:
    """Measured order with the calculated amplitude at the same speeds.

    Attributes
    ----------
    measured : MeasuredOrder
        Measured order, at speeds within the calculated range.
    calculated : (n,) array
        Amplitude at the measured speeds, SI; linear between the calculated speeds.
    curve : (n_speeds,) array
        Amplitude at all calculated speeds, SI.
    """

    measured: MeasuredOrder
    calculated: FloatArray
    curve: FloatArray


def compared_orders(
    response: OrderResponse, output: str | None, measured: Sequence[MeasuredOrder]
) -> tuple[ComparedOrder, ...]:
    """Measured orders that were also calculated; excitations with the same order are added with their phases.

    Raises
    ------
    UsageError
        There is no such output, or no measured order was calculated.
    """
    place, found = response.output(output), []
    for one in measured:
        lines = [
            number
            for number, line in enumerate(response.lines)
            if not line.fixed and math.isclose(float(line.relative), one.order, rel_tol=SAME_ORDER_DIFFERENCE)
        ]
        low, high = response.speeds.min(), response.speeds.max()
        inside = (one.speeds >= low * (1 - 1e-9)) & (one.speeds <= high * (1 + 1e-9))
        if lines and inside.any():
            kept = MeasuredOrder(one.order, one.speeds[inside], one.amplitude[inside])
            size = np.abs(response.values[:, lines, place].sum(axis=1))
            rising = np.argsort(response.speeds)
            found.append(ComparedOrder(kept, np.interp(kept.speeds, response.speeds[rising], size[rising]), size))
    if not found:
        orders = ", ".join(f"{one.order:g}" for one in measured)
        text = f"none of the measured orders of {response.reference} ({orders}) was calculated at its speeds"
        raise UsageError(f"{text}; there are {', '.join(map(str, response.lines))}")
    return tuple(found)


def order_comparison(
    response: OrderResponse, output: str | None, measured: Sequence[MeasuredOrder], conventions: Conventions = SI
) -> Table:
    """Table of the largest amplitude of each order, measured and calculated, and their RMS difference over speed."""
    channel = response.outputs[response.output(output)]
    scale, unit = conventions.scale(channel.unit), conventions.unit(channel.unit)
    rows, pairs = [], compared_orders(response, output, measured)
    for pair in pairs:
        test, model = pair.measured.amplitude, pair.calculated
        first, second = int(np.argmax(test)), int(np.argmax(model))
        rms = float(np.sqrt(np.mean((model - test) ** 2) / np.mean(test**2))) if test.any() else math.nan
        peak = float(100 * (model[second] / test[first] - 1)) if test[first] else math.nan
        at = pair.measured.speeds * RPM
        rows.append(
            (pair.measured.order, test[first] * scale, at[first], model[second] * scale, at[second], peak, 100 * rms)
        )
    columns = (
        Column("order"),
        Column("measured peak", unit),
        Column("at", "rpm"),
        Column("calculated peak", unit),
        Column("at", "rpm"),
        Column("difference of peaks", "%"),
        Column("RMS difference", "%"),
    )
    notes = [
        f"orders of {response.reference}; peak amplitudes; RMS difference over the measured speeds, of the measured RMS"
    ]
    left_out = [f"{one.order:g}" for one in measured if all(one.order != pair.measured.order for pair in pairs)]
    notes += [f"measured, but not calculated: {', '.join(left_out)}"] if left_out else []
    return Table(f"{response.title}: {channel.name}, test and model", columns, tuple(rows), tuple(notes))
