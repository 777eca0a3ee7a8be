"""Faults in the values of one channel (clipped peaks, wrap-around and leaps of encoders)."""

from __future__ import annotations

from collections import Counter

import numpy as np
from numpy.typing import NDArray

from torsionnet.signals.recording import FloatArray
from torsionnet.signals.uncertainty import MOST_STEPS

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
    # Next to a clipped top the signal does not rest: runs beside it are short.
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
    # Jumps of a wrapping encoder are all of one size, far above the steps between them.
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
    # Where the shaft turns evenly before and after, a larger step is no motion.
    calm = np.ptp(others, axis=1) <= 1
    return np.flatnonzero(calm & (np.abs(counts - np.median(others, axis=1)) >= LEAP_STEPS)) + 1


# Search of a moving signal for frozen stretches, in which it stands still.

LEAST_SAMPLES, LEAST_TIME = 20, 0.05
"""Least length of a frozen stretch in samples and in s, as shorter ones occur at turning points."""
LEAST_TIME_SLOW_SAMPLING, FEWEST_SAMPLES = 0.15, 8
"""Length in s from which a frozen stretch counts at low sampling rates too, and its fewest samples there."""
LEAST_LENGTH_RATIO, RUNS_AROUND = 10.0, 20
"""Least length of a frozen stretch over the runs of equal values around it, as a quantised peak is less than seven
times as long, and the number of runs on either side."""
SKIPPED_RUNS = 2
"""Number of runs around a frozen stretch that may be frozen as well, and are left out of the comparison."""
LEAST_RANGE_STEPS = 5.0
"""Least range of the signal around a frozen stretch in steps of the sensor, as slower motion may stay within a step."""
JUMP_RATIO = 5.0
"""Jump at the end of a frozen stretch over the largest change around it above which samples were lost."""
ROUGHNESS_RATIO, ROUND_OFF_SHARE = 0.3, 1e-9
"""Ratio of differences to those of one order less above which a signal holds noise or steps, and size of differences
over the signal's range below which they are round-off."""


def frozen_stretches(values: FloatArray, sampling_rate: float, step: float = 0.0) -> Stretches:
    """First and last sample index of each stretch in which a moving signal stands still.

    Stretches of a signal at rest do not count (at the ends of the record, at 0, at its first value or at a value it
    returns to), nor those of a smooth signal that stops and continues without a jump, such as a set-point, nor those of
    a sensor with steps that moves by few of them.

    >>> values = np.sin(np.arange(2000) / 20)
    >>> values[700:900] = values[700]
    >>> frozen_stretches(values, 1000.0)
    [(700, 899)]
    """
    # Runs of equal values; those at the ends of the record do not show that the signal moves before and after.
    changes = np.flatnonzero(np.diff(values) != 0)
    firsts = np.concatenate([[0], changes + 1])
    lengths = np.diff(np.concatenate([firsts, [len(values)]]))
    least = max(
        LEAST_TIME * sampling_rate, min(LEAST_SAMPLES, LEAST_TIME_SLOW_SAMPLING * sampling_rate), FEWEST_SAMPLES
    )
    long = [int(run) for run in np.flatnonzero(lengths >= least) if 0 < run < len(lengths) - 1]
    levels = Counter(float(values[firsts[run]]) for run in long)
    rest = {0.0, float(values[0])}
    stretches = []
    for run in long:
        first, last = int(firsts[run]), int(firsts[run] + lengths[run]) - 1
        level = float(values[first])
        before, after = slice(max(0, run - RUNS_AROUND), run), slice(run + 1, run + 1 + RUNS_AROUND)
        # A signal that moves slowly has long runs all around; a level that it returns to is where it rests.
        others = np.sort(np.concatenate([lengths[before], lengths[after]]))
        if (
            level in rest
            or levels[level] > 1
            or lengths[run] <= LEAST_LENGTH_RATIO * others[max(0, len(others) - 1 - SKIPPED_RUNS)]
        ):
            continue
        sides = values[firsts[before.start] : first + 1], values[last + 1 : int(firsts[after][-1]) + 1]
        moves = np.ptp(np.concatenate(sides)) >= LEAST_RANGE_STEPS * step
        if moves and (is_rough(sides) or jumps_away(sides, values[last + 1] - level)):
            stretches.append((first, last))
    return stretches


