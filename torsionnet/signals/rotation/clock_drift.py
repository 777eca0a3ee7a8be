"""Drift and offset between the clocks of two measuring systems, and records brought from one clock to the other.

A time t of the first clock is offset + (1 + drift) t on the second. At 1500 rpm, 50 ppm are 162 degrees of order 6
after 60 s, and 0.1 ms are 5.4 degrees.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.base.result_rows import Out
from torsionnet.signals.recording import FloatArray, Recording
from torsionnet.signals.resampling import interpolated_at
from torsionnet.signals.rotation.wheel_rotation import WheelRotation

HALF_WIDTH_DEVIATIONS = 1.96
"""Half width of the 95 % interval of a normal variable over its standard deviation."""
COMMON = (
    "record one rotation or one signal on both systems, best a pulse per turn, and start them together or change the "
    "speed during the record"
)
"""Advice on what makes the clocks of two systems comparable."""
MOST_DRIFT = 2e-3
"""Largest drift between two clocks that is looked for; quartz clocks differ by 1e-4 or less."""
MOVED = "on the clock of the first system"
"""Note on what was brought from the clock of a second system to that of the first."""


@dataclass(frozen=True)
class ClockDrift:
    """Drift of a second clock against a first, and its offset in s, with half widths of their 95 % intervals.

    Attributes
    ----------
    drift : float
        Seconds that the second clock gains per second of the first; 50e-6 are 50 ppm.
    drift_half_width : float
    offset : float
        Time in s of the second clock at time 0 of the first.
    offset_half_width : float
        s; infinite where nothing tells the offset.
    period : float
        Time in s by whole multiples of which the offset is open: that of a turn at steady speed, or of a periodic
        signal; 0 where it is not.
    remarks : tuple of str
        How they were found, and what stays open.
    found_from : str
        Channel of what both systems recorded.
    """

    SHOWN: ClassVar = (
        "found_from", "drift", "drift_half_width", "offset", "known_half_width", "period", "remarks"
    )  # fmt: skip

    drift: Annotated[float, Out("drift", "ppm", json="drift", digits=5, factor=1e6)]
    drift_half_width: Annotated[float, Out("drift +-", "ppm", json="drift_half_width", digits=2, factor=1e6)]
    offset: Annotated[float, Out("offset", "s", json="offset_s", digits=8)]
    offset_half_width: float
    period: Annotated[float, Out("open by multiples of", "s", json="period_s", digits=5)] = 0.0
    remarks: tuple[NoteOrText, ...] = ()
    found_from: Annotated[str, Out("found from", json="of")] = ""

    @property
    def known_half_width(self) -> Annotated[float | None, Out("offset +-", "s", "offset_half_width_s", digits=2)]:
        """Half width of the 95 % interval of the offset in s, None where nothing tells the offset."""
        return self.offset_half_width if np.isfinite(self.offset_half_width) else None

    def to_first(self, times: FloatArray) -> FloatArray:
        """Times in s on the first clock of times in s on the second, shape (n,)."""
        return np.asarray((np.asarray(times, dtype=float) - self.offset) / (1 + self.drift))

    def to_second(self, times: FloatArray) -> FloatArray:
        """Times in s on the second clock of times in s on the first, shape (n,)."""
        return np.asarray(self.offset + (1 + self.drift) * np.asarray(times, dtype=float))


def variance_factor(left: FloatArray) -> float:
    """Factor on the variance of means of errors that follow each other alike, by their correlation to the next."""
    power = float(np.sum(left**2))
    share = float(np.sum(left[1:] * left[:-1])) / power if power else 0.0
    share = min(max(share, 0.0), 0.95)
    return (1 + share) / (1 - share)


def on_first_clock(recording: Recording, clocks: ClockDrift, like: Recording | None = None) -> Recording:
    """Recording of the second system with its times in s on the clock of the first, and a note that counts them.

    With ``like``, a record of the first system, its signals are interpolated, band-limited, at the samples of that
    one as far as they reach; else they keep their samples, whose rate is then that on the first clock.

    Examples
    --------
    >>> from torsionnet.signals.recording import Signal
    >>> record = Recording((Signal("T", "torque", np.zeros(10)),), sampling_rate=1000.0, start=0.5)
    >>> moved = on_first_clock(record, ClockDrift(50e-6, 0.0, 0.5, 0.0))
    >>> round(moved.sampling_rate, 6), moved.start
    (1000.05, 0.0)
    """
    times = None if recording.times is None else clocks.to_first(recording.times)
    start = float(clocks.to_first(np.array([recording.start]))[0])
    pulses = tuple(
        replace(
            channel, times=clocks.to_first(channel.times), notes=(*channel.notes, "on the clock of the first system")
        )
        for channel in recording.pulses
    )
    counted = f"{len(recording)} samples" if recording.signals else ""
    counted = ", ".join(filter(None, [counted, *(f"{len(channel)} pulses of {channel.name}" for channel in pulses)]))
    note = f"{MOVED}, by {1e6 * clocks.drift:.4g} ppm and {clocks.offset:.6g} s: {counted}"
    # A second of the first clock is 1 + drift seconds of the second, and holds as many samples more.
    rate = recording.sampling_rate * (1 + clocks.drift)
    moved = replace(recording, sampling_rate=rate, start=start, times=times, pulses=pulses)
    moved = moved.with_notes(note, *clocks.remarks)
    if like is None or not recording.signals:
        return moved
    if times is not None:
        raise UsageError(
            "signals with uneven time stamps cannot be brought to another clock; resample them first",
            kind="uneven-samples",
        )
    inside = (like.time >= start) & (like.time <= start + (len(recording) - 1) / rate)
    if not inside.any():
        raise UsageError(f"the two records have no time in common on one clock; {COMMON}", kind="unlike-results")
    even = like.time[inside]
    signals = tuple(
        replace(signal, values=interpolated_at(signal.values, rate, start, even, like.sampling_rate))
        for signal in recording
    )
    return replace(moved, signals=signals, sampling_rate=like.sampling_rate, start=float(even[0])).with_notes(
        f"{len(even)} samples interpolated at those of the first system"
    )


# Drift between the clocks of two measuring systems from a rotation that both recorded.

CYCLE = 4 * np.pi
"""Angle in rad over which angles are averaged, two turns, so that orders 0.5, 1, 1.5 ... and errors of teeth go out."""
POINTS_PER_CYCLE = 48
"""Number of points of such an average, which takes out orders up to 24."""
MOST_ITERATIONS, CONVERGED = 20, 1e-12
"""Most steps of the fit of two rotations, and the step, in s and of the drift, below which it has converged."""
MOST_DISAGREEMENT = 0.5
"""Largest RMS difference of two rotations in rad, beyond which they are not those of one machine; twist and vibration
are smaller."""
FEWEST_CYCLES = 8
"""Fewest averages over two turns from which drift and its interval are found."""


def rotation_clocks(first: WheelRotation, second: WheelRotation, *, same_start: bool = False) -> ClockDrift:
    """Drift and offset in s of the clock of a second system, from one rotation that both recorded by their wheels.

    Angles are averaged over two turns, so that vibration, twist and the errors of teeth go out. At steady speed the
    drift is found, and the offset only with ``same_start``; where the speed changes, both are found.

    Parameters
    ----------
    first, second : WheelRotation
        Rotation of the same shaft on either clock; the ratios of the wheels refer both to one shaft.
    same_start : bool
        Whether time 0 is the same on both clocks, as with a common trigger.

    Raises
    ------
    UsageError
        Too little in common: short records, or rotations that differ.

    Examples
    --------
    >>> from torsionnet.signals.rotation.pulse_channel import PulseChannel
    >>> from torsionnet.signals.rotation.wheel import Wheel
    >>> from torsionnet.signals.rotation.wheel_rotation import wheel_rotation
    >>> times, wheel = np.arange(6000) / 600, Wheel(teeth=60)
    >>> slow, quick = (wheel_rotation(PulseChannel("n", times * gain), wheel) for gain in (1, 1 + 50e-6))
    >>> round(1e6 * rotation_clocks(slow, quick, same_start=True).drift, 3)
    50.0
    """
    names = f"{first.name} and {second.name}"
    edges = _cycle_times(first, names)
    sign = float(np.sign(_mean_speed(first) * _mean_speed(second)))
    free = _is_changing(first) and not same_start
    offset, drift = 0.0 if same_start else _coarse_offset(first, second, names, changing=free), 0.0
    # Gauss-Newton: with the right clocks theta_2(offset + (1 + drift) t) and theta_1(t) differ by a constant alone.
    for _ in range(MOST_ITERATIONS):
        used = _inside(edges, second, offset, drift, names)
        times = (used[1:] + used[:-1]) / 2
        theirs, speeds = _averages(second, offset + (1 + drift) * used)
        ours, _ = _averages(first, used)
        errors, rates = sign * theirs - ours, sign * speeds
        solution = np.linalg.lstsq(_columns(times, rates, free=free), -errors, rcond=None)[0]
        step, shift = float(solution[1]), float(solution[2]) if free else 0.0
        drift, offset = drift + step, offset + shift
        if abs(drift) > MOST_DRIFT or max(abs(step), abs(shift)) < CONVERGED:
            break
    # The constant says nothing of the clocks; what varies beyond it is twist and vibration, or another shaft.
    left = errors - errors.mean()
    if abs(drift) > MOST_DRIFT or float(np.sqrt(np.mean(left**2))) > MOST_DISAGREEMENT:
        raise UsageError(
            f"{names} do not show one rotation, or have no time in common; {COMMON}", kind="unlike-results"
        )
    return _result(times, left, rates, offset, drift, free=free, same_start=same_start, names=names)


def _columns(times: FloatArray, rates: FloatArray, *, free: bool) -> FloatArray:
    """Columns (n, 2 or 3) in rad: what a constant angle, the drift and, if free, the offset add to the second angle."""
    return np.stack([np.ones(len(times)), rates * times, *([rates] if free else [])], axis=1)


def _coarse_offset(first: WheelRotation, second: WheelRotation, names: str, *, changing: bool) -> float:
    """Offset in s at which the speeds of two records agree best; that of their first pulses at steady speed."""
    begin = float(second.times[0] - first.times[0])
    if not changing:
        return begin
    # Intervals as long as the slowest cycle, so that each mean speed is over two turns or more.
    interval = float(np.diff(_cycle_times(first, names)).max())
    ours, theirs = (_even_speeds(rotation, interval) for rotation in (first, second))
    least, count = np.inf, min(len(ours), len(theirs))
    best = 0
    # At least half of the shorter record overlaps.
    for shift in range(count // 2 - len(ours), len(theirs) - count // 2 + 1):
        low, high = max(0, -shift), min(len(ours), len(theirs) - shift)
        if high - low >= max(count // 2, 2):
            size = float(np.mean((np.abs(theirs[low + shift : high + shift]) - np.abs(ours[low:high])) ** 2))
            least, best = (size, shift) if size < least else (least, best)
    return begin + best * interval


def _even_speeds(rotation: WheelRotation, interval: float) -> FloatArray:
    """Speed in rad/s averaged over intervals in s, one after the other from the first pulse on."""
    edges = np.arange(rotation.times[0], rotation.times[-1], interval)
    return np.asarray(np.diff(rotation.angle(edges)) / interval)


def _inside(edges: FloatArray, second: WheelRotation, offset: float, drift: float, names: str) -> FloatArray:
    """Edges of cycles, in s on the first clock, that the second record covers."""
    mapped = offset + (1 + drift) * edges
    kept: FloatArray = edges[(mapped >= second.times[0]) & (mapped <= second.times[-1])]
    if len(kept) <= FEWEST_CYCLES:
        count = 2 * max(len(kept) - 1, 0)
        raise UsageError(
            f"{names} have {count} turns in common, {2 * FEWEST_CYCLES} are needed to compare their clocks; {COMMON}",
            kind="too-short",
        )
    return kept


def _result(
    times: FloatArray, left: FloatArray, rates: FloatArray, offset: float, drift: float,
    *, free: bool, same_start: bool, names: str,
) -> ClockDrift:  # fmt: skip
    # Covariance s^2 (A^T A)^-1, with columns scaled to length 1, as the unknowns differ by decades in size.
    matrix = _columns(times, rates, free=free)
    deviation = np.sqrt(np.sum(left**2) / max(len(left) - matrix.shape[1], 1) * variance_factor(left))
    scale = np.sqrt(np.sum(matrix**2, axis=0))
    inverse = np.linalg.pinv((matrix / scale).T @ (matrix / scale))
    half = HALF_WIDTH_DEVIATIONS * deviation * np.sqrt(np.diag(inverse)) / scale
    turn = 2 * np.pi / float(np.abs(rates).mean())
    said = f"clocks from {len(times)} averages of the rotation of {names}: {1e6 * drift:.4g} ppm"
    # An interval as wide as a turn leaves the offset open: a turn earlier or later fits as well.
    if free and half[2] < turn / 2:
        return ClockDrift(drift, float(half[1]), offset, float(half[2]), 0.0, (f"{said}, offset {offset:.6g} s",))
    if same_start:
        return ClockDrift(drift, float(half[1]), 0.0, 0.0, 0.0, (f"{said}, started together",))
    open_ = warning(f"at steady speed the offset stays open by whole turns of {turn:.4g} s and within one; {COMMON}")
    return ClockDrift(drift, float(half[1]), offset, float("inf"), turn, (said, open_))


def _mean_speed(rotation: WheelRotation) -> float:
    first, last = rotation.angle(rotation.times[[0, -1]])
    return float((last - first) / (rotation.times[-1] - rotation.times[0]))


def _is_changing(rotation: WheelRotation) -> bool:
    """Whether the speed, averaged over cycles, changes by more than a thousandth."""
    speeds = CYCLE / np.diff(_cycle_times(rotation, rotation.name))
    return bool(np.ptp(speeds) > 1e-3 * speeds.mean())


def _cycle_times(rotation: WheelRotation, names: str) -> FloatArray:
    """Times in s at which a shaft has turned by whole cycles since its first pulse, (n,)."""
    angle = np.abs(rotation.angle(rotation.times) - rotation.angle(rotation.times[:1])[0])
    count = int(angle[-1] / CYCLE)
    if count < FEWEST_CYCLES:
        raise UsageError(
            f"{names} have {2 * count} turns in common, clocks are compared from {2 * FEWEST_CYCLES} on; {COMMON}",
            kind="too-short",
        )
    # The ends need not be exact, as both records are averaged between the same times: linear between pulses does.
    return np.asarray(np.interp(CYCLE * np.arange(count + 1), angle, rotation.times))


def _averages(rotation: WheelRotation, edges: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Angle in rad averaged between times in s, and speed in rad/s, (n - 1,) each."""
    # Means over each cycle by the midpoint rule.
    share = (np.arange(POINTS_PER_CYCLE) + 0.5) / POINTS_PER_CYCLE
    points = edges[:-1, None] + np.diff(edges)[:, None] * share
    limits = rotation.times[[0, -1]]
    angles = rotation.angle(np.clip(points.ravel(), *limits)).reshape(points.shape)
    turned = np.diff(rotation.angle(np.clip(edges, *limits)))
    return angles.mean(axis=1), turned / np.diff(edges)


