"""Signals as trackers of orders read them: channels of a record, vibration of wheels, twist between two wheels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import NoteOrText
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.signals.orders.mean_rotation import MeanRotation, PhaseReference
from torsionnet.signals.orders.record_window import RecordWindow
from torsionnet.signals.orders.tracked_orders import TrackedOrders, TrackingKernel
from torsionnet.signals.recording import FloatArray, Signal
from torsionnet.signals.rotation.wheel_rotation import WHOLE_ORDER, WheelRotation

SAMPLES_PER_TOOTH = 4
"""Samples in a pitch of a wheel, so that the highest order it holds has eight in a period."""
VIBRATION_POINTS = 257
"""Points of two cycles at which the vibration of a wheel is read that moves its teeth to other angles."""
NORMAL_HALF_WIDTH = 1.96
"""Half width of a 95 % interval in standard deviations."""
IMAGES = 3
"""Images on either side that the response of a cubic spline is summed from; the next ones add less than 1e-5."""


@dataclass(frozen=True, eq=False)
class Tracked:
    """Signals of one kind that are tracked together: those of the record, or one wheel.

    Attributes
    ----------
    signals : tuple of Signal
        Names and quantities; the values are not used.
    read : callable
        Values (n_signals, n) at times in s that only move on.
    begin, end : float
        First and last time, s.
    rate : callable
        Samples in a second by the mean speed in rad/s.
    per_cycle : callable
        Samples of a cycle by its duration in s.
    transmitted : callable
        Share of each order (n_orders,) that is kept between samples, by mean speed in rad/s.
    samples : callable
        Times and values of the samples between two times, (n,) and (n_signals, n).
    uncertain : callable
        Half width of what repeats in each order (n_orders,) at speeds in rad/s (n,), SI, (n_orders, n), besides that
        which the scatter from cycle to cycle shows in a single one.
    lost : callable
        Whether each signal dropped out between neighbours of the times (n + 1,) in s, (n_signals, n), where it can.
    remarks : callable
        Words on a signal by its name, when it was read.
    """

    signals: tuple[Signal, ...]
    read: Callable[[FloatArray], FloatArray]
    begin: float
    end: float
    rate: Callable[[float], float]
    per_cycle: Callable[[float], int]
    transmitted: Callable[[float], FloatArray]
    samples: Callable[[float, float], tuple[FloatArray, FloatArray]]
    uncertain: Callable[[FloatArray, FloatArray, FloatArray], FloatArray]
    notes: tuple[NoteOrText, ...] = ()
    lost: Callable[[FloatArray], NDArray[np.bool_]] | None = None
    remarks: Callable[[str], tuple[str, ...]] = lambda _: ()


def of_record(window: RecordWindow, orders: FloatArray) -> Tracked:
    """Signals of a record in SI, read between its samples by cubic splines whose response is known."""

    def read(times: FloatArray) -> FloatArray:
        from scipy.interpolate import CubicSpline

        at, values = _held(window, float(times[0]), float(times[-1]))
        return np.asarray(CubicSpline(at, values, axis=1)(times))

    def samples(begin: float, end: float) -> tuple[FloatArray, FloatArray]:
        at, values = _held(window, begin, end)
        inside = (at >= begin) & (at <= end)
        edges = np.append(at, at[-1:] + 1 / window.rate)
        inside &= ~window.lost(edges).any(axis=0)
        return at[inside], values[:, inside]

    window.reaches(window.start)
    return Tracked(
        window.signals,
        read,
        window.start,
        window.end,
        lambda _: window.rate,
        lambda duration: max(int(np.ceil(duration * window.rate)), 8),
        lambda speed: spline_response(orders * speed / (2 * np.pi * window.rate)),
        samples,
        lambda orders, speeds, _: np.zeros((len(orders), len(speeds))),
        lost=window.lost,
        remarks=window.remarks,
    )


def _held(window: RecordWindow, begin: float, end: float) -> tuple[FloatArray, FloatArray]:
    """Times in s and values (n_signals, n) of the samples between two times, up to which the record has to go."""
    samples = window.between(begin, end)
    if not window.reaches(end - 2 / window.rate):
        text = f"the channels end at {window.last:.6g} s, but the pulses go on"
        raise UsageError(f"{text}; leave out the pulses after that, as stop: of a campaign does", kind="too-short")
    return samples


def spline_response(share: FloatArray) -> FloatArray:
    """Amplitude that a cubic spline through samples keeps of a sine, by its frequency over the sampling rate."""
    images = sum((share / (share - k)) ** 4 for k in range(-IMAGES, IMAGES + 1) if k)
    return np.asarray(1 / (1 + np.asarray(images)))


@dataclass(frozen=True)
class Twist:
    """Twist between two wheels, referred to the reference shaft, or the torque that it means.

    Attributes
    ----------
    first, second : str
        Names of the wheels: twist is the angle of the first minus that of the second, each times its ratio and, of a
        wheel that turns against the sense of the model, times -1.
    stiffness : float
        Stiffness between them in N m/rad, referred to the reference shaft; 0 where the twist itself is wanted. Torque
        is stiffness times twist: damping between the wheels is left out.
    """

    first: str
    second: str
    stiffness: float = 0.0

    @property
    def signal(self) -> Signal:
        """Signal of the twist, with its name and quantity, without values."""
        name = f"{self.first}-{self.second}"
        if self.stiffness:
            return Signal(f"torque({name})", "torque", np.empty(0), (f"twist times {self.stiffness:.6g} N m/rad",))
        return Signal(f"twist({name})", "angle", np.empty(0))


def of_wheel(wheel: WheelRotation, mean: MeanRotation) -> Tracked:
    """Vibration of a wheel beyond the mean rotation in rad, in the angle of its own shaft in the model's sense."""
    return _of_wheels(((wheel, 1 / wheel.wheel.ratio),), mean, Signal(wheel.name, "angle", np.empty(0)))


