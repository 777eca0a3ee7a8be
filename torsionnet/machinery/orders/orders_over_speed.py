"""Order responses as plain data for JSON, with the measured orders beside them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated

from torsionnet.base.entries.spec import Schema
from torsionnet.base.result_rows import NUMBERS, Out
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.orders.order_comparison import ComparedOrder, compared_orders
from torsionnet.machinery.orders.order_line import sums_of_lines
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.worst_response import WorstResponse
from torsionnet.signals.orders.tracked_orders import MeasuredOrder

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
class OrderOverSpeed:
    """Complex amplitudes of one order of an excitation over speed, in SI units of the output."""

    excitation: str
    order: float
    fixed: Annotated[float, Out(json="fixed_Hz")]
    of_reference: float
    real: FloatArray
    imag: FloatArray


@dataclass(frozen=True, eq=False)
class OrderSumOverSpeed:
    """Complex amplitudes of the sum of order lines of one frequency over speed, in SI units of the output."""

    lines: str
    fixed: Annotated[float, Out(json="fixed_Hz")]
    of_reference: float
    real: FloatArray
    imag: FloatArray


@dataclass(frozen=True, eq=False)
class OutputOverSpeed:
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
    orders: tuple[OrderOverSpeed, ...]
    sums: tuple[OrderSumOverSpeed, ...]
    measured: Annotated[tuple[ComparedOrder, ...] | None, Out(optional=True)]


@dataclass(frozen=True, eq=False)
class OrdersOverSpeed:
    """Order responses of one configuration (SI, speeds in rpm), as ``torsionnet orders --json`` prints them."""

    title: str
    configuration: str
    reference: Annotated[str, Out(json="speed_of")]
    speeds: Annotated[FloatArray, Out(json="speeds_rpm")]
    revolutions: Annotated[int | None, Out(json="common_cycle_revolutions", schema=COMMON_CYCLE)]
    outputs: tuple[OutputOverSpeed, ...]


def orders_over_speed(
    run: OrderResponse,
    configuration: str = "",
    tests: Mapping[str, Sequence[MeasuredOrder]] = MappingProxyType({}),
    swept: Mapping[str, Sequence[MeasuredOrder]] = MappingProxyType({}),
) -> OrdersOverSpeed:
    """Order responses of one configuration as plain data for JSON, amplitudes in SI units, speeds in rpm."""
    outputs = tuple(
        _output_row(run, place, tests.get(channel.name), swept.get(channel.name, ()))
        for place, channel in enumerate(run.outputs)
    )
    return OrdersOverSpeed(run.title, configuration, run.reference, run.rpm, run.revolutions, outputs)


def _output_row(
    run: OrderResponse, place: int, measured: Sequence[MeasuredOrder] | None, swept: Sequence[MeasuredOrder]
) -> OutputOverSpeed:
    channel, worst = run.outputs[place], run if isinstance(run, WorstResponse) else None
    turning = worst if worst and worst.angles else None
    sums = ((total, run.values[:, list(total.places), place].sum(axis=1)) for total in sums_of_lines(run.lines))
    orders = ((line, run.values[:, number, place]) for number, line in enumerate(run.lines))
    return OutputOverSpeed(
        channel.name, channel.unit, run.half_range[:, place], run.rms[:, place],
        worst.cases(channel.name) if worst else None,
        {angle.engine: angle.degrees[:, place] for angle in turning.angles} if turning else None,
        turning.least.half_range[:, place] if turning else None,
        {angle.engine: angle.degrees[:, place] for angle in turning.least.angles} if turning else None,
        tuple(
            OrderOverSpeed(line.excitation, line.order, line.fixed, float(line.relative), values.real, values.imag)
            for line, values in orders
        ),
        tuple(
            OrderSumOverSpeed(total.name, total.fixed, total.order, values.real, values.imag) for total, values in sums
        ),
        None if measured is None else compared_orders(run, channel.name, measured, swept),
    )  # fmt: skip
