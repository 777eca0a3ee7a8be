"""Calibration of a toothed wheel: its pitch pattern from pulses at several speeds, or of two pickups."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import Note, warning
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.calibration_windows import (
    WINDOW_REVOLUTIONS,
    OrderSet,
    Stack,
    amplitudes,
    order_set,
    stacked,
    windows_of_test,
)
from torsionnet.signals.rotation.pitch_order import (
    ABOVE,
    NORMAL,
    SPEEDS,
    CalculatedOrders,
    PitchEvidence,
    PitchOrder,
    constant_part,
    repeating_error,
    speed_groups,
    student_quantile,
)
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.pulse_deviations import UNIFORM_STEPS, WheelCalibration
from torsionnet.signals.rotation.turn_pattern import best_shift
from torsionnet.signals.rotation.wheel import Wheel, WheelPattern
from torsionnet.signals.rotation.wheel_channel import ReversingRotation
from torsionnet.signals.rotation.wheel_rotation import WHOLE_ORDER, WheelRotation, wheel_rotation

WIDEST = np.radians(0.01)
"""Widest half width of an order's interval in rad that counts as resolved: vibration of that size has a phase still."""
CONVERGED, MOST_STEPS = 1e-9, 40
"""Change of a tooth's position in rad below which the pattern has converged, and steps in which it does: each leaves
about the vibration in rad times the order, a few hundredths."""
LOOSE_SHARE = 2e-4
"""Scatter of a tooth from window to window, in pitches, above which the number of teeth is doubted where neither gap
nor index confirms it: counter and pickup leave some 1e-5, errors of pitch counted over a wrong number 2e-4 and more."""
GRAIN = 1e-12
"""Unit in s of which the step of times is a whole multiple where it is sought, far below that of any counter."""
PASSES = 2
"""Solutions of the windows, the second with the pattern of the first in the mean rotation of each window."""


@dataclass(frozen=True, eq=False)
class WheelTest:
    """Pulses of one wheel in one record: of a pickup, of a second one if there is one, and of an index.

    Attributes
    ----------
    first : PulseChannel
    second : PulseChannel, optional
        Of a second pickup on the same wheel and the same clock, which each tooth passes after the first.
    index : PulseChannel, optional
        One pulse per turn, before tooth 0.
    load : str
        Name of the load: records of one load share the torques of the working gas at a speed.
    """

    first: PulseChannel
    second: PulseChannel | None = None
    index: PulseChannel | None = None
    load: str = ""


