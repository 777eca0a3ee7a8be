"""Drift between the clocks of two measuring systems from a rotation that both recorded."""

from __future__ import annotations

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import warning
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.clock_drift import (
    COMMON,
    HALF_WIDTH_DEVIATIONS,
    MOST_DRIFT,
    ClockDrift,
    variance_factor,
)
from torsionnet.signals.rotation.wheel_rotation import WheelRotation

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
    for _ in range(MOST_ITERATIONS):
        used = _inside(edges, second, offset, drift, names)
        times = (used[1:] + used[:-1]) / 2
        theirs, speeds = _averages(second, offset + (1 + drift) * used)
        ours, _ = _averages(first, used)
        errors, rates = sign * theirs - ours, sign * speeds
        found = np.linalg.lstsq(_columns(times, rates, free=free), -errors, rcond=None)[0]
        step, shift = float(found[1]), float(found[2]) if free else 0.0
        drift, offset = drift + step, offset + shift
        if abs(drift) > MOST_DRIFT or max(abs(step), abs(shift)) < CONVERGED:
            break
    left = errors - errors.mean()
    if abs(drift) > MOST_DRIFT or float(np.sqrt(np.mean(left**2))) > MOST_DISAGREEMENT:
        raise UsageError(f"{names} do not show one rotation, or have no time in common; {COMMON}")
    return _result(times, left, rates, offset, drift, free=free, same_start=same_start, names=names)


def _columns(times: FloatArray, rates: FloatArray, *, free: bool) -> FloatArray:
    """Columns (n, 2 or 3) in rad: what a constant angle, the drift and, if free, the offset add to the second angle."""
    return np.stack([np.ones(len(times)), rates * times, *([rates] if free else [])], axis=1)


def _coarse_offset(first: WheelRotation, second: WheelRotation, names: str, *, changing: bool) -> float:
    """Offset in s at which the speeds of two records agree best; that of their first pulses at steady speed."""
    begin = float(second.times[0] - first.times[0])
    if not changing:
        return begin
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
            f"{names} have {count} turns in common, {2 * FEWEST_CYCLES} are needed to compare their clocks; {COMMON}"
        )
    return kept


def _result(
    times: FloatArray, left: FloatArray, rates: FloatArray, offset: float, drift: float,
    *, free: bool, same_start: bool, names: str,
) -> ClockDrift:  # fmt: skip
    matrix = _columns(times, rates, free=free)
    deviation = np.sqrt(np.sum(left**2) / max(len(left) - matrix.shape[1], 1) * variance_factor(left))
    scale = np.sqrt(np.sum(matrix**2, axis=0))
    inverse = np.linalg.pinv((matrix / scale).T @ (matrix / scale))
    half = HALF_WIDTH_DEVIATIONS * deviation * np.sqrt(np.diag(inverse)) / scale
    turn = 2 * np.pi / float(np.abs(rates).mean())
    said = f"clocks from {len(times)} averages of the rotation of {names}: {1e6 * drift:.4g} ppm"
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
            f"{names} have {2 * count} turns in common, clocks are compared from {2 * FEWEST_CYCLES} on; {COMMON}"
        )
    return np.asarray(np.interp(CYCLE * np.arange(count + 1), angle, rotation.times))


def _averages(rotation: WheelRotation, edges: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Angle in rad averaged between times in s, and speed in rad/s, (n - 1,) each."""
    share = (np.arange(POINTS_PER_CYCLE) + 0.5) / POINTS_PER_CYCLE
    points = edges[:-1, None] + np.diff(edges)[:, None] * share
    limits = rotation.times[[0, -1]]
    angles = rotation.angle(np.clip(points.ravel(), *limits)).reshape(points.shape)
    turned = np.diff(rotation.angle(np.clip(edges, *limits)))
    return angles.mean(axis=1), turned / np.diff(edges)