def of_twist(first: WheelRotation, second: WheelRotation, twist: Twist, mean: MeanRotation) -> Tracked:
    """Twist between two wheels in rad, or its torque in N m, referred to the reference shaft."""
    scale = twist.stiffness or 1.0
    return _of_wheels(((first, scale * _sense(first)), (second, -scale * _sense(second))), mean, twist.signal)


def _sense(wheel: WheelRotation) -> float:
    """1 where the angle of a wheel rises with the mean rotation, -1 where it turns against the sense of the model."""
    return -1.0 if wheel.wheel.reversed != wheel.backwards else 1.0


def _of_wheels(parts: tuple[tuple[WheelRotation, float], ...], mean: MeanRotation, signal: Signal) -> Tracked:
    begin, end = max(wheel.times[0] for wheel, _ in parts), min(wheel.times[-1] for wheel, _ in parts)
    per_turn = max(wheel.wheel.teeth / abs(wheel.wheel.ratio) for wheel, _ in parts)
    # The mean rotation is taken out as often as it is in the weighted angles, in a twist of like senses not at all.
    rest = sum(weight * _sense(wheel) for wheel, weight in parts)

    def read(times: FloatArray) -> FloatArray:
        inside = np.clip(times, begin, end)
        angles = sum(weight * wheel.angle(inside) for wheel, weight in parts)
        return np.asarray(angles - rest * mean.angle(inside))[None]

    def samples(start: float, stop: float) -> tuple[FloatArray, FloatArray]:
        bounds = np.array([max(start, begin, mean.ends[0]), min(stop, end, mean.ends[-1])])
        first, last = mean.angle(bounds)
        # Half a pitch, so that there are two samples a tooth.
        step = np.pi / per_turn
        times = mean.times_at(step * np.arange(np.ceil(first / step), np.floor(last / step) + 1))
        return times, read(times)

    def uncertain(orders: FloatArray, speeds: FloatArray, seen: FloatArray) -> FloatArray:
        places, steps = np.zeros(len(orders)), np.zeros(len(speeds))
        for wheel, weight in parts:
            # Errors of places return in each turn; of independent times n pulses leave 2/n of the square.
            places += (weight * _of_pattern(wheel, orders, mean)) ** 2
            pulses = (wheel.wheel.teeth - wheel.wheel.missing_teeth) * mean.cycle / wheel.wheel.ratio
            steps += 2 / pulses * (NORMAL_HALF_WIDTH * weight * wheel.deviations.time * speeds) ** 2
        # What the times of a cycle's pulses leave in an order and its scatter does not show, every cycle repeats.
        return np.asarray(np.sqrt(places[:, None] + np.maximum(steps - seen**2, 0)))

    remarks = [f"{wheel.name}: {remark}" for wheel, _ in parts for remark in wheel.remarks]
    return Tracked(
        (signal,), read, float(begin), float(end), lambda speed: per_turn * speed / np.pi,
        lambda _: int(np.ceil(SAMPLES_PER_TOOTH * per_turn * mean.cycle)),
        lambda _: np.ones(1), samples, uncertain, (*signal.notes, *remarks),
    )  # fmt: skip