def calibrate_wheel(
    tests: Sequence[WheelTest],
    wheel: Wheel,
    *,
    pickup_angle: float | None = None,
    calculated: CalculatedOrders | None = None,
    cycle: int = 2,
    constant_orders: Sequence[float] | None = None,
    poles: Sequence[complex] = (),
    widest: float = float(WIDEST),
    name: str = "",
) -> WheelCalibration:
    """Pitch pattern of a wheel, order by order, with intervals, and with what stays ambiguous.

    Parameters
    ----------
    tests : sequence of WheelTest
        Steady speeds or run-ups.
    wheel : Wheel
    pickup_angle : float, optional
        From the first pickup to the second in the sense of rotation, rad, to better than half a pitch.
    calculated : CalculatedOrders, optional
        Calculated vibration of the wheel, by which orders are resolved to which two pickups are blind.
    cycle : int
        Revolutions of the reference shaft after which its vibration repeats: 2 of a four-stroke engine.
    constant_orders : sequence of float, optional
        With one pickup and no model: orders of the reference shaft in which a part of the vibration may be constant
        over speed, ``()`` if in none: the rigid response to inertia torques, the twist below a resonance under the
        torques of the working gas, the motion of a joint. Left out it is not known, and no whole order is resolved.
    poles : sequence of complex, optional
        With one pickup and no model: poles of the torsional vibration in rad/s, by which orders change over speed.
    widest : float, optional
        Widest half width of an order's interval that counts as resolved, rad.
    name : str, optional
        Wheel, with machine and date.

    Raises
    ------
    UsageError
        A range of speeds too small, pulses that do not fit, or a tooth 0 that differs from record to record.

    Examples
    --------
    >>> teeth = 12
    >>> positions = np.radians(0.1) * np.cos(2 * np.pi * np.arange(teeth) / teeth)
    >>> passed = np.arange(40 * teeth)
    >>> places = 2 * np.pi * passed / teeth + positions[passed % teeth]
    >>> pickups = [PulseChannel(n, (places + a) / 100) for n, a in (("A", 0.0), ("B", np.radians(90)))]
    >>> calibration = calibrate_wheel([WheelTest(*pickups)], Wheel(teeth=teeth), pickup_angle=np.radians(90))
    >>> float(np.degrees(calibration.orders[0].value.real).round(6)), calibration.pattern.unresolved
    (0.1, (4,))
    """
    if not tests:
        raise UsageError("a calibration needs a record at least", kind="missing-entry")
    paired = [test.second is not None for test in tests]
    if any(paired) and pickup_angle is None:
        raise UsageError("two pickups need the angle between them, to better than half a pitch", kind="missing-entry")
    if any(paired) and not all(paired):
        raise UsageError("give the second pickup in each record, or in none", kind="missing-entry")
    if wheel.stated:
        raise UsageError(
            "a calibration needs a wheel of even teeth with one gap at most; its pattern states others",
            kind="unfit-wheel",
        )
    orders = order_set(wheel, cycle)
    rotations = _aligned(tests, [_rotation(test, wheel) for test in tests], wheel, pickup_angle)
    between = (pickup_angle or 0.0) % (2 * np.pi)
    positions = np.zeros(wheel.teeth)
    for _ in range(PASSES):
        by_test = [
            windows_of_test(
                shaft.name, shaft.times, shaft.numbers, test.second, wheel, orders, between, positions, test.load
            )
            for test, shaft in zip(tests, rotations, strict=True)
        ]
        stack = stacked(by_test, wheel)
        groups = speed_groups(stack.speeds)
        offset = _offset(stack, groups, positions)
        steps = max(_time_deviation(rotation) for rotation in rotations)
        # Orders between whole ones are vibration: where they exceed the counter's steps its errors return with the
        # cycle, else with the turn.
        broken = np.abs(orders.orders - np.rint(orders.orders)) > WHOLE_ORDER
        swing = np.abs(amplitudes(stack.first, positions, len(orders.orders))[:, broken]).max(initial=0.0)
        turns = cycle / wheel.ratio if swing > steps * stack.speeds.max() / wheel.ratio else 1.0
        evidence = PitchEvidence(
            wheel=wheel,
            speeds=stack.speeds,
            groups=groups,
            loads=stack.loads,
            angle=None if not any(paired) else between - offset[0],
            calculated=calculated,
            constant_orders=None if constant_orders is None else tuple(constant_orders),
            poles=np.asarray(poles, dtype=complex),
            widest=widest,
            time=steps,
            periods=orders.revolutions / turns,
            turns=turns,
        )
        positions, rows = _converged(stack, orders, evidence)
    _refuse_small_range(rows, stack)
    _refuse_single_window(rows, stack, orders.revolutions, widest)
    known = all(_knows_zero(test, wheel) for test in tests)
    return _result(stack, orders, evidence, positions, rows, offset[1], name, rotations, known)