# Drift between the clocks of two measuring systems from a signal, as a torque, that both recorded.

LEAST_CORRELATION = 0.5
"""Least correlation of two signals in a window from which a delay is read; below it they have too little in common."""
SECOND_PEAK = 0.95
"""Share of the largest correlation that another delay may reach before the delay counts as ambiguous."""
MOST_LAG_SHARE = 0.5
"""Share of a window by which the first delay of two signals may differ from nought."""
FEWEST_WINDOWS = 4
"""Fewest windows of a signal from which drift and its interval are found."""


def signal_clocks(first: Recording, second: Recording, name: str, *, seconds: float | None = None) -> ClockDrift:
    """Drift and offset in s of the clock of a second system, from one signal, as a torque, that both recorded.

    In windows one after the other the delay is read from the slope of the phase between the two. A window begins
    where the drift found so far puts it, so that a delay may grow beyond a period of the signal.

    Parameters
    ----------
    first, second : Recording
        Records that hold the signal under one name; its quantity or gain may differ.
    name : str
    seconds : float, optional
        Length of a window, s; by default a twentieth of the shorter record, 0.5 s or more.

    Raises
    ------
    UsageError
        The two have too little in common, or the records are too short.

    Examples
    --------
    >>> from torsionnet.signals.recording import Signal
    >>> chance = np.random.default_rng(1)
    >>> noise = np.convolve(chance.normal(size=8100), np.hanning(9), "valid")
    >>> ours = Recording((Signal("T", "torque", noise[100:8000]),), 1000.0)
    >>> theirs = Recording((Signal("T", "torque", noise[:7900]),), 1000.0)
    >>> round(signal_clocks(ours, theirs, "T").offset, 4)
    0.1
    """
    ours, theirs, rate = first[name].values, second[name].values, first.sampling_rate
    span = min(first.duration, second.duration)
    length = round((seconds or max(span / 20, 0.5)) * rate)
    starts = np.arange(0, len(ours) - length + 1, length)
    if len(starts) < FEWEST_WINDOWS:
        raise UsageError(
            f"{name}: {len(starts)} windows are too few to compare clocks; record longer; {COMMON}", kind="too-short"
        )
    centres, delays, weights, period = list[float](), list[float](), list[float](), 0.0
    # The starts of both records are the first guess; each window corrects it for the next.
    guess = second.start - first.start
    lag = MOST_LAG_SHARE * length / rate
    for begin in starts:
        middle = first.start + (begin + length / 2) / rate
        # Twice the lag on either side, so that the window of the second holds what the first saw.
        margin = round(lag * rate)
        wanted = first.start + guess + (begin - margin + np.arange(length + 2 * margin)) / rate
        inside = (wanted >= second.start) & (wanted <= second.start + (len(theirs) - 1) / second.sampling_rate)
        if not inside[margin : margin + length].all():
            continue
        there = np.where(inside, interpolated_at(theirs, second.sampling_rate, second.start, wanted, rate), 0.0)
        delay = _delay(ours[begin : begin + length], there, margin, rate)
        if delay is None:
            continue
        shift, correlation, repeat = delay
        period = period or repeat
        centres.append(middle)
        delays.append(guess + shift)
        weights.append(correlation)
        guess += shift
        # The first window finds the offset; the next differ by the drift alone.
        lag = min(lag, max(4 / rate, 4 * MOST_DRIFT * length / rate))
    if len(centres) < FEWEST_WINDOWS:
        raise UsageError(
            f"{name}: the two records correlate in {len(centres)} of {len(starts)} windows, less than "
            f"{LEAST_CORRELATION:g} in the others; they have too little in common to compare their clocks; {COMMON}",
            kind="unlike-results",
        )
    return clocks_of_delays(np.array(centres), np.array(delays), np.array(weights), period, name)


