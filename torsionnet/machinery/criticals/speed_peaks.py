"""Peaks over speed of an order's amplitude next to a critical speed, and amplitudes expected at planned speeds.

With damping a peak lies neither at the undamped nor at the damped frequency: the torques grow with speed, other modes
add their share, and every output has a peak of its own.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import Phrase, extended, joined, phrase
from torsionnet.base.units import RPM
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.frequency_response import Channel, FloatArray
from torsionnet.linear.responses.grid import inner_maxima
from torsionnet.machinery.criticals.critical_speeds import CriticalSpeed, SpeedPeak
from torsionnet.machinery.orders.order_comparison import SAME_ORDER_DIFFERENCE
from torsionnet.machinery.orders.order_line import lines_of_one_frequency, sum_name
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.order_solution import orders_at_speeds
from torsionnet.machinery.orders.speed_refinement import SAME_SPEED_DISTANCE
from torsionnet.model.parameters import VIBRATORY_TORQUE
from torsionnet.signals.orders.tracked_orders import MeasuredOrder

# Peaks over speed of the amplitude of an order, next to a critical speed.

POINTS, FINER_POINTS, ROUNDS = 41, 11, 3
"""Number of speeds of the first grid around a critical speed, of each finer grid, and number of finer grids.

More of them place peaks more finely and solve more speeds.
"""
WIDTHS, LEAST_WIDTH, MOST_WIDTH = 8.0, 0.03, 0.35
"""Half width of the searched speeds, over the critical speed, in damping ratios, with its least and most value.

