"""Calculated side of a comparison with measured orders: values between speeds, and bounds where phases are unknown."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import phrase
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.linear.modes.natural_modes import modes
from torsionnet.machinery.orders.order_line import engine_blocks
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.worst_response import WorstResponse
from torsionnet.machinery.passage.passage_response import PassageResponse
from torsionnet.machinery.passage.passage_solution import MOST_SPEED_POINTS, passage_response
from torsionnet.model.channels import Sensor
from torsionnet.signals.orders.cycle_average import averaged_blocks
from torsionnet.signals.orders.mean_rotation import MeanRotation
from torsionnet.signals.orders.tracked_orders import MeasuredOrder, TrackedOrders
from torsionnet.signals.recording import QUANTITY_UNITS
from torsionnet.signals.sweep_loss import sweep_remarks

LEAST_FOR_SPLINE = 4
"""Number of speeds from which complex values between them are taken from a cubic spline."""


def between_speeds(speeds: FloatArray, values: ComplexArray, at: FloatArray) -> ComplexArray:
    """Complex values in SI at speeds between calculated ones, which rise, by a cubic spline, shape (n,)."""
    if len(speeds) < LEAST_FOR_SPLINE:
        return np.asarray(np.interp(at, speeds, values.real) + 1j * np.interp(at, speeds, values.imag))
    from scipy.interpolate import CubicSpline  # loads much that no other path here needs

    return np.asarray(CubicSpline(speeds, values)(at), dtype=np.complex128)


def largest_amplitudes(response: OrderResponse, lines: Sequence[int], output: int) -> FloatArray | None:
    """Largest amplitude (SI) that some lines of one order can have together, shape (n_speeds,).

    None where all phases are known, so that their sum has one value. Engines at unknown angles add their magnitudes;
    of several cases the largest one counts.
    """
    if isinstance(response, WorstResponse):
        parts = [_added(case, lines, output) for case in response.case_responses]
        parts += [_added(case, lines, output) for case in response.each]
        return np.asarray(np.max([np.abs(response.values[:, lines, output].sum(axis=1)), *parts], axis=0))
    owners = [block for block in engine_blocks(response.lines) if {*block.places} & {*lines}]
    return _added(response, lines, output) if len(owners) > 1 else None


def _added(response: OrderResponse, lines: Sequence[int], output: int) -> FloatArray:
    """Sum over engines at unknown angles of the magnitudes of an order, shape (n_speeds,)."""
    parts = [[at for at in block.places if at in lines] for block in engine_blocks(response.lines)]
    sizes = [np.abs(response.values[:, part, output].sum(axis=1)) for part in parts if part]
    return np.asarray(np.sum(sizes, axis=0))


def bound_note(response: OrderResponse) -> str:
    """Note on why the calculated amplitudes are upper bounds without phases."""
    why = []
    if isinstance(response, WorstResponse):
        cases, engines = len(response.labels), " and ".join(angle.engine for angle in response.angles)
        if cases > 1 and engines:
            why.append(
                phrase("the worst of {count} cases and the worst angle of {engines}", count=cases, engines=engines)
            )
        elif cases > 1 or engines:
            why.append(
                phrase("the worst angle of {engines}", engines=engines)
                if engines
                else phrase("the worst of {count} cases", count=cases)
            )
        why += (
            [phrase("the worst scatter of {names}", names=", ".join(response.scattered))] if response.scattered else []
        )
    else:
        why += ["every angle between engines of which the model gives none"]
    reason = " and ".join(why) or "all cases"
    return phrase(
        "calculated amplitudes are upper bounds, over {why}, and have no phase: name the case that was "
        "tested, or give the phases between engines, to compare phases",
        why=reason,
    )


# Orders that a model shows along the measured speed over time, tracked as those of the test.

SHORTEST_CYCLE, LONGEST_CYCLE = 2, 8
"""Revolutions of the cycles that are averaged: two hold half orders, and eight all orders that a tracker averages."""
FEWEST_CYCLES = 2
"""Least number of cycles of a block: one estimate of the synchronous average."""
LEAD_CYCLES = 4
"""Cycles that the run-up is lengthened by at either end, so that its first and its last block are whole."""
NEWTON_STEPS = 3
"""Steps of Newton's method to the ends of cycles, from the straight line between dense points."""
REFERENCE = "angle 0 of the calculation"


