"""Comparison of measured order amplitudes over speed with calculated ones."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import phrase
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.orders.calculated_order import between_speeds, bound_note, largest_amplitudes
from torsionnet.machinery.orders.order_pair import (
    DELAY,
    OFFSET,
    WRONG_SIGN,
    DifferenceExplanation,
    OrderPair,
    best_explanation,
    common_turn,
    damping_difference,
    explanations,
    holds,
    peak_shift,
)
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.signals.orders.differences import NORMAL_95, PROBABILITY, amplitude_scores, consistent
from torsionnet.signals.orders.tracked_orders import MeasuredOrder

# Verdict on a measured order beside the calculated one: agreement, or what would explain the difference.

AGREES, NO_INTERVAL, WITHIN_BOUND, ABOVE_BOUND = "agrees", "no interval", "within the bound", "above the bound"
"""Verdicts on an order: the difference lies within the interval; the test states no interval; the calculated amplitude
is an upper bound, which the measured one keeps or exceeds."""
NOT_RESOLVED = "not resolved"
"""Verdict on an order whose interval is wider than the order itself, so that the test says as well that it is zero."""
UNRESOLVED = "the interval is wider than the measured amplitude: the test does not tell this order from zero"
"""Sentence on an order that the test does not resolve."""
OFFSET_OR_DELAY, PHASE = "offset or delay", "phase differs"
"""Verdicts on an order whose amplitude agrees: both explain its phase; no single number does."""
SHIFTED, DAMPING, DIFFERS = "peak at another speed", "damping differs", "amplitude differs"
"""Verdicts on an order whose amplitude does not agree."""
UNSTATED = "the test states no interval, so nothing says which difference is too large"
UNSTATED_BUT = "the test states no interval, so nothing says which difference is too large; {text}"
"""Sentence on an order without interval, and that where another one follows."""
UNEXPLAINED = "the amplitude agrees; no single offset or delay explains the phase"
"""Sentence on an order whose phase nothing explains."""
CALCULATED_ZERO = "the calculated order is zero"
"""Sentence on an order of which the calculation has nothing but rounding, so that it has no share of it."""
LARGEST_EXCESS = 1.0
"""Number of half widths by which a measured amplitude may exceed an upper bound: its own interval."""


@dataclass(frozen=True)
class OrderAgreement:
    """Verdict on a measured order beside the calculated one, and their differences in numbers.

    Attributes
    ----------
    verdict : str
        In a few words.
    sentence : str
        What would explain the difference, with numbers; empty if nothing is to be said.
    peak : float
        Peak amplitudes, (measured - calculated)/calculated in per cent.
    rms : float
        RMS of the difference over the speeds, in per cent of the calculated RMS; of complex values where phases are
        compared.
    phase_at_peak, phase_rms : float, optional
        Measured less calculated phase in degrees where the measured amplitude is largest, and its RMS weighted by the
        product of both amplitudes; None without phases.
    intervals : float, optional
        RMS distance in half widths of the interval; None without intervals.
    offset : float, optional
        Angle in rad of the reference shaft by which the test's zero lies after the calculation's.
    delay : float, optional
        Time in s by which the signal comes late.
    factor : float, optional
        Ratio of measured to calculated amplitudes.
    """

    verdict: str
    sentence: str
    peak: Annotated[float, Out(json="peak_difference_percent")]
    rms: Annotated[float, Out(json="rms_difference_percent")]
    phase_at_peak: Annotated[float | None, Out(json="phase_at_peak_deg")] = None
    phase_rms: Annotated[float | None, Out(json="phase_rms_deg")] = None
    intervals: Annotated[float | None, Out(json="rms_in_half_widths")] = None
    offset: float | None = None
    delay: Annotated[float | None, Out(json="delay_s")] = None
    factor: float | None = None

    @property
    def offset_degrees(self) -> Annotated[float | None, Out(json="offset_deg")]:
        """Angle in degrees of the reference shaft by which the test's zero lies after the calculation's."""
        return None if self.offset is None else math.degrees(self.offset)


def order_agreement(pair: OrderPair) -> OrderAgreement:
    """Verdict on a measured order with differences in per cent, degrees and half widths of the interval.

    Examples
    --------
    A test whose zero of the angle lies 5 degrees late, 30 degrees of order 6:

    >>> speeds = np.linspace(50.0, 100.0, 20)
    >>> model = 100 / (1 - (speeds / 75) ** 2 + 0.1j * speeds / 75)
    >>> test = model * np.exp(1j * np.radians(30)) + 2.0
    >>> verdict = order_agreement(OrderPair(6.0, speeds, test, model, True, np.full(20, 4.0), speeds, model))
    >>> verdict.verdict, round(float(np.degrees(verdict.offset)), 1)
    ('reference offset', 5.0)
    """
    used = pair.with_intervals()
    judgement = (_bounded(used) if used.bound else _judged(used)) if used is not None else _without_interval(pair)
    at_peak, over_speed = _phase_degrees(pair)
    test, model = np.abs(pair.measured), np.abs(pair.calculated)
    # Differences of complex values, so that a wrong phase counts as a wrong amplitude does.
    apart = float(np.mean(np.abs(pair.measured - pair.calculated) ** 2))
    return OrderAgreement(
        judgement.verdict,
        judgement.sentence if model.any() else CALCULATED_ZERO,
        100 * (float(test.max()) / float(model.max()) - 1) if model.any() else math.nan,
        100 * math.sqrt(apart / float(np.mean(model**2))) if model.any() else math.nan,
        at_peak,
        over_speed,
        None if used is None else float(np.sqrt(np.mean(used.in_intervals**2))),
        judgement.offset,
        judgement.delay,
        judgement.factor,
    )


def _phase_degrees(pair: OrderPair) -> tuple[float | None, float | None]:
    """Phase difference in degrees at the measured peak, and its RMS over speed; None without phases."""
    products = np.conj(pair.calculated) * pair.measured
    if not pair.has_phase or not products.any():
        return None, None
    # arg(conj(model) test), weighted with |model||test|: where both are small noise makes the phase.
    degrees, weights = np.degrees(np.angle(products)), np.abs(products)
    rms = float(np.sqrt((weights * degrees**2).sum() / weights.sum()))
    return float(degrees[int(np.argmax(np.abs(pair.measured)))]), rms


def _without_interval(pair: OrderPair) -> DifferenceExplanation:
    if pair.bound:
        over = bool((np.abs(pair.measured) > np.abs(pair.calculated)).any())
        return DifferenceExplanation(ABOVE_BOUND if over else WITHIN_BOUND, "", pair.calculated)
    best = best_explanation(pair, np.ones(len(pair.speeds)))
    if best is not None:
        return replace(best, verdict=NO_INTERVAL, sentence=phrase(UNSTATED_BUT, text=best.sentence))
    shift = peak_shift(pair, 0.0)
    return DifferenceExplanation(NO_INTERVAL, phrase(UNSTATED_BUT, text=shift) if shift else UNSTATED, pair.calculated)


def is_resolved(pair: OrderPair) -> bool:
    """Whether the measured amplitude of an order exceeds its half width, and no order at all would not agree as well.

    One speed of n tells by itself from sqrt(2 ln(n/0.05)) standard deviations on, which the largest of n amplitudes of
    noise exceeds in 5 of 100 tests (Rayleigh).
    """
    assert pair.half_widths is not None
    most = float((np.abs(pair.measured) / pair.half_widths).max())
    by_noise = math.sqrt(2 * math.log(len(pair.speeds) / (1 - PROBABILITY))) / NORMAL_95
    zero = DifferenceExplanation(AGREES, "", np.zeros_like(pair.calculated), 0)
    return most > by_noise or (most > 1 and not holds(zero, pair))


def _is_hidden(pair: OrderPair) -> bool:
    """Whether neither the measured nor the calculated order comes out of the interval."""
    assert pair.half_widths is not None
    return bool((np.abs(pair.calculated) <= pair.half_widths).all()) and not is_resolved(pair)


def _bounded(pair: OrderPair) -> DifferenceExplanation:
    """Verdict where the calculated amplitude is an upper bound: one side counts, at each speed."""
    assert pair.half_widths is not None
    over = (np.abs(pair.measured) - np.abs(pair.calculated)) / pair.half_widths
    at = int(over.argmax())
    if _is_hidden(pair):
        return DifferenceExplanation(NOT_RESOLVED, UNRESOLVED, pair.calculated)
    if over[at] <= LARGEST_EXCESS:
        return DifferenceExplanation(WITHIN_BOUND, "", pair.calculated)
    text = phrase(
        "at {speed:.5g} rpm by {count:.3g} half widths of the interval", speed=pair.speeds[at] * RPM, count=over[at]
    )
    return DifferenceExplanation(ABOVE_BOUND, text, pair.calculated)


def _judged(pair: OrderPair) -> DifferenceExplanation:
    widths = pair.half_widths
    assert widths is not None
    agrees = holds(DifferenceExplanation(AGREES, "", pair.calculated, 0), pair)
    if _is_hidden(pair) or (agrees and not is_resolved(pair)):
        return DifferenceExplanation(NOT_RESOLVED, UNRESOLVED, pair.calculated)
    if agrees:
        return DifferenceExplanation(AGREES, "", pair.calculated)
    # Weights of least squares: inverse variances.
    weights = 1 / widths**2
    sizes = consistent(amplitude_scores(np.abs(pair.measured), np.abs(pair.calculated), widths))
    holding = {cause.verdict: cause for cause in explanations(pair, weights) if holds(cause, pair)}
    # h alpha and -h Omega tau differ only by the change of speed: a narrow range cannot tell them apart.
    if OFFSET in holding and DELAY in holding and WRONG_SIGN not in holding:
        offset, delay = holding[OFFSET], holding[DELAY]
        text = phrase(
            "{first}, or {second}: these speeds do not tell one from the other",
            first=offset.sentence,
            second=delay.sentence,
        )
        return replace(offset, verdict=OFFSET_OR_DELAY, sentence=text, delay=delay.delay)
    if holding:
        return next(iter(holding.values()))
    best = best_explanation(pair, weights)
    if best is not None:
        return best
    if sizes:
        return DifferenceExplanation(PHASE, UNEXPLAINED, pair.calculated)
    shift = peak_shift(pair, float(widths[int(np.argmax(np.abs(pair.measured)))]))
    if shift:
        return DifferenceExplanation(SHIFTED, shift, pair.calculated)
    damping = damping_difference(pair)
    return DifferenceExplanation(DAMPING if damping else DIFFERS, damping, pair.calculated)


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

    SHOWN: ClassVar = (
        "of_reference", "rpm", "amplitude", "calculated", "pair.bound", "pair.swept", "pair.half_widths", "phases",
        "agreement.verdict", "agreement.sentence", "agreement.peak", "agreement.rms", "agreement.phase_at_peak",
        "agreement.phase_rms", "agreement.intervals", "agreement.offset_degrees", "agreement.delay",
        "agreement.factor",
    )  # fmt: skip

    measured: MeasuredOrder
    calculated: FloatArray
    curve: FloatArray
    pair: OrderPair
    agreement: OrderAgreement

    @property
    def of_reference(self) -> float:
        """Order in vibrations per revolution of the reference shaft."""
        return self.measured.order

    @property
    def rpm(self) -> Annotated[FloatArray, Out(json="speeds_rpm")]:
        """Measured speeds in r/min, shape (n,)."""
        return np.asarray(self.measured.speeds * RPM)

    @property
    def amplitude(self) -> Annotated[FloatArray, Out(json="measured")]:
        """Measured peak amplitudes in SI units of the output, shape (n,)."""
        return self.measured.amplitude

    @property
    def phases(self) -> Annotated[FloatArray | None, Out(json="phases_deg")]:
        """Phases in degrees, measured less calculated, shape (n,); None where one side has none."""
        pair = self.pair
        return np.degrees(np.angle(np.conj(pair.calculated) * pair.measured)) if pair.has_phase else None


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
    place, compared = response.output(output), []
    rising = np.argsort(response.speeds)
    speeds = response.speeds[rising]
    for order in measured:
        lines = [
            number
            for number, line in enumerate(response.lines)
            if not line.fixed and math.isclose(float(line.relative), order.order, rel_tol=SAME_ORDER_DIFFERENCE)
        ]
        inside = (order.speeds >= speeds[0] * (1 - 1e-9)) & (order.speeds <= speeds[-1] * (1 + 1e-9))
        if not lines or not inside.any():
            continue
        kept = MeasuredOrder(
            order.order,
            order.speeds[inside],
            order.amplitude[inside],
            None if order.values is None else order.values[inside],
            None if order.half_widths is None else order.half_widths[inside],
        )
        bound = largest_amplitudes(response, lines, place)
        if bound is None:
            # Known phases: complex values are interpolated, which run smoothly through a resonance.
            values = response.values[:, lines, place].sum(axis=1)
            at = between_speeds(speeds, values[rising], kept.speeds)
        else:
            values, at = bound.astype(complex), np.interp(kept.speeds, speeds, bound[rising]).astype(complex)
        # An order whose cylinders cancel is zero, and what rounding leaves of it has no share of anything.
        cancelled = float(np.abs(values).max()) <= ROUNDED_SHARE * float(np.abs(response.values[:, :, place]).max())
        if cancelled:
            values, at = np.zeros_like(values), np.zeros_like(at)
        phased = kept.values if bound is None else None
        run = next((o for o in swept if math.isclose(o.order, kept.order, rel_tol=SAME_ORDER_DIFFERENCE)), None)
        if run is not None and run.values is not None and bound is None and not cancelled:
            at = np.interp(kept.speeds, run.speeds, run.values)
            curve_speeds, curve = run.speeds, run.values
        else:
            run, curve_speeds, curve = None, speeds, values[rising]
        pair = OrderPair(
            order.order,
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
        compared.append(ComparedOrder(kept, np.abs(at), np.abs(values), pair, order_agreement(pair)))
    if not compared:
        orders = ", ".join(f"{order.order:g}" for order in measured)
        text = f"none of the measured orders of {response.reference} ({orders}) was calculated at its speeds"
        raise UsageError(f"{text}; there are {', '.join(map(str, response.lines))}", kind="unknown-order")
    return tuple(compared)


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
    left_out = [f"{order.order:g}" for order in measured if all(order.order != pair.measured.order for pair in pairs)]
    return (phrase("measured, but not calculated: {orders}", orders=", ".join(left_out)),) if left_out else ()
