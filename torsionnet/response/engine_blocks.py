"""Lines of engines between which no angle is known: which keep their phases, and whose angle is to be sought."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from torsionnet.response.order_line import OrderLine

PER_PERIOD = 8
"""Points for each period of the highest order on the grid of a search."""
MOST_POINTS = 2000
"""Of a grid; where it would have more, lines that do not repeat with the engines are left out of the search."""


@dataclass(frozen=True)
class EngineBlock:
    """Places of the lines whose phases to each other are known, and the first engine among them."""

    engine: str
    places: tuple[int, ...]


def engine_blocks(lines: Sequence[OrderLine]) -> list[EngineBlock]:
    """All lines as one, or apart those of engines not fixed to each other; what is no engine goes with the first.

    Examples
    --------
    >>> lines = [OrderLine("screw", 4, Fraction(1, 3)), OrderLine("port", 1, Fraction(1), engine="port"),
    ...     OrderLine("starboard", 1, Fraction(1), engine="starboard")]
    >>> engine_blocks(lines)
    [EngineBlock(engine='port', places=(0, 1)), EngineBlock(engine='starboard', places=(2,))]
    """
    engines = list(dict.fromkeys(line.engine for line in lines if line.engine)) or [""]
    homes = [line.engine or engines[0] for line in lines]
    return [EngineBlock(one, tuple(at for at, home in enumerate(homes) if home == one)) for one in engines]


def equally_fast(lines: Sequence[OrderLine]) -> list[list[EngineBlock]]:
    """The blocks, those of engines of one speed together: between these an angle makes the most of a sum."""
    found: list[tuple[set[Fraction], list[EngineBlock]]] = []
    for block in engine_blocks(lines):
        ratios = {lines[place].ratio for place in block.places if lines[place].engine == block.engine}
        home = next((blocks for others, blocks in found if others & ratios), None)
        if home is None:
            found.append((ratios, [block]))
        else:
            home.append(block)
    return [blocks for _, blocks in found]


def is_unsettled(lines: Sequence[OrderLine]) -> bool:
    """Whether engines of one speed are at an angle that is to be sought."""
    return any(len(blocks) > 1 for blocks in equally_fast(lines))


@dataclass(frozen=True)
class BlockGrid:
    """Even steps along the cycle of some blocks.

    Attributes
    ----------
    places : tuple of tuple of int
        By block, the lines that count in the search.
    periods : tuple of int
        By block, the steps after which it repeats.
    points : int
        Steps after which all of them repeat.
    cycle : Fraction
        Revolutions of the reference shaft that these are.
    """

    places: tuple[tuple[int, ...], ...]
    periods: tuple[int, ...]
    points: int
    cycle: Fraction

    @classmethod
    def of(cls, lines: Sequence[OrderLine], blocks: Sequence[EngineBlock]) -> BlockGrid:
        """All lines that follow the speed, or those alone that repeat within two revolutions of the engines."""
        moving = [tuple(at for at in block.places if not lines[at].fixed and lines[at].order) for block in blocks]
        found = cls._through(lines, moving)
        if found.points <= MOST_POINTS:
            return found
        half = min(lines[at].ratio for at in moving[-1]) / 2
        own = [tuple(at for at in places if (lines[at].relative / half).denominator == 1) for places in moving]
        return cls._through(lines, own)

    @classmethod
    def _through(cls, lines: Sequence[OrderLine], moving: Sequence[tuple[int, ...]]) -> BlockGrid:
        slowest = [common_factor(lines[at].relative for at in places) for places in moving]
        whole = common_factor(slowest)
        repeats = [max(1, int(one / whole)) for one in slowest]
        step = math.lcm(*repeats)
        highest = max(lines[at].relative for places in moving for at in places)
        points = math.ceil(PER_PERIOD * highest / whole / step) * step
        return cls(tuple(moving), tuple(points // count for count in repeats), points, 1 / whole)


def common_factor(relatives: Iterable[Fraction]) -> Fraction:
    """The largest number of which all are multiples; 0 of none."""
    found = Fraction(0)
    for one in relatives:
        a, b = found, one
        found = Fraction(
            math.gcd(a.numerator * b.denominator, b.numerator * a.denominator), a.denominator * b.denominator
        )
    return found