def _delay(ours: FloatArray, there: FloatArray, margin: int, rate: float) -> tuple[float, float, float] | None:
    """Delay in s of the second window, its correlation, and the period in s at which it recurs, 0 where it does not."""
    a = ours - ours.mean()
    size = float(np.sqrt(np.sum(a**2)))
    lags = np.arange(-margin, margin + 1)
    scores = np.empty(len(lags))
    count = len(a)
    # Normalised cross-correlation sum a (b - mean b)/(|a| |b - mean b|); as a is of mean 0, sum a b is the numerator.
    sums = np.correlate(there, a, "valid")
    squares = np.concatenate([[0.0], np.cumsum(there**2)])
    means = np.concatenate([[0.0], np.cumsum(there)])
    power = squares[count:] - squares[:-count] - (means[count:] - means[:-count]) ** 2 / count
    scores = sums / np.maximum(size * np.sqrt(np.maximum(power, 0.0)), 1e-300)
    best = int(np.argmax(scores))
    if not size or scores[best] < LEAST_CORRELATION:
        return None
    shift = float(lags[best])
    # Vertex of the parabola through the peak and its neighbours: the delay in parts of a sample.
    if 0 < best < len(scores) - 1:
        before, at, after = scores[best - 1 : best + 2]
        curve = before - 2 * at + after
        shift += 0.5 * float((before - after) / curve) if curve else 0.0
    # Other peaks about as high are the same signal a period on: the delay is open by their distance.
    peaks = [n for n in range(1, len(scores) - 1) if scores[n] >= max(scores[n - 1], scores[n + 1]) and n != best]
    again = [abs(n - best) for n in peaks if scores[n] > SECOND_PEAK * scores[best]]
    return shift / rate, float(scores[best]), min(again) / rate if again else 0.0