def is_rough(sides: tuple[FloatArray, FloatArray]) -> bool:
    """Whether a signal holds noise or steps, by the size of its second and third differences."""
    least = ROUND_OFF_SHARE * max(float(np.ptp(side)) for side in sides)
    changes, turns, thirds = (sum(float(np.abs(np.diff(side, n)).sum()) for side in sides) for n in (1, 2, 3))
    count = sum(len(side) for side in sides)
    return turns > least * count and (turns > ROUGHNESS_RATIO * changes or thirds > ROUGHNESS_RATIO * turns)


def jumps_away(sides: tuple[FloatArray, FloatArray], jump: float) -> bool:
    """Whether a jump is far larger than the changes from sample to sample on both sides of a stretch."""
    most = max((float(np.abs(np.diff(side)).max()) for side in sides if len(side) > 1), default=0.0)
    return abs(jump) > JUMP_RATIO * most


# Search of a signal for spikes, which are single samples far from both their neighbours.

NEIGHBOUR_SAMPLES = 50
"""Number of samples on either side with whose changes and second differences those of a possible spike are compared."""
LEAST_SHARPNESS, LEAST_SIZE, SKIPPED_SPIKES = 8.0, 2.0, 3
"""Least second difference and least change of a spike over those around it, more than noise reaches, and number of
other spikes around that are left out of the comparison."""
EXAMINED_SHARPNESS = 4.0
"""Second difference of a sample over the mean around it above which it is examined closely, a quick test that saves
time."""
LEAST_STEPS = 3.0
"""Least second difference of a spike in steps of the sensor, as rounding to steps makes smaller ones."""
MOST_ASYMMETRY = 2.0
"""Largest ratio of the rise and the fall of a spike, as a larger one is an edge of the signal."""
SAMPLES_PER_BATCH = 2000
"""Number of possible spikes that are examined together, which limits the memory."""


def spikes(values: FloatArray, step: float = 0.0) -> NDArray[np.intp]:
    """Indices of the samples of a signal that are spikes, for a sensor with steps of size ``step`` or 0.

    A spike rises and falls by about the same, and has a far larger second difference than the hundred samples around.
    Noise has not, whatever its distribution, nor has the end of a burst.

    >>> values = np.sin(np.arange(500) / 10)
    >>> values[300] += 5
    >>> spikes(values)
    array([300])
    """
    if len(values) < 2 * NEIGHBOUR_SAMPLES:
        return np.empty(0, np.intp)
    rise, fall = np.diff(values)[:-1], -np.diff(values)[1:]
    # Distance of each sample from the middle of its neighbours.
    turn = np.abs(rise + fall) / 2
    sums = np.cumsum(np.concatenate([[0.0], turn]))
    ends = np.clip(np.arange(len(turn))[:, None] + [-NEIGHBOUR_SAMPLES, NEIGHBOUR_SAMPLES + 1], 0, len(turn))
    # Mean of those around, without the sample itself.
    usual = (sums[ends[:, 1]] - sums[ends[:, 0]] - turn) / (ends[:, 1] - ends[:, 0] - 1)
    sizes = np.sort(np.abs([rise, fall]), axis=0)
    seen = (
        (rise * fall > 0)
        & (sizes[1] <= MOST_ASYMMETRY * sizes[0])
        & (turn > LEAST_STEPS * step)
        & (turn > EXAMINED_SHARPNESS * usual)
    )
    places = np.flatnonzero(seen)
    outliers = [np.empty(0, np.intp)]
    for begin in range(0, len(places), SAMPLES_PER_BATCH):
        some = places[begin : begin + SAMPLES_PER_BATCH]
        sharp, large = (
            turn[some] > LEAST_SHARPNESS * _level(turn, some),
            sizes[0, some] > LEAST_SIZE * _level(np.abs(rise), some),
        )
        outliers.append(some[sharp & large])
    return np.concatenate(outliers) + 1


def _level(values: FloatArray, places: NDArray[np.intp]) -> FloatArray:
    """Largest value around each index, (n,), without those of SKIPPED_SPIKES other spikes (three samples each)."""
    around = np.concatenate([np.arange(-NEIGHBOUR_SAMPLES, -1), np.arange(2, NEIGHBOUR_SAMPLES + 1)])
    near = places[:, None] + around
    others = np.where((near >= 0) & (near < len(values)), values[np.clip(near, 0, len(values) - 1)], 0.0)
    return np.asarray(np.partition(others, -1 - 3 * SKIPPED_SPIKES, axis=1)[:, -1 - 3 * SKIPPED_SPIKES])
