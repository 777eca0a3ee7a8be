"""Signals of a long record between two times, which move on: blocks are read as they are needed and then dropped."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.signals.decimation import Recordings, blocks_in_order, check_processable
from torsionnet.signals.recording import FloatArray, Recording, Signal
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
