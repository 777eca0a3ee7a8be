"""Stretches in which a signal stands still that otherwise moves."""

from __future__ import annotations

from collections import Counter

import numpy as np

from torsionnet.response.recording import FloatArray
from torsionnet.signals.faults_in_values import Stretches

LEAST_SAMPLES, LEAST_TIME = 20, 0.05
ALWAYS_SEEN, FEWEST = 0.15, 8
"""s; so long a stretch counts at low sampling rates too, where it is of so many samples at least."""
LONGER, AROUND = 10.0, 20
"""So many times as long as each of so many runs of equal values on either side; a quantised peak is under seven."""
OTHERS = 2
"""Of the runs around, which may be frozen stretches as well."""
LEAST_RANGE = 5.0
"""Steps of a sensor that the signal moves by around the stretch."""
JUMP = 5.0
ROUGH, ROUND_OFF = 0.3, 1e-9
"""Differences over those of one order less, above which there is noise or steps, unless they are round-off."""


def frozen(values: FloatArray, sampling_rate: float, step: float = 0.0) -> Stretches:
    """First and last samples of frozen stretches.

    Not of a signal that rests: at the ends of the record, at 0, at its first value or at one it comes back to, nor of
    a smooth one that stops and goes on without a jump, as a set-point does, nor of a sensor of such steps that moves by
    few of them.

    >>> values = np.sin(np.arange(2000) / 20)
    >>> values[700:900] = values[700]
    >>> frozen(values, 1000.0)
    [(700, 899)]
    """
    changes = np.flatnonzero(np.diff(values) != 0)
    firsts = np.concatenate([[0], changes + 1])
    lengths = np.diff(np.concatenate([firsts, [len(values)]]))
    least = max(LEAST_TIME * sampling_rate, min(LEAST_SAMPLES, ALWAYS_SEEN * sampling_rate), FEWEST)
    long = [int(run) for run in np.flatnonzero(lengths >= least) if 0 < run < len(lengths) - 1]
    levels = Counter(float(values[firsts[run]]) for run in long)
    rest = {0.0, float(values[0])}
    found = []
    for run in long:
        first, last = int(firsts[run]), int(firsts[run] + lengths[run]) - 1
        level = float(values[first])
        before, after = slice(max(0, run - AROUND), run), slice(run + 1, run + 1 + AROUND)
        others = np.sort(np.concatenate([lengths[before], lengths[after]]))
        if level in rest or levels[level] > 1 or lengths[run] <= LONGER * others[max(0, len(others) - 1 - OTHERS)]:
            continue
        sides = values[firsts[before.start] : first + 1], values[last + 1 : int(firsts[after][-1]) + 1]
        if _moves(sides, step) and (is_rough(sides) or _jumps(sides, values[last + 1] - level)):
            found.append((first, last))
    return found


def _moves(sides: tuple[FloatArray, FloatArray], step: float) -> bool:
    return bool(np.ptp(np.concatenate(sides)) >= LEAST_RANGE * step)


def is_rough(sides: tuple[FloatArray, FloatArray]) -> bool:
    """Whether there is noise or steps in a signal, at least in how it turns."""
    least = ROUND_OFF * max(float(np.ptp(side)) for side in sides)
    changes, turns, thirds = (sum(float(np.abs(np.diff(side, n)).sum()) for side in sides) for n in (1, 2, 3))
    count = sum(len(side) for side in sides)
    return turns > least * count and (turns > ROUGH * changes or thirds > ROUGH * turns)


def _jumps(sides: tuple[FloatArray, FloatArray], jump: float) -> bool:
    most = max((float(np.abs(np.diff(side)).max()) for side in sides if len(side) > 1), default=0.0)
    return abs(jump) > JUMP * most