def clocks_of_delays(
    times: FloatArray, delays: FloatArray, weights: FloatArray, period: float, name: str
) -> ClockDrift:
    """Clocks by the straight line through delays in s over time in s, whose slope is the drift."""
    # delay = offset + drift t, each window weighted by its correlation.
    matrix = np.stack([np.ones(len(times)), times], axis=1)
    root = np.sqrt(weights)
    line = np.linalg.lstsq(matrix * root[:, None], delays * root, rcond=None)[0]
    left = delays - matrix @ line
    # Covariance s^2 (A^T W A)^-1 of offset and slope, s^2 the variance of a window of weight 1; neighbouring windows
    # err alike, which the variance factor counts.
    deviation = float(np.sqrt(np.sum(weights * left**2) / (len(left) - 2)))
    inverse = np.linalg.inv(matrix.T @ (matrix * weights[:, None]))
    half = HALF_WIDTH_DEVIATIONS * deviation * np.sqrt(np.diag(inverse) * variance_factor(left))
    said = f"clocks from the delay of {name} in {len(times)} windows: {1e6 * line[1]:.4g} ppm, offset {line[0]:.6g} s"
    remarks: list[NoteOrText] = [said]
    if period:
        text = f"{name} repeats itself: the offset is open by whole multiples of {period:.4g} s"
        remarks.append(warning(f"{text}; {COMMON}"))
    return ClockDrift(
        float(line[1]), float(half[1]), float(line[0]), float("inf") if period else float(half[0]), period,
        tuple(remarks),
    )  # fmt: skip
