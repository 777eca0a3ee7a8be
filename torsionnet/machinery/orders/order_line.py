"""Order line, one order or fixed frequency of an excitation, and its frequency at each speed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Protocol

import numpy as np

from torsionnet.linear.frequency_response import ComplexArray, FloatArray

LARGEST_DENOMINATOR = 10**6
"""Largest denominator of an order as a fraction; finer ones are taken for rounding."""


@dataclass(frozen=True)
class OrderLine:
    """Line of an order response, one order of one excitation or one of its fixed frequencies (Hz).

    Attributes
    ----------
    excitation : str
    order : float
        Vibrations per revolution of the shaft of the excitation.
    ratio : Fraction
        Revolutions of that shaft per revolution of the reference shaft, not negative.
    fixed : float
        Frequency in Hz added to that of the order: the whole frequency if ``order`` is 0; a slip if it is negative.
    engine : str
        Engine of the line, or the first of those fixed to it, if angles between engines are unknown.
    """

    excitation: str
    order: float
    ratio: Fraction
    fixed: float = 0.0
    engine: str = ""

    @cached_property
    def exact_order(self) -> Fraction:
        """Order of an order line, vibrations per revolution of the shaft of its excitation, as a fraction."""
        return near_fraction(float(self.order))

    @cached_property
    def relative(self) -> Fraction:
        """Order of an order line, vibrations per revolution of the reference shaft, as a fraction."""
        return self.exact_order * self.ratio

    def frequency(self, speeds: FloatArray) -> FloatArray:
        """Frequency of an order line in Hz at speeds in rad/s of the reference shaft, in the shape of the speeds.

        Negative where a slip has changed its sign.
        """
        return np.asarray(float(self.relative) * speeds / (2 * math.pi) + self.fixed)

    def __str__(self) -> str:
        return f"{self.excitation} {self.words}"

    @property
    def words(self) -> str:
        """Order of an order line, its fixed frequency in Hz, or both, without its excitation."""
        if not self.fixed:
            return f"{self.order:g}"
        if not self.order:
            return f"{self.fixed:g} Hz"
        return f"{self.fixed:g} Hz {'-' if self.order < 0 else '+'} order {abs(self.order):g}"


def near_fraction(value: float) -> Fraction:
    """Fraction nearest to an order or a frequency, with a denominator of at most ``LARGEST_DENOMINATOR``."""
    return Fraction(value).limit_denominator(LARGEST_DENOMINATOR)


# Groups of order lines with known phases between them, one for each engine whose angle to others is not given.

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
    return [EngineBlock(engine, tuple(at for at, home in enumerate(homes) if home == engine)) for engine in engines]


def blocks_by_speed(lines: Sequence[OrderLine]) -> list[list[EngineBlock]]:
    """List of lists of engine blocks (indices of order lines), one inner list for all engines that turn at one speed.

    Within a group an angle changes the sum.
    """
    groups: list[tuple[set[Fraction], list[EngineBlock]]] = []
    for block in engine_blocks(lines):
        ratios = {lines[place].ratio for place in block.places if lines[place].engine == block.engine}
        home = next((blocks for others, blocks in groups if others & ratios), None)
        if home is None:
            groups.append((ratios, [block]))
        else:
            home.append(block)
    return [blocks for _, blocks in groups]


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
        grid = cls._through(lines, moving)
        if grid.points <= MOST_GRID_POINTS:
            return grid
        # Half orders repeat after two revolutions of the slowest engine: lines that do too keep the grid short.
        half = min(lines[at].ratio for at in moving[-1]) / 2
        own = [tuple(at for at in places if (lines[at].relative / half).denominator == 1) for places in moving]
        return cls._through(lines, own)

    @classmethod
    def _through(cls, lines: Sequence[OrderLine], moving: Sequence[tuple[int, ...]]) -> BlockGrid:
        # Lines of relative orders r repeat together after 1/gcd(r) revolutions.
        slowest = [greatest_common_divisor(lines[at].relative for at in places) for places in moving]
        whole = greatest_common_divisor(slowest)
        repeats = [max(1, int(relative / whole)) for relative in slowest]
        step = math.lcm(*repeats)
        highest = max(lines[at].relative for places in moving for at in places)
        # A multiple of all repeats, so that the period of every block is a whole number of steps.
        points = math.ceil(GRID_POINTS_PER_PERIOD * highest / whole / step) * step
        return cls(tuple(moving), tuple(points // count for count in repeats), points, 1 / whole)


def greatest_common_divisor(relatives: Iterable[Fraction]) -> Fraction:
    """Greatest common divisor of fractions; 0 if there are none."""
    divisor = Fraction(0)
    for relative in relatives:
        a, b = divisor, relative
        # gcd(a/b, c/d) = gcd(a d, c b)/(b d).
        divisor = Fraction(
            math.gcd(a.numerator * b.denominator, b.numerator * a.denominator), a.denominator * b.denominator
        )
    return divisor


# Sums of order lines of one frequency, such as order 4 of engine and propeller on a shaft, as a test measures them.

SUM_SEPARATOR = " + "
"""Text between the names of order lines in the name of their sum."""


class LinesWithCases(Protocol):
    """Protocol of an order response of one or several cases, with lines, complex values (SI) and amplitudes."""

    @property
    def lines(self) -> tuple[OrderLine, ...]: ...

    @property
    def values(self) -> ComplexArray: ...

    @property
    def sizes(self) -> FloatArray: ...

    @property
    def case_values(self) -> Sequence[ComplexArray]: ...


def lines_of_one_frequency(lines: Sequence[OrderLine]) -> list[list[int]]:
    """Lists of the indices of order lines that share a frequency, sorted by the first index of each list.

    Examples
    --------
    >>> from fractions import Fraction
    >>> engine = [OrderLine("engine", order, Fraction(1)) for order in (3.0, 4.0)]
    >>> lines_of_one_frequency([*engine, OrderLine("propeller", 4.0, Fraction(1))])
    [[0], [1, 2]]
    """
    groups: dict[object, list[int]] = {}
    for place, line in enumerate(lines):
        groups.setdefault((line.relative, line.fixed), []).append(place)
    return list(groups.values())


@dataclass(frozen=True)
class LineSum:
    """Sum of several order lines of one frequency, with its name, order, fixed frequency in Hz and indices of lines.

    Attributes
    ----------
    name : str
        Name of the sum, such as ``engine 4 + propeller 4``.
    order : float
        Vibrations per revolution of the reference shaft.
    fixed : float
        Frequency added to that of the order, Hz.
    places : tuple of int
        Indices of the lines among all lines.
    """

    name: str
    order: float
    fixed: float
    places: tuple[int, ...]


def sums_of_lines(lines: Sequence[OrderLine]) -> tuple[LineSum, ...]:
    """Name, order and line indices of each sum of order lines, one for every frequency that several lines share.

    Examples
    --------
    >>> from fractions import Fraction
    >>> engine = [OrderLine("engine", order, Fraction(1)) for order in (3.0, 4.0)]
    >>> sums_of_lines([*engine, OrderLine("propeller", 2.0, Fraction(2))])
    (LineSum(name='engine 4 + propeller 2', order=4.0, fixed=0.0, places=(1, 2)),)
    """
    sums = [places for places in lines_of_one_frequency(lines) if len(places) > 1]
    return tuple(
        LineSum(sum_name([lines[place] for place in places]), float(first.relative), first.fixed, tuple(places))
        for places, first in ((places, lines[places[0]]) for places in sums)
    )


def sum_name(lines: Sequence[OrderLine]) -> str:
    """Name of the sum of some order lines, such as ``engine 4 + propeller 4``."""
    return SUM_SEPARATOR.join(map(str, lines))


def is_sum_name(name: str) -> bool:
    """Whether a name in a written table is that of a sum of order lines; excitations have names without spaces."""
    return SUM_SEPARATOR in name


def summed_sizes(run: LinesWithCases) -> FloatArray:
    """Largest amplitude (SI) over all cases with lines of one frequency added, shape (n_speeds, n_frequencies, n_out).

    The largest of several cases.
    """
    sizes = []
    for places in lines_of_one_frequency(run.lines):
        if len(places) == 1:
            sizes.append(run.sizes[:, places[0]])
        else:
            # The largest sum of a case need not come in the case with the largest parts: phases differ.
            cases = (run.values, *run.case_values)
            sizes.append(np.max([np.abs(values[:, places].sum(axis=1)) for values in cases], axis=0))
    return np.stack(sizes, axis=1)
