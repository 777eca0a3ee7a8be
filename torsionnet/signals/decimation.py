"""Decimation of recordings, by an anti-alias filter from which every n-th sample is taken."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.signals.recording import FloatArray, Recording

# Recordings in blocks, which are parts of a long record or repeated tests.

Recordings: TypeAlias = Recording | Iterable[Recording]


def blocks_in_order(recordings: Recordings) -> Iterator[tuple[Recording, bool]]:
    """Yield the blocks of recordings in order, each with a flag whether it begins where the one before ended.

    A block that does not is a separate test: nothing is averaged or filtered across the gap.

    Raises
    ------
    UsageError
        The blocks differ in signals or sampling rate, or one cannot be processed: its sampling is not uniform, or
        values are not finite.
    """
    end: float | None = None
    kinds: tuple[tuple[str, ...], float] | None = None  # not the first block, which would stay in memory
    for block in [recordings] if isinstance(recordings, Recording) else recordings:
        kinds = kinds or (block.names, block.sampling_rate)
        _check_alike(block, *kinds)
        check_processable(block)
        half_a_sample = 0.5 / block.sampling_rate
        yield block, end is not None and abs(block.start - end) < half_a_sample
        end = block.start + block.duration


def stacked(recording: Recording) -> FloatArray:
    """Values of all signals of a recording as one array, shape (n_signals, n), each in its unit."""
    return np.array([signal.values for signal in recording], dtype=np.float64)


def check_processable(block: Recording) -> None:
    """Raise an error for a recording with non-uniform time stamps, or with values that are not finite."""
    if block.times is not None:
        raise UsageError(
            "sampling is not uniform: the recording has time stamps; resample it first", kind="uneven-samples"
        )
    for signal in block:
        missing = int(np.count_nonzero(~np.isfinite(signal.values)))
        if missing:
            raise UsageError(
                f"{signal.name} has {missing} values that are not finite; repair or leave them out first",
                kind="not-finite",
            )


def _check_alike(block: Recording, names: tuple[str, ...], rate: float) -> None:
    if block.names != names:
        raise UsageError(
            f"blocks of one test must have the same signals: {', '.join(names)}; then {', '.join(block.names)}",
            kind="unlike-results",
        )
    if block.sampling_rate != rate:
        raise UsageError(
            f"blocks of one test must have the same sampling rate: {rate:g} Hz, then {block.sampling_rate:g} Hz",
            kind="unlike-results",
        )


FILTER_HALF_LENGTH = 10
"""Half length of the anti-alias filter in samples after decimation, as a longer one has a steeper edge but reaches
further into the ends."""
VALID_SHARE = 0.8
"""Share of half the new sampling rate up to which a decimated signal is valid, as aliases below it come from the
filter's stop band."""
UNDECIMATED_RATE, LEAST_DECIMATED_RATE = 1000.0, 200.0
"""Sampling rate in Hz up to which records are not decimated, and the least rate in Hz of faster ones after decimation,
that of the source paper."""


def decimate(recording: Recording, factor: int) -> Recording:
    """Recording with every n-th sample behind a linear-phase anti-alias filter without delay.

    The filter is a windowed sinc (Hamming) of ``20 factor + 1`` taps, 6 dB down at the new half rate. Beyond its
    ends the record is reflected about its end points, so a mean or a slope makes no step there. The notes say up to
    which frequency the result is valid.

    Examples
    --------
    >>> from torsionnet.signals.recording import Signal
    >>> record = Recording((Signal("T", "torque", np.ones(20_000)),), sampling_rate=10e3)
    >>> short = decimate(record, 50)
    >>> len(short), short.sampling_rate
    (400, 200.0)
    """
    parts = list(decimated(recording, factor))
    joined = np.concatenate([stacked(part) for part in parts], axis=1)
    return _with_values(parts[0], joined)


def decimated(recordings: Recordings, factor: int) -> Iterator[Recording]:
    """Yield the blocks of recordings decimated by a whole factor, in bounded memory, without seams between them."""
    if factor < 1 or int(factor) != factor:
        raise UsageError(f"the decimation factor must be a whole number from 1, got {factor}", kind="out-of-range")
    if factor == 1:
        yield from [recordings] if isinstance(recordings, Recording) else recordings
        return
    stream: _Stream | None = None
    for block, follows in blocks_in_order(recordings):
        if stream is None or not follows:
            yield from stream.rest() if stream else ()
            stream = _Stream(block, factor)
        yield from stream.push(stacked(block))
    yield from stream.rest() if stream else ()


