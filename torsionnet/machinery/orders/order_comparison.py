"""Comparison of measured order amplitudes over speed with calculated ones."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import phrase
from torsionnet.base.table import Column, Table
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.orders.calculated_order import between_speeds, bound_note, largest_amplitudes
from torsionnet.machinery.orders.common_turn import common_turn
from torsionnet.machinery.orders.order_agreement import OrderAgreement, order_agreement
from torsionnet.machinery.orders.order_pair import OrderPair
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.signals.orders.tracked_orders import MeasuredOrder

SAME_ORDER_DIFFERENCE = 1e-3
"""Relative difference up to which a measured and a calculated order count as the same: a tracked order has few
digits."""
ROUNDED_SHARE = 1e-12
"""Share of the largest order of an output that rounding may leave of one whose contributions cancel."""


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
    response: OrderResponse, output: str | None, measured: Sequence[MeasuredOrder], swept: Sequence[MeasuredOrder] = ()
) -> tuple[ComparedOrder, ...]:
    """Measured orders that were also calculated, with both amplitudes (SI) over speed.

    Excitations with the same order are added with their phases. Where the response is that of the worst of several
    cases, or of engines at unknown angles, its amplitude is the largest of all: an upper bound without a phase.
    Where ``swept`` has the order, as the model shows it along the speed over time of the test, that is the calculated
    side.

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
        # An order whose cylinders cancel is zero, and what rounding leaves of it has no share of anything.
        cancelled = float(np.abs(values).max()) <= ROUNDED_SHARE * float(np.abs(response.values[:, :, place]).max())
        if cancelled:
            values, at = np.zeros_like(values), np.zeros_like(at)
        phased = kept.values if bound is None else None
        run = next((one for one in swept if math.isclose(one.order, kept.order, rel_tol=SAME_ORDER_DIFFERENCE)), None)
        if run is not None and run.values is not None and bound is None and not cancelled:
            at = np.interp(kept.speeds, run.speeds, run.values)
            curve_speeds, curve = run.speeds, run.values
        else:
            run, curve_speeds, curve = None, speeds, values[rising]
        pair = OrderPair(
            one.order,
            kept.speeds,
            kept.amplitude.astype(complex) if phased is None else phased,
            np.abs(at).astype(complex) if phased is None else at,
            phased is not None,
            kept.half_widths,
            curve_speeds,
            curve,
            bound is not None,
            run is not None,
        )
        found.append(ComparedOrder(kept, np.abs(at), np.abs(values), pair, order_agreement(pair)))
    if not found:
        orders = ", ".join(f"{one.order:g}" for one in measured)
        text = f"none of the measured orders of {response.reference} ({orders}) was calculated at its speeds"
        raise UsageError(f"{text}; there are {', '.join(map(str, response.lines))}")
    return tuple(found)


def order_comparison(
    response: OrderResponse,
    output: str | None,
    measured: Sequence[MeasuredOrder],
    conventions: Conventions = SI,
    swept: Sequence[MeasuredOrder] = (),
) -> Table:
    """Table of the peak of each order, measured and calculated, with their differences in % and degrees and a verdict.

    Differences are (measured - calculated)/calculated, as of measured responses and in a measurement plan.
    """
    channel = response.outputs[response.output(output)]
    scale, unit = conventions.scale(channel.unit), conventions.unit(channel.unit)
    rows: list[tuple[object, ...]] = []
    pairs = compared_orders(response, output, measured, swept)
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
    notes = (*comparison_notes(response, pairs), *not_compared(measured, pairs))
    title = f"{response.title}: {channel.name}, test and model"
    return Table(title, tuple(columns[place] for place in kept), cells, notes)


def comparison_notes(response: OrderResponse, pairs: Sequence[ComparedOrder]) -> tuple[str, ...]:
    """Notes below a table of compared orders: what differences mean, what is compared, what would explain them."""
    notes = [*meaning_notes(response, pairs)]
    notes += [f"order {pair.measured.order:g}: {text}" for pair in pairs if (text := pair.agreement.sentence)]
    common = common_turn([pair.pair for pair in pairs])
    return (*notes, common) if common else tuple(notes)


def meaning_notes(response: OrderResponse, pairs: Sequence[ComparedOrder]) -> tuple[str, ...]:
    """Notes on what the differences of compared orders are, and whether the calculated side is a bound."""
    notes = [
        phrase(
            "orders of {reference}; peak amplitudes; differences are (measured - calculated)/calculated, "
            "RMS over the measured speeds",
            reference=response.reference,
        )
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
    orders = ", ".join(f"{pair.measured.order:g}" for pair in pairs if pair.pair.swept)
    if orders:
        notes.append(
            phrase(
                "order {orders} compared with the response along the measured speed over time, averaged over "
                "whole cycles as the test",
                orders=orders,
            )
        )
    return tuple(notes)


def not_compared(measured: Sequence[MeasuredOrder], pairs: Sequence[ComparedOrder]) -> tuple[str, ...]:
    """Note that names the measured orders that were not calculated; nothing if all were."""
    left_out = [f"{one.order:g}" for one in measured if all(one.order != pair.measured.order for pair in pairs)]
    return (phrase("measured, but not calculated: {orders}", orders=", ".join(left_out)),) if left_out else ()