def _of_pattern(wheel: WheelRotation, orders: FloatArray, mean: MeanRotation) -> FloatArray:
    """Half width in rad that errors of a wheel's teeth leave in orders, in the reference shaft's angle.

    Places with independent errors of standard deviation sigma, known by a pattern's intervals or seen in the pulses,
    leave sigma sqrt(2/z) in real and in imaginary part of each whole order of the wheel. A vibration x moves the teeth
    to other angles, by p(theta + x) = p + x p': of the order b it takes what p has of the orders v +- b to v, and of
    all together sigma sqrt(2/z) times the RMS of (v x, x').
    """
    there = wheel.wheel.teeth - wheel.wheel.missing_teeth
    half = NORMAL_HALF_WIDTH * abs(wheel.wheel.ratio) * wheel.deviations.place * np.sqrt(2 / there)
    own = orders * wheel.wheel.ratio
    middle = mean.angles[len(mean.angles) // 2] + 2 * np.pi * mean.cycle * np.linspace(-1, 1, VIBRATION_POINTS)
    times = mean.times_at(np.clip(middle, mean.angles[0], mean.angles[-1]))
    times = times[(times >= wheel.times[0]) & (times <= wheel.times[-1])]
    if not half or len(times) < VIBRATION_POINTS // 2:
        return np.where(np.abs(own - np.rint(own)) < WHOLE_ORDER, half, 0.0)
    turned = mean.angle(times)
    line = np.polynomial.Polynomial.fit(turned, _sense(wheel) * wheel.angle(times) - turned, 1)
    vibration = _sense(wheel) * wheel.angle(times) - turned - line(turned)
    # The vibration moves the errors in phase and in speed, and so some of them into orders beside the whole ones.
    moved = np.hypot(own * vibration.std() / wheel.wheel.ratio, np.gradient(vibration, turned).std())
    return np.asarray(half * np.where(np.abs(own - np.rint(own)) < WHOLE_ORDER, 1.0, moved))


def tracked_values(
    signal: Signal, orders: FloatArray, times: FloatArray, speeds: FloatArray, values: ComplexArray,
    widths: FloatArray, half_range: FloatArray | None, zero: PhaseReference, notes: tuple[NoteOrText, ...],
    tracking: TrackingKernel, related_within: tuple[float, ...] = (),
) -> TrackedOrders:  # fmt: skip
    """Orders of one signal in SI, those whose sign is not known as amplitudes without a phase."""
    # Where it is open which turn of the cycle is the first, half orders may have either sign.
    half = np.abs(orders - np.rint(orders)) > 1e-9
    undecided = half & (not zero.turn_known)
    values = np.where(undecided[:, None], np.abs(values), values)
    return TrackedOrders(
        signal.name, signal.quantity, orders, times, speeds, values, widths, half_range, zero.words,
        notes=(*notes, *zero.notes), undecided=tuple(orders[undecided].tolist()) if zero.words else (),
        related_within=related_within, tracking=tracking,
    )  # fmt: skip
