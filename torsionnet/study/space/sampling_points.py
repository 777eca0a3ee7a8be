"""Random and Latin hypercube points of the unit cube by index."""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import sha256
from math import isqrt
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.frequency_response import FloatArray

HashWords = NDArray[np.uint64]
FEISTEL_ROUNDS = 4
"""Rounds of the Feistel network that permutes draws, as with fewer, orders look less random."""
MOST_SORTED = 4096
"""Most numbers that are permuted by sorting, as of few numbers a Feistel network gives too few permutations."""


def permuted(places: NDArray[np.int64], count: int, seed: np.random.SeedSequence) -> NDArray[np.int64]:
    """Numbers (n,) at some places (n,) of a random permutation of 0 to ``count - 1``.

    A Feistel network of two digits orders a square of slightly more numbers; where it leads beyond ``count`` it is
    followed on until it does not, which keeps every number once (Black and Rogaway, 2002).

    Parameters
    ----------
    places : (n,) array
    count : int
        At most 2^62.
    seed : SeedSequence
        Seed of the permutation.

    Examples
    --------
    >>> order = permuted(np.arange(5), 5, np.random.SeedSequence(1))
    >>> sorted(order.tolist())
    [0, 1, 2, 3, 4]
    """
    if count <= MOST_SORTED:
        return np.argsort(np.random.PCG64(seed).random_raw(count), kind="stable")[places]
    side = np.uint64(isqrt(count - 1) + 1)
    keys = np.asarray(seed.generate_state(2 * FEISTEL_ROUNDS, np.uint64), dtype=np.uint64)
    found = _shuffled(places.astype(np.uint64), side, keys)
    outside = np.flatnonzero(found >= count)
    while len(outside):
        found[outside] = _shuffled(found[outside], side, keys)
        outside = outside[found[outside] >= count]
    return found.astype(np.int64)


def _shuffled(numbers: HashWords, side: np.uint64, keys: HashWords) -> HashWords:
    first, second = numbers // side, numbers % side
    for key in keys.reshape(-1, 2):
        first = (first + _mixed(second, key[0]) % side) % side
        second = (second + _mixed(first, key[1]) % side) % side
    return np.asarray(first * side + second)


def _mixed(numbers: HashWords, key: np.uint64) -> HashWords:
    """Hash (n,) of numbers (n,) with a key (the finaliser of SplitMix64)."""
    z = numbers * np.uint64(0x9E3779B97F4A7C15) + key
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return np.asarray(z ^ (z >> np.uint64(31)))


SEED_BLOCK = 4096
"""Points from one state of the random generator, in blocks, so that a point depends on its index alone."""


class UnitPoints(Protocol):
    """Sequence of points of the unit cube, any stretch of which depends on the indices alone."""

    def __call__(self, start: int, stop: int) -> FloatArray:
        """Points (stop - start, n_names) of the unit cube with the indices ``start`` to ``stop - 1``."""
        ...


@dataclass(frozen=True)
class RandomPoints:
    """Independent random points of the unit cube by index.

    Every name has its own numbers, which stay the same when another name is added.
    """

    names: tuple[str, ...]
    seed: int

    def __call__(self, start: int, stop: int) -> FloatArray:
        found = np.empty((stop - start, len(self.names)))
        for column, name in enumerate(self.names):
            for block in range(start // SEED_BLOCK, -(-stop // SEED_BLOCK)):
                begin, end = max(start, block * SEED_BLOCK), min(stop, (block + 1) * SEED_BLOCK)
                numbers = _uniform(_seed(name, self.seed, block), end - block * SEED_BLOCK)
                found[begin - start : end - start, column] = numbers[begin - block * SEED_BLOCK :]
        return found


def _seed(name: str, *further: int) -> np.random.SeedSequence:
    words = np.frombuffer(sha256(name.encode()).digest(), dtype="<u4")
    return np.random.SeedSequence(words.tolist(), spawn_key=further)


def _uniform(seed: np.random.SeedSequence, count: int) -> FloatArray:
    """Random numbers (count,) above 0 and below 1 from raw bits, which are the same in every version of numpy."""
    raw = np.random.PCG64(seed).random_raw(count) >> np.uint64(12)
    return np.asarray((raw.astype(float) + 0.5) * 2.0**-52)


@dataclass(frozen=True)
class LatinHypercubePoints:
    """Latin hypercube of ``count`` points by index, one in each of ``count`` equal parts of every coordinate."""

    names: tuple[str, ...]
    count: int
    seed: int

    def __call__(self, start: int, stop: int) -> FloatArray:
        places = np.arange(start, stop)
        within = RandomPoints(self.names, self.seed)(start, stop)
        for column, name in enumerate(self.names):
            within[:, column] += permuted(places, self.count, _seed(name, self.seed))
        return np.minimum(within / self.count, 1 - 2.0**-53)
