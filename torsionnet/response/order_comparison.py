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
from torsionnet.response.measured.calculated_order import between_speeds, bound_note, largest_amplitudes
from torsionnet.response.measured.common_turn import common_turn
from torsionnet.response.measured.order_agreement import OrderAgreement, order_agreement
from torsionnet.response.measured.order_pair import OrderPair
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
        At the measured speeds that were calculated.
    calculated : (n,) array
        Amplitude at these speeds, SI.
    curve : (n_speeds,) array
        Amplitude at all calculated speeds, SI.
    pair : OrderPair
        The same as complex values where both sides have a phase.
    agreement : OrderAgreement
    """

    measured: MeasuredOrder
    calculated: FloatArray
    curve: FloatArray
    pair: OrderPair
    agreement: OrderAgreement


def compared_orders(
    response: OrderResponse, output: str | None, measured: Sequence[MeasuredOrder]
) -> tuple[ComparedOrder, ...]:
    """Measured orders that were also calculated, with both amplitudes (SI) over speed.

    Excitations with the same order are added with their phases. Where the response is that of the worst of several
    cases, or of engines at unknown angles, its amplitude is the largest of all: an upper bound without a phase.

    Raises
    ------
    UsageError
        There is no such output, or no measured order was calculated.
    """
    place, found = response.output(output), []
    rising = np.argsort(response.speeds)
    speeds = response.speeds[rising]
    for one in measured:
        lines = [
            number
            for number, line in enumerate(response.lines)
            if not line.fixed and math.isclose(float(line.relative), one.order, rel_tol=SAME_ORDER_DIFFERENCE)
        ]
        inside = (one.speeds >= speeds[0] * (1 - 1e-9)) & (one.speeds <= speeds[-1] * (1 + 1e-9))
        if not lines or not inside.any():
            continue
        kept = MeasuredOrder(
            one.order,
            one.speeds[inside],
            one.amplitude[inside],
            None if one.values is None else one.values[inside],
            None if one.half_widths is None else one.half_widths[inside],
        )
        bound = largest_amplitudes(response, lines, place)
        if bound is None:
            values = response.values[:, lines, place].sum(axis=1)
            at = between_speeds(speeds, values[rising], kept.speeds)
        else:
            values, at = bound.astype(complex), np.interp(kept.speeds, speeds, bound[rising]).astype(complex)
        phased = kept.values if bound is None else None
        pair = OrderPair(
            one.order,
            kept.speeds,
            kept.amplitude.astype(complex) if phased is None else phased,
            np.abs(at).astype(complex) if phased is None else at,
            phased is not None,
            kept.half_widths,
            speeds,
            values[rising],
            bound is not None,
        )
        found.append(ComparedOrder(kept, np.abs(at), np.abs(values), pair, order_agreement(pair)))
    if not found:
        orders = ", ".join(f"{one.order:g}" for one in measured)
        text = f"none of the measured orders of {response.reference} ({orders}) was calculated at its speeds"
        raise UsageError(f"{text}; there are {', '.join(map(str, response.lines))}")
    return tuple(found)


def order_comparison(
    response: OrderResponse, output: str | None, measured: Sequence[MeasuredOrder], conventions: Conventions = SI
) -> Table:
    """Table of the peak of each order, measured and calculated, with their differences in % and degrees and a verdict.

    Differences are (measured - calculated)/calculated, as of measured responses and in a measurement plan.
    """
    channel = response.outputs[response.output(output)]
    scale, unit = conventions.scale(channel.unit), conventions.unit(channel.unit)
    rows: list[tuple[object, ...]] = []
    pairs = compared_orders(response, output, measured)
    for pair in pairs:
        test, model, apart = pair.measured.amplitude, pair.calculated, pair.agreement
        first, second = int(np.argmax(test)), int(np.argmax(model))
        at = pair.measured.speeds * RPM
        peaks = (test[first] * scale, at[first], model[second] * scale, at[second])
        numbers = (apart.peak, apart.rms, apart.phase_at_peak, apart.phase_rms, apart.intervals)
        rows.append((pair.measured.order, *peaks, *numbers, apart.verdict))
    columns = (
        Column("order"),
        Column("measured peak", unit),
        Column("at", "rpm"),
        Column("calculated peak", unit),
        Column("at", "rpm"),
        Column("difference of peaks", "%", 4),
        Column("RMS difference", "%", 4),
        Column("phase at peak", "deg", 4),
        Column("RMS phase", "deg", 4),
        Column("in half widths", "", 4),
        Column("verdict"),
    )
    unused = {
        place
        for place, name in ((7, "phase_at_peak"), (8, "phase_rms"), (9, "intervals"))
        if all(getattr(pair.agreement, name) is None for pair in pairs)
    }
    kept = [place for place in range(len(columns)) if place not in unused]
    cells = tuple(tuple(row[place] for place in kept) for row in rows)
    notes = (*comparison_notes(response, pairs), *_left_out(measured, pairs))
    title = f"{response.title}: {channel.name}, test and model"
    return Table(title, tuple(columns[place] for place in kept), cells, notes)


def comparison_notes(response: OrderResponse, pairs: Sequence[ComparedOrder]) -> tuple[str, ...]:
    """Notes below a table of compared orders: what differences mean, what is compared, what would explain them."""
    notes = [
        f"orders of {response.reference}; peak amplitudes; differences are (measured - calculated)/calculated, RMS "
        "over the measured speeds"
    ]
    if any(pair.pair.has_phase for pair in pairs):
        notes.append("RMS differences are of complex values; phases are measured less calculated")
    if any(pair.agreement.intervals is not None for pair in pairs):
        notes.append(
            "in half widths: RMS distance over half of the 95 % interval; agrees: a true model differs by more in 5 of "
            "100 tests"
        )
    if any(pair.pair.bound for pair in pairs):
        notes.append(bound_note(response))
    notes += [f"order {pair.measured.order:g}: {text}" for pair in pairs if (text := pair.agreement.sentence)]
    common = common_turn([pair.pair for pair in pairs])
    return (*notes, common) if common else tuple(notes)


def _left_out(measured: Sequence[MeasuredOrder], pairs: Sequence[ComparedOrder]) -> tuple[str, ...]:
    left_out = [f"{one.order:g}" for one in measured if all(one.order != pair.measured.order for pair in pairs)]
    return (f"measured, but not calculated: {', '.join(left_out)}",) if left_out else ()


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
    """Measured and calculated peak amplitudes of one order in SI units of the output over speed in rpm.

    Phases, in degrees, are measured less calculated; distances are in half widths of the 95 % interval.
    """

    of_reference: float
    speeds: Annotated[FloatArray, Out(json="speeds_rpm")]
    measured: FloatArray
    calculated: FloatArray
    is_bound: bool
    half_widths: FloatArray | None
    phases: Annotated[FloatArray | None, Out(json="phases_deg")]
    verdict: str
    sentence: str
    peak: Annotated[float | None, Out(json="peak_difference_percent")]
    rms: Annotated[float | None, Out(json="rms_difference_percent")]
    phase_at_peak: Annotated[float | None, Out(json="phase_at_peak_deg")]
    phase_rms: Annotated[float | None, Out(json="phase_rms_deg")]
    intervals: Annotated[float | None, Out(json="rms_in_half_widths")]
    offset: Annotated[float | None, Out(json="offset_deg")]
    delay: Annotated[float | None, Out(json="delay_s")]
    factor: float | None


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
            _measured_row(pair) for pair in compared_orders(run, channel.name, measured)
        ),
    )  # fmt: skip


def _measured_row(one: ComparedOrder) -> MeasuredOrderRow:
    pair, found = one.pair, one.agreement
    return MeasuredOrderRow(
        one.measured.order, one.measured.speeds * RPM, one.measured.amplitude, one.calculated, pair.bound,
        pair.half_widths,
        np.degrees(np.angle(np.conj(pair.calculated) * pair.measured)) if pair.has_phase else None,
        found.verdict, found.sentence, found.peak, found.rms, found.phase_at_peak, found.phase_rms, found.intervals,
        None if found.offset is None else math.degrees(found.offset), found.delay, found.factor,
    )  # fmt: skip
