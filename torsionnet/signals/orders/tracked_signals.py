"""Signals as trackers of orders read them: channels of a long record in blocks, wheels, twist between wheels."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import NoteOrText
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.signals.orders.mean_rotation import MeanRotation, PhaseReference
from torsionnet.signals.orders.tracked_orders import TrackedOrders, TrackingKernel
from torsionnet.signals.recording import FloatArray, Recording, Signal
from torsionnet.signals.resampling import Recordings, blocks_in_order, check_processable
from torsionnet.signals.rotation.wheel_rotation import WHOLE_ORDER, WheelRotation
from torsionnet.signals.value_faults import (
    FEWEST_SAMPLES,
    LEAP_STEPS,
    LEAST_LENGTH_RATIO,
    RUNS_AROUND,
    SKIPPED_RUNS,
    Stretches,
    is_rough,
    jumps_away,
)

# Signals of a long record between two times, which move on: blocks are read as they are needed and then dropped.

# Drop-outs of telemetry in a signal that vibrates: stretches in which the receiver holds a value, or shows 0.

FLAT_SHARE = 1e-6
"""Change from sample to sample, over the range of the signal, below which a value counts as held: one that was shifted
in time by a spline still rings a little."""
RINGING_SAMPLES = 12
"""Samples on either side of held values that count as lost, too: a spline rings there, by 0.27 of it a sample."""
MOST_LOST = 0.2
"""Share of a record in such stretches above which they belong to the signal, as those of a switch do."""
ROUNDING_TURNS = 2.0
"""Mean second difference of noise, in steps of the converter, above which it would not stay on one step: that of mere
rounding is 0.6, that of noise with the deviation of a step 2."""
EDGE_SAMPLES, EDGE_SHARE = 3, 0.05
"""Distance from a stretch of zeros at which the signal counts as beside it, and its size there over the signal's range
below which it came to 0 by itself, as where it is clipped there."""


def drop_outs(values: FloatArray) -> Stretches:
    """First and last sample index of each stretch in which a signal is lost: held, or exactly 0, among moving values.

    A stretch is held where noise stops, or where the signal goes on with a jump. A converter with coarse steps that
    shows less motion than a step holds nothing. Stretches at the ends of the record do not count, nor values other
    than 0 that are held again and again, as those of a clipped signal.

    Examples
    --------
    >>> values = 3 + np.sin(np.arange(4000) / 20)
    >>> values[700:900], values[2000:2100] = values[700], 0
    >>> drop_outs(values)
    [(700, 899), (2000, 2099)]
    """
    if len(values) < FEWEST_SAMPLES:
        return []
    span = float(np.ptp(values))
    tolerance = FLAT_SHARE * span
    changes = np.abs(np.diff(values))
    moved = changes > tolerance
    firsts = np.concatenate([[0], np.flatnonzero(moved) + 1])
    lengths = np.diff(np.concatenate([firsts, [len(values)]]))
    step = float(changes[moved].min()) if moved.any() else 0.0
    stretches = []
    for run in np.flatnonzero(lengths >= FEWEST_SAMPLES).tolist():
        if not 0 < run < len(lengths) - 1:
            continue
        before, after = slice(max(0, run - RUNS_AROUND), run), slice(run + 1, run + 1 + RUNS_AROUND)
        # A held value lasts longer than what is usual around it; the longest of those may be drop-outs themselves.
        others = np.sort(np.concatenate([lengths[before], lengths[after]]))
        longer = lengths[run] / others[max(0, len(others) - 1 - SKIPPED_RUNS)]
        if longer <= 1:
            continue
        first, last = int(firsts[run]), int(firsts[run + 1]) - 1
        sides = values[firsts[before.start] : first], values[last + 1 : int(firsts[after][-1]) + 1]
        if (longer > LEAST_LENGTH_RATIO and _stops(sides, step)) or _jumps(
            sides, float(values[(first + last) // 2]), step
        ):
            stretches.append((first, last))
    return _without_limits(values, stretches, span)


def _stops(sides: tuple[FloatArray, FloatArray], step: float) -> bool:
    """Whether both sides hold noise that would be seen in steps of the converter."""
    turns = [np.abs(np.diff(side, 2)) for side in sides if len(side) > 2]
    return bool(turns) and float(np.concatenate(turns).mean()) > ROUNDING_TURNS * step and is_rough(sides)


def _jumps(sides: tuple[FloatArray, FloatArray], level: float, step: float) -> bool:
    """Whether the signal goes on elsewhere, by a jump that neither its course nor the converter makes."""
    jump = float(sides[1][0]) - level
    return abs(jump) > LEAP_STEPS * step and jumps_away(sides, jump)


def _without_limits(values: FloatArray, stretches: Stretches, span: float) -> Stretches:
    """Stretches without those at levels to which the signal comes by itself, as to its limits."""
    levels = np.array([values[(first + last) // 2] for first, last in stretches])
    tolerance = FLAT_SHARE * span
    sorted_levels = np.sort(levels)
    # A level that returns is one to which the signal comes by itself, as a stop or the range of an amplifier.
    alike = np.searchsorted(sorted_levels, levels + tolerance, "right") - np.searchsorted(
        sorted_levels, levels - tolerance
    )
    zero = np.abs(levels) <= tolerance
    ends = [(max(first - EDGE_SAMPLES, 0), min(last + EDGE_SAMPLES, len(values) - 1)) for first, last in stretches]
    beside = np.array([np.abs(values[list(both)]).min() for both in ends])
    kept = (alike == 1) | (zero & (np.median(beside[zero]) > EDGE_SHARE * span if zero.any() else False))
    lost = [stretch for stretch, keep in zip(stretches, kept.tolist(), strict=True) if keep]
    return lost if sum(last - first + 1 for first, last in lost) <= MOST_LOST * len(values) else []


MARGIN_SAMPLES = 24
"""Samples kept on either side of a window, so that a spline through it is as good at its ends: the influence of an end
falls by 0.27 a sample."""
SEARCH_OVERLAP = 4096
"""Samples before a block, and beyond a window, in which drop-outs are searched for, so that one at a seam of blocks is
found; one that is longer may be missed there, not in a record that is read whole."""


class RecordWindow:
    """Signals of a record or of its blocks between two times that only move on.

    Parameters
    ----------
    recordings : Recording or iterable of Recording
        Blocks of one test, one after the other.
    names : sequence of str
        Signals wanted.
    """

    def __init__(self, recordings: Recordings, names: Sequence[str]) -> None:
        whole = [recordings] if isinstance(recordings, Recording) else recordings
        self._blocks: Iterator[tuple[Recording, bool]] = blocks_in_order(_selected(whole, names))
        first, _ = next(self._blocks, (None, False))
        if first is None:
            raise UsageError("the record is empty", kind="too-short")
        self.signals: tuple[Signal, ...] = tuple(replace(signal, values=np.empty(0)) for signal in first)
        self.rate, self._start, self._values = first.sampling_rate, first.start, _stack(first)
        self.title = first.title
        self.end = first.start + first.duration if isinstance(recordings, Recording) else np.inf
        """Time at which the record ends, s; inf of blocks, whose end shows only when they are read."""
        self._lost: list[list[tuple[float, float]]] = [[] for _ in first.signals]
        self._search(self._values, first.start)

    @property
    def start(self) -> float:
        """Time of the first sample still held, s."""
        return self._start

    def reaches(self, time: float) -> bool:
        """Whether the record goes on to a time in s; blocks are read until it does."""
        while self.last < time:
            self._values = self._values.copy()  # frees what was dropped before the next block is read
            block, continued = next(self._blocks, (None, False))
            if block is None:
                return False
            if not continued:
                raise UsageError(
                    "the blocks do not follow one another: track each record by itself", kind="unlike-results"
                )
            fresh = _stack(block)
            tail = np.concatenate([self._tail, fresh], axis=1)
            self._search(tail, self.last + (1 - self._tail.shape[1]) / self.rate)
            self._values = np.concatenate([self._values, fresh], axis=1)
        return True

    def _search(self, values: FloatArray, start: float) -> None:
        """Note the drop-outs of each signal among values (n_signals, n) that begin at a time in s."""
        for spans, line in zip(self._lost, values, strict=True):
            for first, last in drop_outs(line):
                span = (start + first / self.rate, start + last / self.rate)
                if spans and span[0] <= spans[-1][1] + 1 / self.rate:
                    span = (min(spans[-1][0], span[0]), max(spans.pop()[1], span[1]))
                spans.append(span)
        self._tail = values[:, -SEARCH_OVERLAP:].copy()

    def lost(self, bounds: FloatArray) -> NDArray[np.bool_]:
        """Whether each signal dropped out between neighbours of the times (n + 1,) in s, shape (n_signals, n)."""
        ringing = RINGING_SAMPLES / self.rate
        lost = np.zeros((len(self._lost), len(bounds) - 1), dtype=bool)
        for place, spans in enumerate(self._lost):
            for first, last in spans:
                lost[place] |= (bounds[:-1] < last + ringing) & (bounds[1:] > first - ringing)
        return lost

    def remarks(self, name: str) -> tuple[str, ...]:
        """Words on the drop-outs of a signal that were found so far."""
        spans = self._lost[[signal.name for signal in self.signals].index(name)]
        if not spans:
            return ()
        whole = sum(last - first + 1 / self.rate for first, last in spans)
        many = f"{len(spans)} drop-outs" if len(spans) > 1 else "1 drop-out"
        where = "the first " if len(spans) > 1 else ""
        return (
            f"{many} of {whole:.4g} s in all, {where}at {spans[0][0]:.6g} s, where the value is held or 0: left out",
        )

    def between(self, begin: float, end: float) -> tuple[FloatArray, FloatArray]:
        """Times in s and values (n_signals, n) of the samples from ``begin`` to ``end``, with a margin on both sides.

        What comes before the margin is dropped, so that ``begin`` must not fall from call to call.
        """
        self.reaches(end + SEARCH_OVERLAP / self.rate)
        drop = max(int(np.floor((begin - self._start) * self.rate)) - MARGIN_SAMPLES, 0)
        self._values = self._values[:, drop:]
        self._start += drop / self.rate
        count = min(int(np.ceil((end - self._start) * self.rate)) + MARGIN_SAMPLES + 1, self._values.shape[1])
        return self._start + np.arange(count) / self.rate, self._values[:, :count]

    @property
    def last(self) -> float:
        """Time of the last sample held, s."""
        return float(self._start + (self._values.shape[1] - 1) / self.rate)


def _selected(recordings: Iterable[Recording], names: Sequence[str]) -> Iterator[Recording]:
    for block in recordings:
        chosen = block.select(names)
        check_processable(chosen)
        yield chosen


def _stack(block: Recording) -> FloatArray:
    return np.array([signal.values for signal in block], dtype=np.float64)


# Signals as trackers of orders read them: channels of a record, vibration of wheels, twist between two wheels.

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
