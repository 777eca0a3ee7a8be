"""Sampling entry of a study file, the number and method of the random draws."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import isqrt, log2
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.spec import Count, OneOf, entry
from torsionnet.base.errors import Fault
from torsionnet.linear.frequency_response import FloatArray

# Entry of a study file for a whole number that may be large.


class Many(Count):
    """Entry for a whole number within bounds that may be written as 1e6."""

    def coerce(self, raw: object) -> int:
        return super().coerce(int(raw) if isinstance(raw, float) and raw.is_integer() else raw)


# Random and Latin hypercube points of the unit cube by index.

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
    # Numbers of two digits in a base whose square is just as large as the count, or larger.
    side = np.uint64(isqrt(count - 1) + 1)
    keys = np.asarray(seed.generate_state(2 * FEISTEL_ROUNDS, np.uint64), dtype=np.uint64)
    shuffled = _shuffled(places.astype(np.uint64), side, keys)
    outside = np.flatnonzero(shuffled >= count)
    while len(outside):
        shuffled[outside] = _shuffled(shuffled[outside], side, keys)
        outside = outside[shuffled[outside] >= count]
    return shuffled.astype(np.int64)


def _shuffled(numbers: HashWords, side: np.uint64, keys: HashWords) -> HashWords:
    # A round adds a hash of one digit to the other, which can be taken off again: a permutation.
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
        points = np.empty((stop - start, len(self.names)))
        for column, name in enumerate(self.names):
            for block in range(start // SEED_BLOCK, -(-stop // SEED_BLOCK)):
                begin, end = max(start, block * SEED_BLOCK), min(stop, (block + 1) * SEED_BLOCK)
                numbers = _uniform(_seed(name, self.seed, block), end - block * SEED_BLOCK)
                points[begin - start : end - start, column] = numbers[begin - block * SEED_BLOCK :]
        return points


def _seed(name: str, *further: int) -> np.random.SeedSequence:
    from hashlib import sha256

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
            # Each of the strata once, in random order, and a random place within.
            within[:, column] += permuted(places, self.count, _seed(name, self.seed))
        return np.minimum(within / self.count, 1 - 2.0**-53)


# Points of a scrambled Sobol sequence by index.

COORDINATE_BITS = 30
"""Number of bits of every Sobol coordinate, and of the number of points, the default of scipy."""
LOW_BITS = 12
"""Number of low bits of a point's index that one table of 4096 points covers, as a table of more takes longer."""
SobolWords = NDArray[np.uint32]


class SobolPoints:
    """Scrambled Sobol sequence of points by index, that of :class:`scipy.stats.qmc.Sobol`.

    Point i is the sum modulo 2, over the bits set in the Gray code of i, of direction numbers; these are found from
    the points 0, 1, 2, 4, ... so that any stretch costs no more than another.
    """

    def __init__(self, dimension: int, count: int, seed: int) -> None:
        self.dimension, self.bits, self.seed = dimension, max(LOW_BITS, (count - 1).bit_length()), seed

    def __call__(self, start: int, stop: int) -> FloatArray:
        table, directions = _sobol_start(self.dimension, self.bits, self.seed)
        points = np.empty((stop - start, self.dimension), dtype=np.uint32)
        for block in range(start >> LOW_BITS, -(-stop >> LOW_BITS)):
            begin, end = max(start, block << LOW_BITS), min(stop, (block + 1) << LOW_BITS)
            # Gray codes are linear modulo 2: a block differs from the first one by a single sum.
            rest = _sums(np.array([block << LOW_BITS], dtype=np.uint32), directions)
            points[begin - start : end - start] = table[begin - (block << LOW_BITS) : end - (block << LOW_BITS)] ^ rest
        # Half a step keeps the points above 0, which no unbounded distribution could take.
        return np.asarray((points + 0.5) * 2.0**-COORDINATE_BITS)


