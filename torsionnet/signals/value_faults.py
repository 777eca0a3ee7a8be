"""Faults in the values of one channel (clipped peaks, wrap-around and leaps of encoders)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from torsionnet.signals.recording import FloatArray
from torsionnet.signals.sensor_resolution import MOST_STEPS

Stretches = list[tuple[int, int]]
CLIPPED_RUN_RATIO = 5.0
"""Length of a flat top over the runs of equal values next to it above which it is clipped, as a quantised peak stays
4.8 times as long on its last step as on the one before."""
SAME_JUMP_DIFFERENCE = 0.05
"""Relative difference up to which jumps of an angle have the same size, as those of an encoder that wraps around do."""
LEAP_STEPS = 3
"""Number of encoder steps by which a leap of an angle exceeds the steps around it, as two may be rounding at a peak of
the speed."""
SWITCH_SHARE = 0.9
"""Share of samples at its limits above which a signal is a switch, as a sine clipped at a tenth of its height is there
94 % of the time, at half of it 67 %."""


def true_stretches(where: NDArray[np.bool_]) -> Stretches:
    """First and last index of every run of True values in a mask.

    >>> true_stretches(np.array([False, True, True, False, True]))
    [(1, 2), (4, 4)]
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], where, [False]]).astype(np.int8)))
    return [(int(first), int(last) - 1) for first, last in edges.reshape(-1, 2)]


def flat_tops(values: FloatArray) -> Stretches:
    """First and last index of clipped stretches, runs at a signal's largest or smallest value too long for a peak.

    Runs at the ends of the record do not count, nor a signal that is at its limits most of the time, like a switch.
    """
    finite = np.isfinite(values)
    limits = (float(np.max(values[finite])), float(np.min(values[finite])))
    if limits[0] == limits[1] or np.mean(np.isin(values, limits)) > SWITCH_SHARE:
        return []
    runs = [run for limit in limits for run in true_stretches(values == limit)]
    return sorted((first, last) for first, last in runs if _is_clipped(values, first, last))


def _is_clipped(values: FloatArray, first: int, last: int) -> bool:
    length = last - first + 1
    if first == 0 or last == len(values) - 1:
        return False
    span = int(length / CLIPPED_RUN_RATIO) + 1
    before, after = values[max(0, first - span) : first][::-1], values[last + 1 : last + 1 + span]
    return length > CLIPPED_RUN_RATIO * max(_run(before), _run(after), 1)


def _run(values: FloatArray) -> int:
    other = np.flatnonzero(values != values[0])
    return int(other[0]) if len(other) else len(values)


def wrap_jumps(values: FloatArray) -> tuple[NDArray[np.intp], float]:
    """Indices of the samples before the jumps of an encoder that wraps around, and the size of the jumps in rad."""
    steps = np.diff(values)
    span = float(np.max(values) - np.min(values)) if len(values) else 0.0
    jumps = np.flatnonzero(np.abs(steps) > max(0.8 * span, 0.8 * np.pi)) if span > 0 else np.empty(0, np.intp)
    if not len(jumps) or len(jumps) == len(steps):
        return np.empty(0, np.intp), 0.0
    sizes, others = np.abs(steps[jumps]), np.abs(np.delete(steps, jumps))
    size = float(np.median(sizes))
    alike = np.all(np.abs(sizes - size) <= SAME_JUMP_DIFFERENCE * size) and np.max(others) < size / 2
    return (jumps, size) if alike else (np.empty(0, np.intp), 0.0)


def encoder_leaps(values: FloatArray) -> NDArray[np.intp]:
    """Indices of the samples at which a quantised angle leaps by three encoder steps more than around it."""
    steps = np.diff(values)
    moved = np.abs(steps[steps != 0])
    if len(moved) < 10:
        return np.empty(0, np.intp)
    quantum = float(np.min(moved))
    if np.max(moved) > MOST_STEPS * quantum:
        return np.empty(0, np.intp)
    counts = np.rint(steps / quantum)
    if np.max(np.abs(steps - counts * quantum)) > 0.01 * quantum:
        return np.empty(0, np.intp)
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(counts, 2, mode="reflect"), 5)
    others = windows[:, [0, 1, 3, 4]]
    calm = np.ptp(others, axis=1) <= 1
    return np.flatnonzero(calm & (np.abs(counts - np.median(others, axis=1)) >= LEAP_STEPS)) + 1
