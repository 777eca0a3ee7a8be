"""Verdict on a measured order beside the calculated one: agreement, or what would explain the difference."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from torsionnet.base.phrases import phrase
from torsionnet.base.units import RPM
from torsionnet.machinery.orders.difference_explanations import (
    DELAY,
    OFFSET,
    WRONG_SIGN,
    DifferenceExplanation,
    best_explanation,
    damping_difference,
    explanations,
    holds,
    peak_shift,
)
from torsionnet.machinery.orders.order_pair import OrderPair
from torsionnet.signals.interval_statistics import (
    NORMAL_95,
    PROBABILITY,
    amplitude_scores,
    consistent,
)

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
    peak: float
    rms: float
    phase_at_peak: float | None = None
    phase_rms: float | None = None
    intervals: float | None = None
    offset: float | None = None
    delay: float | None = None
    factor: float | None = None


def order_agreement(pair: OrderPair) -> OrderAgreement:
    """Verdict on a measured order with differences in per cent, degrees and half widths of the interval.

    Examples
    --------
    A test whose zero of the angle lies 5 degrees late, 30 degrees of order 6:

    >>> speeds = np.linspace(50.0, 100.0, 20)
    >>> model = 100 / (1 - (speeds / 75) ** 2 + 0.1j * speeds / 75)
    >>> test = model * np.exp(1j * np.radians(30)) + 2.0
    >>> found = order_agreement(OrderPair(6.0, speeds, test, model, True, np.full(20, 4.0), speeds, model))
    >>> found.verdict, round(float(np.degrees(found.offset)), 1)
    ('reference offset', 5.0)
    """
    used = pair.with_intervals()
    found = (_bounded(used) if used.bound else _judged(used)) if used is not None else _without_interval(pair)
    at_peak, over_speed = _phase_degrees(pair)
    test, model = np.abs(pair.measured), np.abs(pair.calculated)
    apart = float(np.mean(np.abs(pair.measured - pair.calculated) ** 2))
    return OrderAgreement(
        found.verdict,
        found.sentence if model.any() else CALCULATED_ZERO,
        100 * (float(test.max()) / float(model.max()) - 1) if model.any() else math.nan,
        100 * math.sqrt(apart / float(np.mean(model**2))) if model.any() else math.nan,
        at_peak,
        over_speed,
        None if used is None else float(np.sqrt(np.mean(used.in_intervals**2))),
        found.offset,
        found.delay,
        found.factor,
    )


def _phase_degrees(pair: OrderPair) -> tuple[float | None, float | None]:
    """Phase difference in degrees at the measured peak, and its RMS over speed; None without phases."""
    products = np.conj(pair.calculated) * pair.measured
    if not pair.has_phase or not products.any():
        return None, None
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
    weights = 1 / widths**2
    sizes = consistent(amplitude_scores(np.abs(pair.measured), np.abs(pair.calculated), widths))
    holding = {one.verdict: one for one in explanations(pair, weights) if holds(one, pair)}
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