def swept_orders(
    drivetrain: AssembledModel,
    outputs: Sequence[str | Sensor],
    tracked: TrackedOrders,
    excitations: Iterable[str] | None = None,
) -> tuple[TrackedOrders, ...]:
    """Complex orders (SI) of outputs along the measured speed over time, at the times of the test.

    The response along the speed is averaged over whole cycles of the reference shaft, at each time over as many as lie
    between the middles to its neighbours, two or more: as a synchronous average of the test does.

    Parameters
    ----------
    drivetrain : Drivetrain
        In the configuration that was tested.
    outputs : sequence of str or Sensor
    tracked : TrackedOrders
        Of the test, which gives times, speeds and orders.
    excitations : iterable of str, optional
        Those that act; by default all.

    Raises
    ------
    UsageError
        Fewer than three times, or a passage that takes too many steps.
    """
    if len(tracked.times) < 3:
        raise UsageError("a run-up has three or more speeds over time", kind="wrong-count")
    cycle = _cycle(tracked.orders)
    edges = _edges(tracked.times)
    run = passage_response(drivetrain, list(outputs), *_profile(tracked, edges, cycle), excitation=excitations)
    return _tracked(run, tracked, edges, cycle)


def _cycle(orders: FloatArray) -> int:
    """Revolutions after which all orders repeat."""
    for cycle in range(SHORTEST_CYCLE, LONGEST_CYCLE + 1):
        if np.abs(orders * cycle - np.rint(orders * cycle)).max() < 1e-6:
            return cycle
    raise UsageError(
        phrase("the orders have no common cycle of {count} revolutions or fewer", count=LONGEST_CYCLE),
        kind="no-period",
    )


def _edges(times: FloatArray) -> FloatArray:
    """Ends of the blocks around the times, s, shape (n + 1,)."""
    middles = (times[1:] + times[:-1]) / 2
    # The first and the last block reach as far outside as inside.
    return np.concatenate([[2 * times[0] - middles[0]], middles, [2 * times[-1] - middles[-1]]])


def _profile(tracked: TrackedOrders, edges: FloatArray, cycle: int) -> tuple[FloatArray, FloatArray]:
    """Times in s and speeds in rad/s of the run-up, with a lead at either end at the slope of the speed there."""
    step = max(1, math.ceil(len(tracked.times) / (MOST_SPEED_POINTS - 2)))
    kept = np.unique(np.r_[np.arange(0, len(tracked.times), step), len(tracked.times) - 1])
    times, speeds = tracked.times[kept], tracked.speeds[kept]
    # So many cycles of 2 pi cycle rad last at the speed of that end.
    lead = [LEAD_CYCLES * 2 * math.pi * cycle / speed for speed in (speeds[0], speeds[-1])]
    begin, end = min(edges[0], times[0] - lead[0]), max(edges[-1], times[-1] + lead[1])
    slopes = [(speeds[1] - speeds[0]) / (times[1] - times[0]), (speeds[-1] - speeds[-2]) / (times[-1] - times[-2])]
    # A steep run-up would lead through standstill: no lead goes below half the speed of its end.
    first = max(speeds[0] + slopes[0] * (begin - times[0]), speeds[0] / 2)
    last = max(speeds[-1] + slopes[1] * (end - times[-1]), speeds[-1] / 2)
    return np.concatenate([[begin], times, [end]]), np.concatenate([[first], speeds, [last]])


