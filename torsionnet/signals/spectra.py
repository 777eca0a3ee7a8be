"""Auto and cross spectra of recordings by Welch's method, in bounded memory."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.frequency_response import Channel
from torsionnet.signals.decimation import decimated
from torsionnet.signals.detrending import without_trend
from torsionnet.signals.record_blocks import Recordings, blocks_in_order, stacked
from torsionnet.signals.recording import FloatArray, Recording
from torsionnet.signals.spectral_matrix import ComplexArray, CrossSpectra
from torsionnet.signals.welch import Welch, effective_averages

VALUES_PER_BATCH = 1_000_000
"""Number of values in segments that are Fourier transformed together, which limits the memory."""


def cross_spectra(
    recordings: Recordings, settings: Welch | None = None, names: Iterable[str] | None = None
) -> CrossSpectra:
    """Auto and cross spectral densities averaged over the segments of one or more recordings, (n_f, n, n).

    Parameters
    ----------
    recordings : Recording or iterable of Recording
        Blocks of a long record that follow on each other are read as one; others are averaged as repeated tests.
        Only one block at a time is kept in memory.
    settings : Welch, optional
    names : iterable of str, optional
        Signals wanted; all by default.

    Raises
    ------
    UsageError
        No recording is long enough for one segment, or a recording cannot be processed.

    Examples
    --------
    >>> from torsionnet.signals.recording import Signal
    >>> noise = np.random.default_rng(1).normal(size=10_000)
    >>> record = Recording((Signal("T", "torque", noise),), sampling_rate=100)
    >>> spectra = cross_spectra(record)
    >>> spectra.averages, round(float(spectra.matrix.real.mean()), 3)
    (246, 0.02)
    """
    settings = settings or Welch()
    blocks = _selected(recordings, names)
    total = _Total(settings)
    for block, follows in blocks_in_order(decimated(blocks, settings.decimation)):
        total.add(block, follows)
    return total.mean()


def _selected(recordings: Recordings, names: Iterable[str] | None) -> Iterator[Recording]:
    wanted = None if names is None else tuple(dict.fromkeys(names))
    for block in [recordings] if isinstance(recordings, Recording) else recordings:
        yield block if wanted is None else block.select(wanted)


class _Total:
    """Sum of the cross spectra of segments so far, with the samples left over for the next block."""

    def __init__(self, settings: Welch) -> None:
        self.settings = settings
        self.first: Recording | None = None
        self.runs: list[int] = []
        self.sum: ComplexArray = np.zeros(0, dtype=complex)
        self.weights: FloatArray = np.zeros(0)
        self.waiting: FloatArray = np.zeros(0)
        self.samples = 0

    def add(self, block: Recording, follows: bool) -> None:
        self.first = self.first or block
        values = stacked(block)
        self.samples += values.shape[1]
        if follows:
            values = np.concatenate([self.waiting, values], axis=1)
        else:
            self.runs.append(0)
        self.waiting = values
        if values.shape[1] >= self.settings.samples(block.sampling_rate):
            if not len(self.weights):
                self._begin(block)
            self._add_segments(values)

    def _begin(self, block: Recording) -> None:
        """Create window and sums for the first block that is long enough for a segment."""
        self.weights = self.settings.weights(block.sampling_rate)
        self.step = self.settings.step(block.sampling_rate)
        count, size = len(self.weights) // 2 + 1, len(block.signals)
        self.sum = np.zeros((count, size, size), dtype=complex)

    def _add_segments(self, values: FloatArray) -> None:
        length = len(self.weights)
        segments = np.lib.stride_tricks.sliding_window_view(values, length, axis=1)[:, :: self.step]
        count, batch = segments.shape[1], max(1, VALUES_PER_BATCH // (length * len(values)))
        for begin in range(0, count, batch):
            plain = without_trend(segments[:, begin : begin + batch], self.settings.detrend)
            lines = np.fft.rfft(plain * self.weights, axis=-1).transpose(2, 0, 1)
            self.sum += lines.conj() @ lines.transpose(0, 2, 1)
        self.runs[-1] += count
        self.waiting = values[:, count * self.step :]

    def mean(self) -> CrossSpectra:
        count = sum(self.runs)
        if self.first is None or count == 0:
            have = self.samples / self.first.sampling_rate if self.first else 0
            text = f"the record of {have:g} s is too short for one window of {self.settings.seconds:g} s"
            raise UsageError(f"{text}; take shorter windows (seconds)")
        rate, length = self.first.sampling_rate, len(self.weights)
        scale = np.full(len(self.sum), 2 / (rate * (self.weights @ self.weights) * count))
        scale[0] /= 2
        if length % 2 == 0:
            scale[-1] /= 2
        kept = slice(0 if self.settings.detrend == "none" else 1, None)
        return CrossSpectra(
            frequencies=np.asarray(np.fft.rfftfreq(length, 1 / rate)[kept], dtype=np.float64),
            matrix=(self.sum * scale[:, None, None])[kept],
            channels=tuple(Channel(one.name, one.unit, one.course(rate)) for one in self.first),
            averages=count,
            effective_averages=sum(effective_averages(self.weights, self.step, run) for run in self.runs if run),
            settings=self.settings,
            sampling_rate=rate,
            title=self.first.title,
            notes=self.first.notes,
        )
