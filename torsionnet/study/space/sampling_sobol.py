"""Points of a scrambled Sobol sequence by index."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.frequency_response import FloatArray

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
        table, directions = _table(self.dimension, self.bits, self.seed)
        found = np.empty((stop - start, self.dimension), dtype=np.uint32)
        for block in range(start >> LOW_BITS, -(-stop >> LOW_BITS)):
            begin, end = max(start, block << LOW_BITS), min(stop, (block + 1) << LOW_BITS)
            rest = _sums(np.array([block << LOW_BITS], dtype=np.uint32), directions)
            found[begin - start : end - start] = table[begin - (block << LOW_BITS) : end - (block << LOW_BITS)] ^ rest
        # Half a step keeps the points above 0, which no unbounded distribution could take.
        return np.asarray((found + 0.5) * 2.0**-COORDINATE_BITS)


def _sums(indices: SobolWords, directions: SobolWords) -> SobolWords:
    """Sums modulo 2 (m, n) of the direction numbers (bits, n) over the Gray codes of indices (m,)."""
    gray = indices ^ (indices >> np.uint32(1))
    found = np.zeros((len(indices), directions.shape[1]), dtype=np.uint32)
    for bit, numbers in enumerate(directions):
        found[(gray >> np.uint32(bit)) & np.uint32(1) == 1] ^= numbers
    return found


@lru_cache(maxsize=8)
def _table(dimension: int, bits: int, seed: int) -> tuple[SobolWords, SobolWords]:
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