def usable_up_to(sampling_rate: float, factor: int) -> float:
    """Highest frequency in Hz at which a signal decimated from ``sampling_rate`` (Hz) is valid.

    >>> usable_up_to(10e3, 50)
    80.0
    """
    return VALID_SHARE * sampling_rate / factor / 2


def factor_for(sampling_rate: float, highest: float = 0.0) -> int:
    """Default decimation factor of a record that has to be valid up to ``highest`` Hz.

    Records up to 1 kHz stay as they are; faster ones keep 200 Hz or more, and what ``highest`` needs.

    >>> factor_for(10e3), factor_for(5e3, highest=40), factor_for(5e3, highest=150), factor_for(500, highest=10)
    (50, 25, 13, 1)
    """
    if sampling_rate <= UNDECIMATED_RATE:
        return 1
    return max(1, int(sampling_rate / max(LEAST_DECIMATED_RATE, 2 * highest / VALID_SHARE) + 1e-9))


def anti_alias_taps(factor: int) -> FloatArray:
    """Coefficients of the anti-alias filter at the sampling rate before decimation, (20 factor + 1,)."""
    from scipy.signal import firwin

    return np.asarray(firwin(2 * FILTER_HALF_LENGTH * factor + 1, 1 / factor, window="hamming"), dtype=np.float64)


class _Stream:
    """Decimation filter of one test that keeps its state between blocks."""

    def __init__(self, first: Recording, factor: int) -> None:
        self.first, self.factor, self.half = first, factor, FILTER_HALF_LENGTH * factor
        self.taps: FloatArray | None = None
        self.pending = np.empty((len(first.signals), 0))
        self.primed = False
        self.done = 0

    def push(self, values: FloatArray) -> Iterator[Recording]:
        self.pending = np.concatenate([self.pending, values], axis=1)
        if not self.primed:
            if self.pending.shape[1] <= self.half:
                return
            # Reflected oddly about the first sample, so that value and slope go on beyond it.
            head = 2 * self.pending[:, :1] - self.pending[:, self.half : 0 : -1]
            self.pending = np.concatenate([head, self.pending], axis=1)
            self.primed = True
        yield from self._filtered()

    def rest(self) -> Iterator[Recording]:
        if not self.primed:
            need = self.half + 1
            raise UsageError(
                f"{self.pending.shape[1]} samples are too few to decimate by {self.factor}; it takes {need}",
                kind="too-short",
            )
        tail = 2 * self.pending[:, -1:] - self.pending[:, -2 : -self.half - 2 : -1]
        self.pending = np.concatenate([self.pending, tail], axis=1)
        yield from self._filtered()

    def _filtered(self) -> Iterator[Recording]:
        from scipy.signal import upfirdn

        count = (self.pending.shape[1] - 2 * self.half - 1) // self.factor + 1
        if count <= 0:
            return
        if self.taps is None:  # not before there are samples for as many
            self.taps = anti_alias_taps(self.factor)
        filtered = np.asarray(upfirdn(self.taps, self.pending, 1, self.factor, axis=1), dtype=np.float64)
        values = filtered[:, 2 * FILTER_HALF_LENGTH : 2 * FILTER_HALF_LENGTH + count]
        self.pending = self.pending[:, count * self.factor :]
        start = self.first.start + self.done * self.factor / self.first.sampling_rate
        self.done += count
        rate, signals = self.first.sampling_rate / self.factor, self.first.signals
        signals = tuple(signal.at_other_rate(signal.values, self.first.sampling_rate) for signal in signals)
        template = replace(self.first, signals=signals, sampling_rate=rate, start=start)
        yield _with_values(template, values).with_notes(self._note())

    def _note(self) -> str:
        rate = self.first.sampling_rate
        limit, new = usable_up_to(rate, self.factor), rate / self.factor
        return (
            f"decimated by {self.factor} to {new:g} Hz behind a linear-phase filter; holds up to {limit:g} Hz, onto "
            f"which what was above {new - limit:g} Hz folds at least 50 dB weaker; filter ends reach "
            f"{self.half / rate:g} s into the record"
        )


def _with_values(recording: Recording, values: FloatArray) -> Recording:
    signals = (replace(signal, values=row) for signal, row in zip(recording, values, strict=True))
    return replace(recording, signals=tuple(signals))
