"""Search of a moving signal for frozen stretches, in which it stands still."""

from __future__ import annotations

from collections import Counter

import numpy as np

from torsionnet.signals.recording import FloatArray
from torsionnet.signals.value_faults import Stretches

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
    changes = np.flatnonzero(np.diff(values) != 0)
    firsts = np.concatenate([[0], changes + 1])
    lengths = np.diff(np.concatenate([firsts, [len(values)]]))
    least = max(
        LEAST_TIME * sampling_rate, min(LEAST_SAMPLES, LEAST_TIME_SLOW_SAMPLING * sampling_rate), FEWEST_SAMPLES
    )
    long = [int(run) for run in np.flatnonzero(lengths >= least) if 0 < run < len(lengths) - 1]
    levels = Counter(float(values[firsts[run]]) for run in long)
    rest = {0.0, float(values[0])}
    found = []
    for run in long:
        first, last = int(firsts[run]), int(firsts[run] + lengths[run]) - 1
        level = float(values[first])
        before, after = slice(max(0, run - RUNS_AROUND), run), slice(run + 1, run + 1 + RUNS_AROUND)
        others = np.sort(np.concatenate([lengths[before], lengths[after]]))
        if (
            level in rest
            or levels[level] > 1
            or lengths[run] <= LEAST_LENGTH_RATIO * others[max(0, len(others) - 1 - SKIPPED_RUNS)]
        ):
            continue
        sides = values[firsts[before.start] : first + 1], values[last + 1 : int(firsts[after][-1]) + 1]
        if _moves(sides, step) and (is_rough(sides) or jumps_away(sides, values[last + 1] - level)):
            found.append((first, last))
    return found


def _moves(sides: tuple[FloatArray, FloatArray], step: float) -> bool:
    return bool(np.ptp(np.concatenate(sides)) >= LEAST_RANGE_STEPS * step)


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
