"""Drop-outs of telemetry in a signal that vibrates: stretches in which the receiver holds a value, or shows 0."""

from __future__ import annotations

import numpy as np

from torsionnet.signals.recording import FloatArray
from torsionnet.signals.standstill import (
    FEWEST_SAMPLES,
    LEAST_LENGTH_RATIO,
    RUNS_AROUND,
    SKIPPED_RUNS,
    is_rough,
    jumps_away,
)
from torsionnet.signals.value_faults import LEAP_STEPS, Stretches

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
    found = []
    for run in np.flatnonzero(lengths >= FEWEST_SAMPLES).tolist():
        if not 0 < run < len(lengths) - 1:
            continue
        before, after = slice(max(0, run - RUNS_AROUND), run), slice(run + 1, run + 1 + RUNS_AROUND)
        others = np.sort(np.concatenate([lengths[before], lengths[after]]))
        longer = lengths[run] / others[max(0, len(others) - 1 - SKIPPED_RUNS)]
        if longer <= 1:
            continue
        first, last = int(firsts[run]), int(firsts[run + 1]) - 1
        sides = values[firsts[before.start] : first], values[last + 1 : int(firsts[after][-1]) + 1]
        if (longer > LEAST_LENGTH_RATIO and _stops(sides, step)) or _jumps(
            sides, float(values[(first + last) // 2]), step
        ):
            found.append((first, last))
    return _without_limits(values, found, span)


def _stops(sides: tuple[FloatArray, FloatArray], step: float) -> bool:
    """Whether both sides hold noise that would be seen in steps of the converter."""
    turns = [np.abs(np.diff(side, 2)) for side in sides if len(side) > 2]
    return bool(turns) and float(np.concatenate(turns).mean()) > ROUNDING_TURNS * step and is_rough(sides)


def _jumps(sides: tuple[FloatArray, FloatArray], level: float, step: float) -> bool:
    """Whether the signal goes on elsewhere, by a jump that neither its course nor the converter makes."""
    jump = float(sides[1][0]) - level
    return abs(jump) > LEAP_STEPS * step and jumps_away(sides, jump)


def _without_limits(values: FloatArray, found: Stretches, span: float) -> Stretches:
    """Stretches without those at levels to which the signal comes by itself, as to its limits."""
    levels = np.array([values[(first + last) // 2] for first, last in found])
    tolerance = FLAT_SHARE * span
    sorted_levels = np.sort(levels)
    alike = np.searchsorted(sorted_levels, levels + tolerance, "right") - np.searchsorted(
        sorted_levels, levels - tolerance
    )
    zero = np.abs(levels) <= tolerance
    ends = [(max(first - EDGE_SAMPLES, 0), min(last + EDGE_SAMPLES, len(values) - 1)) for first, last in found]
    beside = np.array([np.abs(values[list(both)]).min() for both in ends])
    kept = (alike == 1) | (zero & (np.median(beside[zero]) > EDGE_SHARE * span if zero.any() else False))
    lost = [stretch for stretch, keep in zip(found, kept.tolist(), strict=True) if keep]
    return lost if sum(last - first + 1 for first, last in lost) <= MOST_LOST * len(values) else []
