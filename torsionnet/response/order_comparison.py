"""Comparison of measured order amplitudes over speed with calculated ones."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated

import numpy as np

from torsionnet.core.entries.spec import Schema
from torsionnet.core.errors import UsageError
from torsionnet.core.result_rows import NUMBERS, Out
from torsionnet.core.units import RPM
from torsionnet.response.conventions import SI, Conventions
from torsionnet.response.frequency_response import ComplexArray, FloatArray
from torsionnet.response.order_response import OrderResponse
from torsionnet.response.order_sums import sums_of_lines
from torsionnet.response.table import Column, Table
from torsionnet.response.worst_response import WorstResponse

SAME_ORDER_DIFFERENCE = 1e-3
"""Relative difference up to which a measured and a calculated order count as the same: a tracked order has few
digits."""


NUMBERS_BY_NAME: Schema = {"type": "object", "additionalProperties": NUMBERS}
"""JSON Schema of lists of numbers over speed by name, such as angles in degrees by engine."""
LARGEST_ANGLES: Schema = {
    **NUMBERS_BY_NAME,
    "description": "of engines that are not fixed to the first one, where the half range is "
    "largest: by how much of its crank angle each fires later",
}
"""JSON Schema of the angles in degrees between engines at which the half range is largest, over speed by engine."""
SMALLEST_RANGE: Schema = {**NUMBERS, "description": "with these engines at the best angles"}
"""JSON Schema of the smallest half range over speed, at the engine angles that give it, in SI units of the output."""
WORST_CASES: Schema = {
    "type": ["array", "null"],
    "items": {"type": "string"},
    "description": "what is worst at each speed",
}
"""JSON Schema of the names of the cases (firing conditions) with the largest half range, over speed."""
COMMON_CYCLE: Schema = {"type": ["integer", "null"], "description": "null where there is none"}
"""JSON Schema of the common cycle of all orders in revolutions of the reference shaft."""


@dataclass(frozen=True, eq=False)
class MeasuredOrder:
    """Measured peak amplitudes of one order in SI units over speed in rad/s.

    Attributes
    ----------
    order : float
        Vibrations per revolution of the reference shaft.
    speeds : (n,) array
        Speeds in rad/s, rising.
    amplitude : (n,) array
        Peak amplitudes, SI.
    values : (n,) complex array, optional
        Complex peak amplitudes X of Re X exp(j o phi), SI; None where phases are not known.
    half_widths : (n,) array, optional
        Half width of the 95 % interval of real and of imaginary part, SI.
    """

    order: float
    speeds: FloatArray
    amplitude: FloatArray
    values: ComplexArray | None = None
    half_widths: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class ComparedOrder:
    """Measured peak amplitudes of one order beside the calculated ones at the same speeds, in SI units.

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
    """Measured orders that were also calculated, with both amplitudes (SI) over speed.

    Excitations with the same order are added with their phases.

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


@dataclass(frozen=True, eq=False)
class OrderRow:
    """Complex amplitudes of one order of an excitation over speed, in SI units of the output."""

    excitation: str
    order: float
    fixed: Annotated[float, Out(json="fixed_Hz")]
    of_reference: float
    real: FloatArray
    imag: FloatArray


@dataclass(frozen=True, eq=False)
class OrderSumRow:
    """Complex amplitudes of the sum of order lines of one frequency over speed, in SI units of the output."""

    lines: str
    fixed: Annotated[float, Out(json="fixed_Hz")]
    of_reference: float
    real: FloatArray
    imag: FloatArray


@dataclass(frozen=True, eq=False)
class MeasuredOrderRow:
    """Measured and calculated peak amplitudes of one order in SI units of the output over speed in rpm."""

    of_reference: float
    speeds: Annotated[FloatArray, Out(json="speeds_rpm")]
    measured: FloatArray
    calculated: FloatArray


@dataclass(frozen=True, eq=False)
class OrderOutputRow:
    """Half range, RMS and orders of one output over speed as plain data, in SI units of the output."""

    output: str
    unit: str
    half_range: FloatArray
    rms: FloatArray
    cases: Annotated[tuple[str, ...] | None, Out(schema=WORST_CASES)]
    angles: Annotated[Mapping[str, FloatArray] | None, Out(json="angles_deg", optional=True, schema=LARGEST_ANGLES)]
    smallest_half_range: Annotated[FloatArray | None, Out(optional=True, schema=SMALLEST_RANGE)]
    smallest_at: Annotated[
        Mapping[str, FloatArray] | None, Out(json="smallest_at_deg", optional=True, schema=NUMBERS_BY_NAME)
    ]
    orders: tuple[OrderRow, ...]
    sums: tuple[OrderSumRow, ...]
    measured: Annotated[tuple[MeasuredOrderRow, ...] | None, Out(optional=True)]


@dataclass(frozen=True, eq=False)
class OrdersRecord:
    """Order responses of one configuration (SI, speeds in rpm), as ``torsionnet orders --json`` prints them."""

    title: str
    configuration: str
    reference: Annotated[str, Out(json="speed_of")]
    speeds: Annotated[FloatArray, Out(json="speeds_rpm")]
    revolutions: Annotated[int | None, Out(json="common_cycle_revolutions", schema=COMMON_CYCLE)]
    outputs: tuple[OrderOutputRow, ...]


def orders_record(
    run: OrderResponse, configuration: str = "", tests: Mapping[str, Sequence[MeasuredOrder]] = MappingProxyType({})
) -> OrdersRecord:
    """Order responses of one configuration as plain data for JSON, amplitudes in SI units, speeds in rpm."""
    outputs = tuple(_output_row(run, place, tests.get(channel.name)) for place, channel in enumerate(run.outputs))
    return OrdersRecord(run.title, configuration, run.reference, run.rpm, run.revolutions, outputs)


def _output_row(run: OrderResponse, place: int, measured: Sequence[MeasuredOrder] | None) -> OrderOutputRow:
    channel, worst = run.outputs[place], run if isinstance(run, WorstResponse) else None
    turning = worst if worst and worst.angles else None
    sums = ((one, run.values[:, list(one.places), place].sum(axis=1)) for one in sums_of_lines(run.lines))
    orders = ((line, run.values[:, number, place]) for number, line in enumerate(run.lines))
    return OrderOutputRow(
        channel.name, channel.unit, run.half_range[:, place], run.rms[:, place],
        worst.cases(channel.name) if worst else None,
        {one.engine: one.degrees[:, place] for one in turning.angles} if turning else None,
        turning.least.half_range[:, place] if turning else None,
        {one.engine: one.degrees[:, place] for one in turning.least.angles} if turning else None,
        tuple(
            OrderRow(line.excitation, line.order, line.fixed, float(line.relative), values.real, values.imag)
            for line, values in orders
        ),
        tuple(OrderSumRow(one.name, one.fixed, one.order, values.real, values.imag) for one, values in sums),
        None if measured is None else tuple(
            MeasuredOrderRow(pair.measured.order, pair.measured.speeds * RPM, pair.measured.amplitude, pair.calculated)
            for pair in compared_orders(run, channel.name, measured)
        ),
    )  # fmt: skip