def speed_range(tests: Sequence[WheelTest], wheel: Wheel) -> tuple[float, float]:
    """Lowest and highest speed of the reference shaft in the tests, rad/s, over a window of revolutions each."""
    speeds = []
    for test in tests:
        pulses = _rotation(test, wheel)
        length = WINDOW_REVOLUTIONS * wheel.teeth
        ends = np.searchsorted(
            pulses.numbers, pulses.numbers[0] + length * np.arange(1 + np.ptp(pulses.numbers) // length)
        )
        # A record shorter than a window is one window.
        ends = np.append(ends, len(pulses.numbers) - 1) if len(ends) < 2 else ends
        speeds.append(
            2 * np.pi / wheel.teeth * wheel.ratio * np.diff(pulses.numbers[ends]) / np.diff(pulses.times[ends])
        )
    every = np.concatenate(speeds)
    return float(every.min()), float(every.max())


def _rotation(test: WheelTest, wheel: Wheel) -> WheelRotation:
    """Rotation by the first pickup, whose pulses have their teeth."""
    rotation = wheel_rotation(test.first, wheel, index=test.index)
    if rotation.backwards or isinstance(rotation.rotation, ReversingRotation):
        raise UsageError(
            f"{rotation.name}: by its second track the wheel turns back{'wards' * rotation.backwards}; a calibration "
            "needs records in one sense: cut the record, exchange the tracks, or give the ratio a minus sign",
            kind="turning-back",
        )
    return rotation


def _time_deviation(pulses: WheelRotation) -> float:
    """Standard deviation in s that the step of a counter leaves in times, by themselves where it is not said."""
    steps = np.rint(np.diff(pulses.times) / GRAIN).astype(np.int64)
    return float(pulses.deviations.tick or GRAIN * np.gcd.reduce(steps)) / UNIFORM_STEPS


def _knows_zero(test: WheelTest, wheel: Wheel) -> bool:
    """Whether another record of the wheel has the same tooth 0."""
    return bool(wheel.missing_teeth) or test.index is not None


def _aligned(
    tests: Sequence[WheelTest], rotations: list[WheelRotation], wheel: Wheel, angle: float | None
) -> list[WheelRotation]:
    """Rotations of all tests with the same tooth 0, by the pattern itself where nothing else tells it."""
    if len(tests) < 2 or all(_knows_zero(test, wheel) for test in tests):
        return rotations
    if angle is None or tests[0].second is None:
        raise UsageError(
            f"in {len(tests)} records the first tooth is another one each time, and one pickup cannot find it: record "
            "an index pulse once per turn, or calibrate from a run-up in one record, or with a second pickup",
            kind="ambiguous-tooth",
        )
    alone = [
        calibrate_wheel([test], wheel, pickup_angle=angle, widest=np.inf).pattern.positions for test in tests
    ]  # fmt: skip
    done = [rotations[0]]
    for rotation, positions in zip(rotations[1:], alone[1:], strict=True):
        shift = best_shift(rotation.name, alone[0], positions)
        remark = f"tooth {shift} of the first record comes first, by the shape of the pattern"
        done.append(replace(rotation, numbers=rotation.numbers + shift, remarks=(*rotation.remarks, remark)))
    return done


def _offset(stack: Stack, groups: NDArray[np.intp], positions: FloatArray) -> tuple[float, float]:
    """Excess of the given angle between two pickups over the true one, and half its 95 % interval, rad."""
    second = stack.second
    if not second:
        return 0.0, 0.0
    values = np.array([window.terms(positions)[0] for window in second])
    constant = constant_part(values.astype(complex), np.empty((len(values), 0), dtype=complex), groups)
    return constant.value.real, constant.half_width * np.sqrt(2)


def _converged(stack: Stack, orders: OrderSet, evidence: PitchEvidence) -> tuple[FloatArray, list[PitchOrder]]:
    """Positions of the teeth in rad of all that is resolved, and the orders of the pattern."""
    teeth, count = evidence.wheel.teeth, len(orders.orders)
    tooth = 2 * np.pi * np.arange(teeth) / teeth
    positions = np.zeros(teeth)
    known = dict.fromkeys(orders.whole, 0j)
    for _ in range(MOST_STEPS):
        # Amplitudes with the pattern known so far taken out: what shows of the pattern still is added to it.
        first = amplitudes(stack.first, positions, count)
        second = amplitudes(stack.second, positions, count) if stack.second else None
        rows = [_pattern_order(order, orders, evidence, first, second, known) for order in orders.whole]
        change = sum(
            ((row.value - known[row.order]) * np.exp(1j * row.order * tooth)).real for row in rows if row.resolved
        ) - _unseen_positions(stack, positions, orders, evidence.wheel)
        known = {row.order: row.value if row.resolved else 0j for row in rows}
        positions = positions + change
        if np.abs(change).max() < CONVERGED:
            break
    return positions, rows


def _pattern_order(
    order: int,
    orders: OrderSet,
    evidence: PitchEvidence,
    first: ComplexArray,
    second: ComplexArray | None,
    known: dict[int, complex],
) -> PitchOrder:
    """Order of the pattern, with what of it is in the positions already."""
    place = orders.place(order)
    others = None if second is None else second[:, place]
    judged = evidence.of(order, order in orders.shared, first[:, place], others)
    return replace(judged, value=judged.value + known[order])


def _unseen_positions(stack: Stack, positions: FloatArray, orders: OrderSet, wheel: Wheel) -> FloatArray:
    """Positions in rad that are missing yet of orders above those of vibration, shape (teeth,), with minus sign."""
    left = _over_windows(stack, positions)[0]
    # With a gap the teeth have no even spectrum: all that is left counts.
    if wheel.missing_teeth:
        return np.asarray(left)
    # Orders in which vibration is sought are left to the solution order by order.
    lines = np.fft.rfft(left)
    lines[: orders.whole[-1] + 1] = 0
    return np.fft.irfft(lines, wheel.teeth)


def _over_windows(stack: Stack, positions: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mean in rad of what is left at each tooth, half its 95 % interval, and variance in rad^2 of a window, (teeth,).

    Teeth of which no pulse comes have 0.
    """
    left = np.array([shown.left(positions) for shown in stack.first])
    there = np.isfinite(left)
    count = there.sum(axis=0)
    mean = np.where(there, left, 0.0).sum(axis=0) / np.maximum(count, 1)
    squares = (np.where(there, left - mean, 0.0) ** 2).sum(axis=0)
    freedom = np.maximum(count - 1, 1)
    variance = squares / freedom
    return mean, student_quantile(freedom) * np.sqrt(variance / np.maximum(count, 1)), variance


def _loose(stack: Stack, positions: FloatArray, wheel: Wheel) -> list[Note]:
    """Warning where the teeth do not return to their places from window to window; a list of one text, or empty."""
    left = np.array([shown.left(positions) for shown in stack.first])
    if len(left) < 2:
        return []
    # Standard deviation of a tooth's place from window to window, over the pitch 2 pi/z.
    share = float(np.sqrt(np.nanmean(np.nanvar(left, axis=0, ddof=1)))) * wheel.teeth / (2 * np.pi)
    if share <= LOOSE_SHARE:
        return []
    return [
        warning(
            f"the teeth scatter by {100 * share:.2g} % of a pitch from window to window: the pulses jitter, or "
            f"the wheel has another number than {wheel.teeth} teeth; count them, or record an index pulse, which "
            "confirms the number"
        )
    ]


def _refuse_small_range(rows: Sequence[PitchOrder], stack: Stack) -> None:
    """Refuse a test of which no order could be resolved for want of speeds."""
    by_speed = [row for row in rows if row.by == SPEEDS]
    if by_speed and len(by_speed) == len(rows) and all(not np.isfinite(row.half_width) for row in by_speed):
        raise UsageError(
            f"the range of speeds, {stack.range_text}, is too small for a calibration with one pickup: at one speed "
            "the pattern cannot be told from vibration of whole orders; record several speeds or a run-up, add a "
            "second pickup on the wheel (at 114 degrees it sees orders 1 to 12), or give calculated orders of a model",
            kind="unfit-order",
        )


def _refuse_single_window(rows: Sequence[PitchOrder], stack: Stack, revolutions: int, widest: float) -> None:
    """Refuse a test of one window, in which no order has a scatter: only what is above them would be the pattern."""
    if len(stack.first) == 1 and all(row.half_width > widest for row in rows):
        raise UsageError(
            f"one window of {revolutions} revolutions tells no order of the pattern, as its scatter is known from two "
            f"on; record {2 * revolutions + 1} revolutions or more, or several records",
            kind="too-short",
        )


def _result(
    stack: Stack,
    orders: OrderSet,
    evidence: PitchEvidence,
    positions: FloatArray,
    rows: list[PitchOrder],
    angle_half_width: float,
    name: str,
    rotations: Sequence[WheelRotation],
    known: bool,
) -> WheelCalibration:
    wheel, teeth, first = evidence.wheel, evidence.wheel.teeth, rotations[0]
    present = np.arange(teeth) < teeth - wheel.missing_teeth
    centred = np.where(present, positions - positions[present].mean(), 0.0)
    _, scatter, variance = _over_windows(stack, positions)
    # Steps of a counter may repeat with each turn at a steady speed: the scatter between windows does not show those.
    once = np.full(teeth, evidence.time**2 * np.mean((stack.speeds / wheel.ratio) ** 2) / evidence.turns)
    common = repeating_error(once, evidence.periods * float(np.mean(variance[present])))
    scatter = np.hypot(scatter, student_quantile(NORMAL) * common / np.sqrt(1 + evidence.groups.max()))
    # Squares add: the scatter of a tooth, the intervals of the orders, and orders not resolved with all they have.
    of_orders = sum(row.half_width**2 for row in rows if row.resolved)
    not_known = sum(abs(row.value) ** 2 for row in rows if not row.resolved)
    widths = np.where(present, np.sqrt(scatter**2 + of_orders + not_known), 0.0)
    above = list(range(orders.whole[-1] + 1, teeth // 2 + 1))
    # A Fourier line of n teeth with independent errors s has real and imaginary part of sqrt(2/n) s.
    width = float(np.sqrt(np.mean(scatter[present] ** 2) * 2 / teeth))
    pattern = WheelPattern(
        centred,
        widths,
        wheel.missing_teeth,
        name,
        first.zero if known else f"{first.zero} of {first.name}: valid within that record only",
        tuple(row.order for row in rows if not row.resolved),
        (),
        wheel.reversed,
    )
    rows += [PitchOrder(order, 0 - pattern.order(order), width, True, ABOVE) for order in above]
    remarks = [
        text
        for rotation, test in zip(rotations, stack.tests, strict=True)
        for text in (*(f"{rotation.name}: {remark}" for remark in rotation.remarks), *test.remarks)
    ]
    if not known:
        remarks += _loose(stack, positions, wheel)
    return WheelCalibration(
        pattern=pattern,
        orders=tuple(rows),
        speeds=(float(stack.speeds.min()), float(stack.speeds.max())),
        windows=len(stack.speeds),
        revolutions=orders.revolutions,
        angle=evidence.angle,
        angle_half_width=None if evidence.angle is None else angle_half_width,
        source="" if evidence.calculated is None else evidence.calculated.source,
        known=known,
        remarks=tuple(dict.fromkeys(remarks)),
    )
