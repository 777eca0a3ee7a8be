"""Search of a signal for blocks of samples that repeat earlier ones exactly, such as a buffer recorded twice."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.signals.recording import FloatArray
from torsionnet.signals.standstill import is_rough

LEAST_TIME, LEAST_SAMPLES = 0.15, 24
"""Least length of a repeated block in s and in samples, as shorter ones may recur by chance."""
FEWEST_CHANGES, FEWEST_LEVELS = 20, 5
"""Fewest changes and fewest different values in a repeated block, as fewer recur by chance."""
SURPLUS_BITS = 20.0
"""Bits of information that a repeated block must hold beyond those of two positions in the record, so that chance makes
one in about a million."""
MOST_REPEATED_SHARE = 0.2
"""Largest share of a record that may be repeated blocks, as more is a periodic signal or a test that was run twice."""
MOST_PERIODS = 3
"""Length of a repeated block over its distance to the original above which it is a periodic signal, not a copy."""
MOST_EQUAL_NEIGHBOURS = 0.5
"""Largest share of samples beside a repeated block that recur at the same distance, as more do in a nearly periodic
signal."""
NOISE_REVERSALS = 0.1
"""Share of sign changes between the steps of a quantised signal above which it holds noise, as smooth motion has
fewer."""
KINK_RATIO = 5.0
"""Second difference at an end of a repeated block, over the largest within it, above which that end is a kink, as where
a buffer was copied in."""
_BASE, _MIX = 0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9
"""Odd 64-bit multipliers of the rolling hash of samples (constants of the splitmix64 generator, which mix bits
well)."""
_TABLE_BITS = 20
"""Number of bits of a hash that index the table for quick rejection, whose 2^20 entries fit in the cache."""

WholeArray = NDArray[np.uint64]


@dataclass(frozen=True)
class RepeatedBlock:
    """Block of ``count`` samples that begins at index ``first`` and equals those from index ``source`` on."""

    source: int
    first: int
    count: int


def repeated_blocks(values: FloatArray, sampling_rate: float, step: float = 0.0) -> list[RepeatedBlock]:
    """Blocks of a signal of 0.15 s or longer that are exact copies of earlier ones, in order of time.

    Periodic signals, signals at rest, and computed signals without noise that are smooth at both ends of the copy have
    none.

    Parameters
    ----------
    values : (n,) array
        Samples, all finite.
    sampling_rate : float
        Hz.
    step : float, optional
        Step of the sensor in the unit of the values; 0 if it has none.

    Examples
    --------
    >>> values = np.random.default_rng(1).normal(size=5000)
    >>> values[3000:3200] = values[1000:1200]
    >>> repeated_blocks(values, 1000.0)
    [RepeatedBlock(source=1000, first=3000, count=200)]
    """
    least = max(LEAST_SAMPLES, int(np.ceil(LEAST_TIME * sampling_rate - 1e-9)))
    if len(values) < 3 * least:
        return []
    plain = np.ascontiguousarray(values, dtype=np.float64) + 0.0  # -0.0 becomes 0.0
    found = [
        block
        for block in _maximal(plain, least // 2)
        if block.count >= least and least <= block.first - block.source and _tells_enough(plain, block)
    ]
    if sum(block.count for block in found) > MOST_REPEATED_SHARE * len(plain):
        return []
    chosen: list[RepeatedBlock] = []
    for block in sorted(found, key=lambda block: (block.first, block.source)):
        is_new = not chosen or block.first >= chosen[-1].first + chosen[-1].count
        if is_new and _is_single(plain, block, least) and _is_measured(plain, block, step):
            chosen.append(block)
    return chosen


def _maximal(values: FloatArray, width: int) -> Iterator[RepeatedBlock]:
    """Yield the longest pairs of equal stretches that contain a window starting at a multiple of its width."""
    changes = np.concatenate([[0], np.cumsum(values[1:] != values[:-1])])
    moves = changes[width - 1 :] - changes[: len(changes) - width + 1] >= FEWEST_CHANGES // 2
    prints = _fingerprints(values, width)
    anchors = np.arange(0, len(prints), width)
    anchors = anchors[moves[anchors]]
    table, places = np.zeros(1 << _TABLE_BITS, dtype=bool), prints >> np.uint64(64 - _TABLE_BITS)
    table[places[anchors]] = True
    seen = np.flatnonzero(table[places] & moves)
    anchors = anchors[np.argsort(prints[anchors], kind="stable")]
    if not len(anchors):
        return
    at = np.minimum(np.searchsorted(prints[anchors], prints[seen]), len(anchors) - 1)
    alike = (prints[anchors[at]] == prints[seen]) & (anchors[at] != seen)
    pairs = np.sort(np.stack([anchors[at][alike], seen[alike]]), axis=0)
    if pairs.shape[1] * width > 2 * MOST_REPEATED_SHARE * np.count_nonzero(moves) + width:
        return
    lags = pairs[1] - pairs[0]
    reached: dict[int, int] = {}
    for number in np.lexsort((pairs[0], lags)):
        source, lag = int(pairs[0, number]), int(lags[number])
        if source >= reached.get(lag, 0):
            begin = source - _equal(values[:source][::-1], values[: source + lag][::-1])
            end = source + _equal(values[source:], values[source + lag :])
            reached[lag] = end
            if end - begin >= width:
                yield RepeatedBlock(begin, begin + lag, end - begin)


def _fingerprints(values: FloatArray, width: int) -> WholeArray:
    """Hash of every window of ``width`` samples, equal for equal windows, (n - width + 1,)."""
    bits = values.view(np.uint64)
    mixed = (bits ^ (bits >> np.uint64(29))) * np.uint64(_MIX)
    mixed ^= mixed >> np.uint64(32)
    sums = np.concatenate([np.zeros(1, np.uint64), np.cumsum(mixed * _powers(_BASE, len(mixed)), dtype=np.uint64)])
    inverse = pow(_BASE, -1, 1 << 64)
    hashed = (sums[width:] - sums[:-width]) * _powers(inverse, len(sums) - width)
    hashed ^= hashed >> np.uint64(31)
    return np.asarray(hashed * np.uint64(_MIX))


def _powers(base: int, count: int) -> WholeArray:
    """Powers 0 to count - 1 of a base modulo 2^64, shape (count,)."""
    factors = np.full(count, base, dtype=np.uint64)
    factors[0] = 1
    return np.cumprod(factors, dtype=np.uint64)


def _equal(one: FloatArray, other: FloatArray) -> int:
    """Number of equal samples at the beginning of two arrays, up to the first that differs."""
    most, begin, size = min(len(one), len(other)), 0, 256
    while begin < most:
        unlike = np.flatnonzero(one[begin : min(begin + size, most)] != other[begin : min(begin + size, most)])
        if len(unlike):
            return begin + int(unlike[0])
        begin, size = begin + size, 2 * size
    return most


def _tells_enough(values: FloatArray, block: RepeatedBlock) -> bool:
    """Whether a repeated block holds so much information that it can hardly recur by chance."""
    stretch = values[block.first : block.first + block.count]
    steps = np.diff(stretch)
    if np.count_nonzero(steps) < FEWEST_CHANGES or len(np.unique(stretch)) < FEWEST_LEVELS:
        return False
    shares = np.unique(steps, return_counts=True)[1] / len(steps)
    information = -float(np.sum(shares * np.log2(shares))) * len(steps)
    return bool(information > 2 * np.log2(len(values)) + SURPLUS_BITS)


def _is_single(values: FloatArray, block: RepeatedBlock, width: int) -> bool:
    """Whether a repeated block is a single copy, with neither itself nor its surroundings periodic."""
    lag, end = block.first - block.source, block.first + block.count
    if block.count > MOST_PERIODS * lag:
        return False
    before = slice(max(lag, block.first - width), block.first)
    after = slice(end, min(end + width, len(values)))
    shares = [
        np.mean(values[side] == values[side.start - lag : side.stop - lag])
        for side in (before, after)
        if side.stop > side.start
    ]
    return bool(shares) and max(shares) < MOST_EQUAL_NEIGHBOURS


def _is_measured(values: FloatArray, block: RepeatedBlock, step: float) -> bool:
    """Whether a repeated block was measured, seen by noise in it (which never recurs) or a kink at an end.

    A block that directly follows its source is smooth at its end in any case, and at its start if it is a period.
    """
    end = block.first + block.count
    stretch = values[block.first : end]
    usual = float(np.abs(np.diff(stretch, 2)).max())
    for seam in (block.first, *([end] if block.first > block.source + block.count else [])):
        around = values[seam - 2 : seam + 2]
        if 2 <= seam <= len(values) - 2 and float(np.abs(np.diff(around, 2)).max()) > KINK_RATIO * usual:
            return True
    if not step:
        return is_rough((stretch, stretch))
    moved = np.diff(stretch)
    signs = np.sign(moved[moved != 0])
    return float(np.mean(signs[1:] != signs[:-1])) > NOISE_REVERSALS