def _sums(indices: SobolWords, directions: SobolWords) -> SobolWords:
    """Sums modulo 2 (m, n) of the direction numbers (bits, n) over the Gray codes of indices (m,)."""
    gray = indices ^ (indices >> np.uint32(1))
    sums = np.zeros((len(indices), directions.shape[1]), dtype=np.uint32)
    for bit, numbers in enumerate(directions):
        sums[(gray >> np.uint32(bit)) & np.uint32(1) == 1] ^= numbers
    return sums


@lru_cache(maxsize=8)
def _sobol_start(dimension: int, bits: int, seed: int) -> tuple[SobolWords, SobolWords]:
    """First points (2^LOW_BITS, n) of the Sobol sequence and its direction numbers (bits, n)."""
    from scipy.stats.qmc import Sobol

    engine = Sobol(dimension, bits=COORDINATE_BITS, seed=np.random.default_rng(seed))
    first, *corners = (_taken(engine, index) for index in (0, *(2**bit for bit in range(bits))))
    directions = np.empty((bits, dimension), dtype=np.uint32)
    for bit, corner in enumerate(corners):
        # The Gray code of 2^b has the bits b and b - 1.
        directions[bit] = first ^ corner ^ (directions[bit - 1] if bit else np.uint32(0))
    return first ^ _sums(np.arange(1 << LOW_BITS, dtype=np.uint32), directions), directions


def _taken(engine: Any, index: int) -> SobolWords:
    if index > engine.num_generated:
        engine.fast_forward(index - engine.num_generated)
    return np.asarray(np.rint(engine.random(1)[0] * 2.0**COORDINATE_BITS), dtype=np.uint32)


RANDOM, LATIN, SOBOL = "random", "latin_hypercube", "sobol"


@dataclass(frozen=True, kw_only=True)
class Samples(Declared):
    """Number, method and seed of the draws of parameters with a distribution.

    Random draws are independent of each other, which confidence intervals rest on. A Latin hypercube has one draw in
    each of ``count`` equally likely ranges of every parameter; a Sobol sequence fills the space evenly, best where
    ``count`` is a power of two. Of parameters that are correlated only the first has one draw in each of these ranges;
    the others follow it as their correlation says.

    Examples
    --------
    >>> Samples(method="sobol", count=1024).to_data()
    {'method': 'sobol', 'count': 1024}
    """

    kind: ClassVar[str] = "sampling"
    article: ClassVar[str] = "sampling"
    form: ClassVar[str] = "{method: random, count: 10000, seed: 1}"

    method: str = entry(OneOf("how values are drawn", (RANDOM, LATIN, SOBOL)), RANDOM)
    count: int = entry(Many("number of draws", upper=10**15))
    seed: int = entry(Count("another seed draws other values", lower=0, upper=2**32 - 1), 1)

    def contradictions(self) -> list[Fault]:
        if self.method == SOBOL and self.count > 2**COORDINATE_BITS:
            text = f"a Sobol sequence has at most {2**COORDINATE_BITS} points; take method: {RANDOM} or {LATIN}"
            return [Fault(text, ("count",), kind="too-large")]
        return []

    def points(self, names: tuple[str, ...]) -> UnitPoints:
        """Sequence of points in the unit cube with a coordinate for the name of each parameter."""
        if self.method == SOBOL:
            return SobolPoints(len(names), self.count, self.seed)
        if self.method == LATIN:
            return LatinHypercubePoints(names, self.count, self.seed)
        return RandomPoints(names, self.seed)

    def remark(self) -> Fault | None:
        """Warning where a Sobol sequence has not a power of two points, None where it has."""
        if self.method != SOBOL or self.count & (self.count - 1) == 0:
            return None
        near = 2 ** round(log2(self.count))
        return Fault(
            f"a Sobol sequence is even only at powers of two; {near} draws serve better",
            ("count",),
            "warning",
            kind="wrong-count",
        )
