"""Recordings in blocks, which are parts of a long record or repeated tests."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TypeAlias

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.signals.recording import FloatArray, Recording

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
        raise UsageError("sampling is not uniform: the recording has time stamps; resample it first")
    for signal in block:
        missing = int(np.count_nonzero(~np.isfinite(signal.values)))
        if missing:
            raise UsageError(f"{signal.name} has {missing} values that are not finite; repair or leave them out first")


def _check_alike(block: Recording, names: tuple[str, ...], rate: float) -> None:
    if block.names != names:
        raise UsageError(
            f"blocks of one test must have the same signals: {', '.join(names)}; then {', '.join(block.names)}"
        )
    if block.sampling_rate != rate:
        raise UsageError(
            f"blocks of one test must have the same sampling rate: {rate:g} Hz, then {block.sampling_rate:g} Hz"
        )