Wider searches find peaks that the damping shifts far, and mistake peaks of other orders for them.
"""
SAME_PEAK = 1e-3
"""Relative distance of speeds below which peaks of two crossings are one peak, as the search places peaks more finely
than that."""


def with_speed_peaks(
    drivetrain: AssembledModel,
    crossings: Sequence[CriticalSpeed],
    outputs: Any,
    reference: str,
    limits: tuple[float, float],
) -> tuple[tuple[CriticalSpeed, ...], tuple[Channel, ...]]:
    """Critical speeds with the peaks of their orders within the speed limits (rad/s), and the output channels.

    A peak belongs only to the crossing nearest to it.

    Raises
    ------
    UsageError
        A parameter depends on the vibration of all excitations together, so that single orders have no peaks.
    """
    swayed = [name for name, law in drivetrain.definition.following.items() if law.by == VIBRATORY_TORQUE]
    if swayed:
        text = f"{' and '.join(swayed)} follows the vibration of all excitations together"
        raise UsageError(
            f"{text}: no order has a peak of its own; leave out the outputs and see torsionnet orders",
            kind="no-solution",
        )
    sought = [crossing for crossing in crossings if crossing.excited and crossing.natural_speed > 0]
    peaks: dict[int, tuple[SpeedPeak, ...]] = {}
    channels: tuple[Channel, ...] = ()
    for name, group in groupby(
        sorted(sought, key=lambda crossing: crossing.excitation), key=lambda crossing: crossing.excitation
    ):
        search = _Search(drivetrain, outputs, reference, name, list(group), limits)
        peaks |= search.peaks()
        channels = search.channels
    if not channels:
        channels = orders_at_speeds(drivetrain, outputs, speeds=[limits[0] or limits[1]], speed_of=reference).outputs
    return tuple(replace(crossing, peaks=peaks.get(id(crossing), ())) for crossing in crossings), channels


class _Search:
    """Search for the peaks over speed of the orders of one excitation.

    Every step solves the speeds of all crossings together.
    """

    def __init__(
        self,
        drivetrain: AssembledModel,
        outputs: Any,
        reference: str,
        excitation: str,
        crossings: list[CriticalSpeed],
        limits: tuple[float, float],
    ) -> None:
        self.drivetrain, self.outputs, self.reference, self.excitation = drivetrain, outputs, reference, excitation
        self.crossings, self.limits = crossings, limits
        self.channels: tuple[Channel, ...] = ()

    def peaks(self) -> dict[int, tuple[SpeedPeak, ...]]:
        """Peaks (speed in rad/s and amplitude) by ``id`` of the critical speed, one for each output that has a peak."""
        grids = [self._around(crossing) for crossing in self.crossings]
        first = self._amplitudes(self.crossings, grids)
        peaks: dict[int, tuple[SpeedPeak, ...]] = {}
        for place, channel in enumerate(self.channels):
            starts = {
                number: self._next_maximum(crossing, grids[number], first[number][:, place])
                for number, crossing in enumerate(self.crossings)
            }
            refined = self._refined({number: grid for number, grid in starts.items() if grid is not None}, place)
            for number, peak in self._claimed(refined).items():
                crossing = self.crossings[number]
                peaks[id(crossing)] = (*peaks.get(id(crossing), ()), SpeedPeak(channel.name, *peak))
        return peaks

    def _around(self, crossing: CriticalSpeed) -> FloatArray:
        # A peak is wider in proportion to zeta and further from the critical speed the more it is damped.
        width = min(max(WIDTHS * crossing.mode.damping_ratio, LEAST_WIDTH), MOST_WIDTH)
        critical = crossing.natural_speed
        low, high = np.clip(critical * np.array([1 - width, 1 + width]), *self.limits)
        return _around(low, critical, high, POINTS) if high > low else np.zeros(0)

    def _amplitudes(self, crossings: Sequence[CriticalSpeed], grids: Sequence[FloatArray]) -> list[FloatArray]:
        """Amplitudes (n, n_out), in the unit of each output, of each crossing's order at its own speeds."""
        speeds = np.unique(np.concatenate(grids)) if grids else np.zeros(0)
        if not len(speeds):
            return [np.zeros((0, len(self.channels))) for _ in crossings]
        run = orders_at_speeds(
            self.drivetrain, self.outputs, speeds=speeds, speed_of=self.reference, excitations=[self.excitation]
        )
        self.channels = run.outputs
        lines = {(line.order, line.fixed): place for place, line in enumerate(run.lines)}
        return [
            run.sizes[np.searchsorted(speeds, grid), lines[crossing.order, crossing.fixed]]
            for crossing, grid in zip(crossings, grids, strict=True)
        ]

    @staticmethod
    def _next_maximum(crossing: CriticalSpeed, grid: FloatArray, sizes: FloatArray) -> FloatArray | None:
        """Finer speeds (n,) in rad/s around the maximum nearest to the critical speed, or None without maximum."""
        inner = inner_maxima(sizes) if len(sizes) else []
        if not inner:
            return None
        # Nearest by the ratio of speeds, as half and twice the critical speed are equally far.
        best = min(inner, key=lambda place: abs(math.log(grid[place] / crossing.natural_speed)))
        return _around(grid[best - 1], grid[best], grid[best + 1], FINER_POINTS)

    def _refined(self, grids: dict[int, FloatArray], output: int) -> dict[int, tuple[float, float]]:
        """Speed in rad/s and amplitude at each maximum, by number of its critical speed, found on ever finer grids."""
        maxima: dict[int, tuple[float, float]] = {}
        for _ in range(ROUNDS if grids else 0):
            sizes = self._amplitudes([self.crossings[number] for number in grids], list(grids.values()))
            for (number, grid), size in zip(list(grids.items()), sizes, strict=True):
                # The maximum lies between the neighbours of the highest speed: each round divides these two steps
                # anew.
                best = int(np.argmax(size[:, output]))
                maxima[number] = (float(grid[best]), float(size[best, output]))
                low, high = grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]
                grids[number] = _around(low, grid[best], high, FINER_POINTS)
        return maxima

    def _claimed(self, peaks: Mapping[int, tuple[float, float]]) -> dict[int, tuple[float, float]]:
        """Speed in rad/s and amplitude of peaks, by number of the critical speed to which each peak is nearest.

        They are not nearer to another critical speed of the same order.
        """
        kept = {}
        for number, (speed, size) in peaks.items():
            crossing = self.crossings[number]
            # Two modes near each other may both find the one peak between them: it belongs to the nearer one.
            rivals = [
                other
                for rival, other in enumerate(self.crossings)
                if rival in peaks and other.line == crossing.line and abs(peaks[rival][0] / speed - 1) < SAME_PEAK
            ]
            nearest = min(rivals, key=lambda other: abs(math.log(speed / other.natural_speed)))
            if nearest is crossing:
                kept[number] = (speed, size)
        return kept


def _around(low: float, place: float, high: float, count: int) -> FloatArray:
    """Rising speeds from ``low`` to ``high`` in rad/s, in ``count`` - 1 equal steps, and the speed of a narrow peak."""
    grid = np.linspace(low, high, count)
    is_new = np.abs(grid - place).min() > SAME_SPEED_DISTANCE * place
    return np.union1d(grid, [place]) if low < place < high and is_new else grid


# Amplitudes of single orders that a calculation expects at speeds planned for a measurement on board.

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
