"""Groups of order lines with known phases between them, one for each engine whose angle to others is not given."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from torsionnet.machinery.orders.order_line import OrderLine

GRID_POINTS_PER_PERIOD = 8
"""Number of grid points for each period of the highest order in a search of engine angles."""
MOST_GRID_POINTS = 2000
"""Largest number of points of a grid of engine angles; beyond, lines that do not repeat with the engines are left
out."""


@dataclass(frozen=True)
class EngineBlock:
    """Name of an engine of unknown angle, and the indices of the order lines with known phases to it."""

    engine: str
    places: tuple[int, ...]


def engine_blocks(lines: Sequence[OrderLine]) -> list[EngineBlock]:
    """List of engine blocks (indices of order lines of known phases), one for each engine of unknown angle.

    Lines of other excitations are in the first block.

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


def blocks_by_speed(lines: Sequence[OrderLine]) -> list[list[EngineBlock]]:
    """List of lists of engine blocks (indices of order lines), one inner list for all engines that turn at one speed.

    Within a group an angle changes the sum.
    """
    found: list[tuple[set[Fraction], list[EngineBlock]]] = []
    for block in engine_blocks(lines):
        ratios = {lines[place].ratio for place in block.places if lines[place].engine == block.engine}
        home = next((blocks for others, blocks in found if others & ratios), None)
        if home is None:
            found.append((ratios, [block]))
        else:
            home.append(block)
    return [blocks for _, blocks in found]


def has_unknown_angles(lines: Sequence[OrderLine]) -> bool:
    """Whether engines of one speed are at unknown angles to each other, so that the worst ones have to be searched."""
    return any(len(blocks) > 1 for blocks in blocks_by_speed(lines))


@dataclass(frozen=True)
class BlockGrid:
    """Grid of even angle steps over the common cycle of engines of unknown angle, with their order lines by index.

    Attributes
    ----------
    places : tuple of tuple of int
        By block, indices of the lines that take part in the search.
    periods : tuple of int
        By block, number of steps after which its sum repeats.
    points : int
        Number of steps after which all blocks repeat.
    cycle : Fraction
        Revolutions of the reference shaft in ``points`` steps.
    """

    places: tuple[tuple[int, ...], ...]
    periods: tuple[int, ...]
    points: int
    cycle: Fraction

    @classmethod
    def of(cls, lines: Sequence[OrderLine], blocks: Sequence[EngineBlock]) -> BlockGrid:
        """Grid of engine angles at which the sums of all order lines that follow the speed are compared.

        Where that takes too many points, lines that do not repeat within two revolutions are left out.
        """
        moving = [tuple(at for at in block.places if not lines[at].fixed and lines[at].order) for block in blocks]
        found = cls._through(lines, moving)
        if found.points <= MOST_GRID_POINTS:
            return found
        half = min(lines[at].ratio for at in moving[-1]) / 2
        own = [tuple(at for at in places if (lines[at].relative / half).denominator == 1) for places in moving]
        return cls._through(lines, own)

    @classmethod
    def _through(cls, lines: Sequence[OrderLine], moving: Sequence[tuple[int, ...]]) -> BlockGrid:
        slowest = [greatest_common_divisor(lines[at].relative for at in places) for places in moving]
        whole = greatest_common_divisor(slowest)
        repeats = [max(1, int(one / whole)) for one in slowest]
        step = math.lcm(*repeats)
        highest = max(lines[at].relative for places in moving for at in places)
        points = math.ceil(GRID_POINTS_PER_PERIOD * highest / whole / step) * step
        return cls(tuple(moving), tuple(points // count for count in repeats), points, 1 / whole)


def greatest_common_divisor(relatives: Iterable[Fraction]) -> Fraction:
    """Greatest common divisor of fractions; 0 if there are none."""
    found = Fraction(0)
    for one in relatives:
        a, b = found, one
        found = Fraction(
            math.gcd(a.numerator * b.denominator, b.numerator * a.denominator), a.denominator * b.denominator
        )
    return found
