"""Part of a record that holds a free decay, from the end of its excitation to the noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.base.notes import NoteOrText
from torsionnet.modal.spectral_lines import FloatArray

BLOCKS = 100
"""Blocks into which a record is divided to find where its vibration is largest."""
LIVELY = 0.6
"""Standard deviation of a block over the largest from which the decay can begin in it: those of half cycles differ."""
FLOOR_OVER_NOISE = 3.0
"""Standard deviation of a block over that of the noise at the end, down to which the decay is read."""
SMALLEST_SHARE = 1e-3
"""Standard deviation of a block over the largest, down to which a decay without noise is read."""
HIGHEST_SHARE = 0.01
"""Share of the power of a decay above the highest frequency that is kept: its sudden start spreads some percents."""
FILTER_REACH = 10
"""Samples at either end of a thinned signal that its anti-alias filter spoils: twice ten samples is its length."""
SAMPLES_PER_CYCLE, MOST_SAMPLES = 8, 1200
"""Samples per cycle of the highest frequency that are kept, and samples that the matrix pencil can take."""


@dataclass(frozen=True, eq=False)
class DecaySection:
    """Samples of a free decay in SI units at even times in s, and remarks on how they were chosen."""

    times: FloatArray
    values: FloatArray
    notes: tuple[NoteOrText, ...]


def decay_section(
    times: FloatArray, values: FloatArray, start: float | None, end: float | None, highest: float | None
) -> DecaySection:
    """Part of a signal in which it decays freely, with no more samples than its highest frequency (Hz) needs.

    Raises
    ------
    UsageError
        Start and end are not in the record.
    SolveError
        Hardly anything is left.
    """
    for name, at in (("start", start), ("end", end)):
        if at is not None and not times[0] <= at <= times[-1]:
            raise UsageError(f"the {name} at {at:g} s is outside the record from {times[0]:g} to {times[-1]:g} s")
    notes = []
    first, last = _limits(values)
    if start is not None:
        first = int(np.searchsorted(times, start))
        last = max(last, first)
    else:
        notes.append(f"the decay was found to start at {times[first]:.4g} s")
    if end is not None:
        last = int(np.searchsorted(times, end))
    elif last < len(times) - 1 and last > first:
        notes.append(f"and to end in noise or rest at {times[last]:.4g} s")
    if last - first < 2 * SAMPLES_PER_CYCLE:
        raise SolveError(f"{max(last - first, 0)} samples of decay are too few: give start and end, or record longer")
    part, kept = values[first : last + 1], times[first : last + 1]
    return _thinned(kept, part, highest, tuple(notes))


def _limits(values: FloatArray) -> tuple[int, int]:
    """Index of the largest deflection of the liveliest part, and of the end of the decay behind it."""
    size = max(len(values) // BLOCKS, 4)
    count = len(values) // size
    blocks = values[: count * size].reshape(count, size)
    x = np.arange(size) - (size - 1) / 2
    slopes = blocks @ x / (x @ x)
    straight = blocks - blocks.mean(axis=1, keepdims=True) - slopes[:, None] * x
    lively = straight.std(axis=1)
    top = int(np.flatnonzero(lively > LIVELY * lively.max())[0])
    rest = values[-max(len(values) // 10, 1) :].mean()
    begin = top * size
    first = begin + int(np.abs(values[begin : begin + 2 * size] - rest).argmax())
    spread = np.array([np.std(values[k * size : (k + 4) * size]) for k in range(count)])
    floor = max(float(np.median(spread[-max(count // 10, 1) :])) * FLOOR_OVER_NOISE, SMALLEST_SHARE * spread.max())
    quiet = np.flatnonzero(spread[top + 1 :] < floor)
    last = (top + 1 + int(quiet[0])) * size if len(quiet) else len(values) - 1
    return first, min(last, len(values) - 1)


def _thinned(
    times: FloatArray, values: FloatArray, highest: float | None, notes: tuple[NoteOrText, ...]
) -> DecaySection:
    from scipy.signal import resample_poly

    rate = (len(times) - 1) / (times[-1] - times[0])
    if highest is None:
        padded = (values - values[-max(len(values) // 10, 1) :].mean()) * np.hanning(2 * len(values))[len(values) :]
        power = np.abs(np.fft.rfft(padded)) ** 2
        above = 1 - np.cumsum(power) / power.sum()
        highest = float(np.fft.rfftfreq(len(padded), 1 / rate)[int((above > HIGHEST_SHARE).sum())])
    factor = int(rate / (SAMPLES_PER_CYCLE * max(highest, rate / len(values))))
    if factor > 1:
        line = np.interp(times, times[[0, -1]], values[[0, -1]])
        kept = slice(FILTER_REACH, -FILTER_REACH)
        values, times = (resample_poly(values - line, 1, factor) + line[::factor])[kept], times[::factor][kept]
    if len(times) > MOST_SAMPLES:
        notes = (*notes, f"read up to {times[MOST_SAMPLES - 1]:.4g} s")
        times, values = times[:MOST_SAMPLES], values[:MOST_SAMPLES]
    return DecaySection(times, values, notes)
