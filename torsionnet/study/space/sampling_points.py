"""Points of the unit cube by index: random and Latin hypercube."""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import sha256
from typing import Protocol

import numpy as np

from torsionnet.response.frequency_response import FloatArray
from torsionnet.study.space.keyed_permutation import permuted

BLOCK = 4096
"""Points that one state of the generator gives; whatever is asked for, blocks begin at its multiples."""


class UnitPoints(Protocol):
    """Any stretch of a sequence of points, which depends on nothing but the indices."""

    def __call__(self, start: int, stop: int) -> FloatArray:
        """Points ``start`` to ``stop - 1``, (stop - start, n_names), above 0 and below 1."""
        ...


@dataclass(frozen=True)
class RandomPoints:
    """Independent points.

    Every name has numbers of its own: those of the others stay when one is added.
    """

    names: tuple[str, ...]
    seed: int

    def __call__(self, start: int, stop: int) -> FloatArray:
        found = np.empty((stop - start, len(self.names)))
        for column, name in enumerate(self.names):
            for block in range(start // BLOCK, -(-stop // BLOCK)):
                begin, end = max(start, block * BLOCK), min(stop, (block + 1) * BLOCK)
                numbers = _uniform(_seed(name, self.seed, block), end - block * BLOCK)
                found[begin - start : end - start, column] = numbers[begin - block * BLOCK :]
        return found


def _seed(name: str, *further: int) -> np.random.SeedSequence:
    words = np.frombuffer(sha256(name.encode()).digest(), dtype="<u4")
    return np.random.SeedSequence(words.tolist(), spawn_key=further)


def _uniform(seed: np.random.SeedSequence, count: int) -> FloatArray:
    """Numbers above 0 and below 1, from raw bits, which are the same in every version of numpy."""
    raw = np.random.PCG64(seed).random_raw(count) >> np.uint64(12)
    return np.asarray((raw.astype(float) + 0.5) * 2.0**-52)


@dataclass(frozen=True)
class LatinHypercubePoints:
    """``count`` points of which one lies in each of ``count`` equal parts of every coordinate."""

    names: tuple[str, ...]
    count: int
    seed: int

    def __call__(self, start: int, stop: int) -> FloatArray:
        places = np.arange(start, stop)
        within = RandomPoints(self.names, self.seed)(start, stop)
        for column, name in enumerate(self.names):
            within[:, column] += permuted(places, self.count, _seed(name, self.seed))
        return np.minimum(within / self.count, 1 - 2.0**-53)