def _tracked(run: PassageResponse, test: TrackedOrders, edges: FloatArray, cycle: int) -> tuple[TrackedOrders, ...]:
    from scipy.interpolate import CubicSpline

    turn = 2 * math.pi * cycle
    angle, signals = CubicSpline(run.times, run.angles), CubicSpline(run.times, run.values)
    # Twice the number of steps that the passage has in an average cycle.
    samples = 2 * math.ceil(len(run.times) * turn / (run.angles[-1] - run.angles[0]))
    values = np.empty((len(run.outputs), len(test.orders), len(test.times)), dtype=np.complex128)
    half = np.empty((len(run.outputs), len(test.times)))
    for place, (low, high) in enumerate(pairwise(edges.tolist())):
        count = max(FEWEST_CYCLES, round(float(angle(high) - angle(low)) / turn))
        middle = float(angle((low + high) / 2))
        marks = middle + turn * (np.arange(count + 1) - count / 2)
        # Ends of cycles: phi(t) = mark, by Newton with phi' = Omega(t), from straight lines between steps.
        ends: FloatArray = np.interp(marks, run.angles, run.times)
        for _ in range(NEWTON_STEPS):
            ends = ends - (angle(ends) - marks) / angle(ends, 1)
        block = averaged_blocks(
            lambda at: np.asarray(signals(at).T),
            MeanRotation(cycle, ends, np.asarray(marks, dtype=np.float64), run.reference, (), (angle,)),
            test.orders,
            np.array([0, count], dtype=np.intp),
            lambda _: samples,
            lambda _: np.ones(len(test.orders)),
            0.0,
        )
        response = next(iter(block))
        values[:, :, place], half[:, place] = response.values, response.half_range
    quantities = {unit: quantity for quantity, unit in QUANTITY_UNITS.items()}
    nothing = np.full((len(test.orders), len(test.times)), math.nan)
    return tuple(
        TrackedOrders(
            channel.name, quantities.get(channel.unit, test.quantity), test.orders, test.times, test.speeds,
            values[number], nothing, half[number], REFERENCE, run.title, run.notes,
        )
        for number, channel in enumerate(run.outputs)
    )  # fmt: skip


# Orders of a model beside those of a run-up, along its speed over time where it is too fast for steady peaks.


@dataclass(frozen=True, eq=False)
class SweptComparison:
    """Orders of a model along the measured speed over time, with remarks on peaks that the run-up did not reach.

    Attributes
    ----------
    orders : mapping of str to tuple of MeasuredOrder
        By output, SI; empty where the steady response is compared.
    remarks : tuple of str
        Loss of each peak passed too fast, and why the steady response is compared nevertheless.
    """

    orders: Mapping[str, tuple[MeasuredOrder, ...]] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()


def swept_comparison(
    drivetrain: AssembledModel,
    run: OrderResponse,
    outputs: Sequence[str | Sensor],
    tracked: TrackedOrders,
    excitations: Iterable[str] | None = None,
) -> SweptComparison:
    """Orders (SI) to compare with a run-up, empty where no peak loses anything or the model has no single phase.

    Parameters
    ----------
    drivetrain : Drivetrain
        In the configuration that was tested.
    run : OrderResponse
        Of its steady speeds, with these outputs.
    outputs : sequence of str or Sensor
    tracked : TrackedOrders
        Of the test, which gives times, speeds and orders.
    excitations : iterable of str, optional
        Those that act; by default all.
    """
    remarks = sweep_remarks(tracked.times, tracked.speeds, tracked.orders.tolist(), modes(drivetrain))
    if not remarks or largest_amplitudes(run, range(len(run.lines)), 0) is not None:
        return SweptComparison(remarks=remarks)
    try:
        swept = swept_orders(drivetrain, outputs, tracked, excitations)
    except UsageError as error:
        return SweptComparison(remarks=(*remarks, phrase("compared with steady peaks: {reason}", reason=error)))
    by_output = {channel.name: orders.measured() for channel, orders in zip(run.outputs, swept, strict=True)}
    return SweptComparison(by_output, remarks)
