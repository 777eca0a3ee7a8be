"""Signals of a long record between two times, which move on: blocks are read as they are needed and then dropped."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from torsionnet.core.errors import UsageError
from torsionnet.response.recording import FloatArray, Recording, Signal
from torsionnet.signals.record_blocks import Recordings, blocks_in_order, check_processable

MARGIN_SAMPLES = 24
"""Samples kept on either side of a window, so that a spline through it is as good at its ends: the influence of an end
falls by 0.27 a sample."""


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
            raise UsageError("the record is empty")
        self.signals: tuple[Signal, ...] = first.signals
        self.rate, self._start, self._values = first.sampling_rate, first.start, _stack(first)
        self.title = first.title

    @property
    def start(self) -> float:
        """Time of the first sample still held, s."""
        return self._start

    def reaches(self, time: float) -> bool:
        """Whether the record goes on to a time in s; blocks are read until it does."""
        while self._end < time:
            block, continued = next(self._blocks, (None, False))
            if block is None:
                return False
            if not continued:
                raise UsageError("the blocks do not follow one another: track each record by itself")
            self._values = np.concatenate([self._values, _stack(block)], axis=1)
        return True

    def between(self, begin: float, end: float) -> tuple[FloatArray, FloatArray]:
        """Times in s and values (n_signals, n) of the samples from ``begin`` to ``end``, with a margin on both sides.

        What comes before the margin is dropped, so that ``begin`` must not fall from call to call.
        """
        self.reaches(end + MARGIN_SAMPLES / self.rate)
        drop = max(int(np.floor((begin - self._start) * self.rate)) - MARGIN_SAMPLES, 0)
        self._values = self._values[:, drop:]
        self._start += drop / self.rate
        count = min(int(np.ceil((end - self._start) * self.rate)) + MARGIN_SAMPLES + 1, self._values.shape[1])
        return self._start + np.arange(count) / self.rate, self._values[:, :count]

    @property
    def _end(self) -> float:
        return float(self._start + (self._values.shape[1] - 1) / self.rate)


def _selected(recordings: Iterable[Recording], names: Sequence[str]) -> Iterator[Recording]:
    for block in recordings:
        chosen = block.select(names)
        check_processable(chosen)
        yield chosen


def _stack(block: Recording) -> FloatArray:
    return np.array([signal.values for signal in block], dtype=np.float64)
