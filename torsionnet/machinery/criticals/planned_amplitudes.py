"""Amplitudes of single orders that a calculation expects at speeds planned for a measurement on board."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsionnet.base.phrases import Phrase, extended, joined, phrase
from torsionnet.base.units import RPM
from torsionnet.machinery.orders.order_comparison import SAME_ORDER_DIFFERENCE
from torsionnet.machinery.orders.order_line import lines_of_one_frequency, sum_name
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.signals.orders.tracked_orders import MeasuredOrder

MOST_CRITICAL, MOST_ORDERS = 5, 3
"""Largest numbers of critical speeds of an output, and of orders at each speed, in a list for a measurement."""
SMALLEST_SHARE = 0.05
"""Ratio of an order's amplitude to the half range at its speed, or to the largest half range, below which it is left
out: it would drown in what a torsiograph resolves."""
SAME_SPEED = 0.005
"""Relative difference up to which two speeds count as one: a tachometer shows no more."""
ROUNDING = 1e-9
"""Relative difference of two speeds that is no more than rounding."""


@dataclass(frozen=True)
class PlannedSpeed:
    """Speed in rad/s of the reference shaft at which vibration is to be measured, and the reason as a text.

    One that ``is_fixed``, as the rated speed, is measured itself and not at the peak of an order near it.
    """

    speed: float
    reason: str
    is_fixed: bool = False


@dataclass(frozen=True)
class PlannedAmplitude:
    """Expected peak amplitude of one order at one speed, and half range at that speed, SI units of the output.

    Attributes
    ----------
    speed : float
        Speed of the reference shaft, rad/s.
    reason : str
        Why this speed is measured.
    order : float
        Vibrations per revolution of the reference shaft.
    name : str
        Excitations with their orders, such as ``engine 4 + propeller 4``.
    amplitude : float
        Peak value of the order, excitations of one frequency added with their phases.
    half_range : float
        Half the range of the sum of all orders at this speed.
    """

    speed: float
    reason: str
    order: float
    name: str
    amplitude: float
    half_range: float

    @property
    def rpm(self) -> float:
        """Speed of the reference shaft in r/min at which an amplitude is planned to be measured."""
        return self.speed * RPM


def critical_peaks(run: OrderResponse) -> tuple[PlannedSpeed, ...]:
    """Speeds in rad/s of the largest peaks of single orders of the output inside the speed range, by rising speed.

    Examples
    --------
    >>> import torsionnet as tn
    >>> ship = tn.load("two_stroke_ship").configured("normal")
    >>> peaks = critical_peaks(ship.order_response("torque(intermediate)", refine=True))
    >>> [(round(peak.speed * 30 / np.pi), peak.reason) for peak in peaks][:1]
    [(52, 'peak of order 6')]
    """
    place, peaks = run.output(None), []
    largest = float(run.half_range[:, place].max())
    sizes = np.abs(run.by_frequency()[:, :, place])
    for number, lines in enumerate(lines_of_one_frequency(run.lines)):
        line, size = run.lines[lines[0]], sizes[:, number]
        # A fixed frequency follows no speed: its maximum is none of a critical speed.
        if line.fixed:
            continue
        # Maxima with a lower value on either side; one at an end of the range may lie outside.
        inside = np.flatnonzero((size[1:-1] > size[:-2]) & (size[1:-1] >= size[2:])) + 1
        inside = inside[size[inside] >= SMALLEST_SHARE * largest]
        reason = phrase("peak of order {order:.4g}", order=float(line.relative))
        peaks += [(float(size[at]), PlannedSpeed(float(run.speeds[at]), reason)) for at in inside]
    peaks.sort(key=lambda peak: -peak[0])
    return tuple(sorted((planned for _, planned in peaks[:MOST_CRITICAL]), key=lambda planned: planned.speed))


def merged_speeds(speeds: Sequence[PlannedSpeed]) -> tuple[PlannedSpeed, ...]:
    """Planned speeds in rad/s, rising, those that a tachometer cannot tell apart merged into one with all reasons.

    Examples
    --------
    >>> peaks = [PlannedSpeed(1.0, "order 3"), PlannedSpeed(1.001, "order 4")]
    >>> planned = merged_speeds([*peaks, PlannedSpeed(1.002, "rated", True)])
    >>> [(speed.speed, speed.reason) for speed in planned]
    [(1.0, 'order 3; order 4'), (1.002, 'rated')]
    """
    merged: list[PlannedSpeed] = []
    for planned in sorted(speeds, key=lambda planned: planned.speed):
        # The value of a narrow peak is none of the rated speed beside it.
        within = SAME_SPEED if merged and merged[-1].is_fixed == planned.is_fixed else ROUNDING
        if merged and math.isclose(merged[-1].speed, planned.speed, rel_tol=within):
            merged[-1] = replace(merged[-1], reason=_both(merged[-1].reason, planned.reason))
        else:
            merged.append(planned)
    return tuple(merged)


def _both(first: str, second: str) -> str:
    """Two reasons for a speed; fixed words beside the one with a place belong to its template."""
    if isinstance(second, Phrase) and not isinstance(first, Phrase):
        return Phrase(f"{first}; {second.template}", second.values)
    return joined("; ", (first, second)) if isinstance(second, Phrase) else extended(first, f"; {second}")


def planned_amplitudes(
    run: OrderResponse, speeds: Sequence[PlannedSpeed], output: str | None = None
) -> tuple[PlannedAmplitude, ...]:
    """Expected amplitudes of an output in SI units by speed and order, the largest orders of each speed first.

    ``run`` is the response at these speeds, one after the other.
    """
    place, amplitudes = run.output(output), []
    sizes = np.abs(run.by_frequency()[:, :, place])
    groups = lines_of_one_frequency(run.lines)
    for at, planned in enumerate(speeds):
        half_range = float(run.half_range[at, place])
        for number in np.argsort(-sizes[at], kind="stable")[:MOST_ORDERS].tolist():
            lines = [run.lines[index] for index in groups[number]]
            size = float(sizes[at, number])
            if lines[0].fixed or size < SMALLEST_SHARE * half_range:
                continue
            amplitudes.append(
                PlannedAmplitude(
                    planned.speed, planned.reason, float(lines[0].relative), sum_name(lines), size, half_range
                )
            )
    return tuple(amplitudes)


def measured_at(planned: PlannedAmplitude, measured: Sequence[MeasuredOrder]) -> float | None:
    """Measured peak amplitude in SI units at the speed and order of a planned amplitude; None where none was measured.

    Between measured speeds it is linear.

    Examples
    --------
    >>> test = MeasuredOrder(6.0, np.array([5.0, 6.0]), np.array([1.0, 2.0]))
    >>> measured_at(PlannedAmplitude(5.5, "peak of order 6", 6.0, "engine 6", 1.6, 2.0), [test])
    1.5
    """
    for order in measured:
        if math.isclose(order.order, planned.order, rel_tol=SAME_ORDER_DIFFERENCE) and len(order.speeds):
            low, high = order.speeds[0] * (1 - SAME_SPEED), order.speeds[-1] * (1 + SAME_SPEED)
            if low <= planned.speed <= high:
                return float(np.interp(planned.speed, order.speeds, order.amplitude))
    return None
