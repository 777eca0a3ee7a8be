"""Lines of one frequency, as order 4 of an engine and of the propeller on its shaft: a test measures their sum."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from torsionnet.response.frequency_response import ComplexArray, FloatArray
from torsionnet.response.order_line import OrderLine

AND = " + "
"""Between the lines of a sum."""


class Summable(Protocol):
    """An order response, of one case or of several."""

    @property
    def lines(self) -> tuple[OrderLine, ...]: ...

    @property
    def values(self) -> ComplexArray: ...

    @property
    def sizes(self) -> FloatArray: ...

    @property
    def single_cases(self) -> Sequence[ComplexArray]: ...


def lines_of_one_frequency(lines: Sequence[OrderLine]) -> list[list[int]]:
    """Places of the lines of every frequency, in the order of the first of each.

    Examples
    --------
    >>> from fractions import Fraction
    >>> engine = [OrderLine("engine", order, Fraction(1)) for order in (3.0, 4.0)]
    >>> lines_of_one_frequency([*engine, OrderLine("propeller", 4.0, Fraction(1))])
    [[0], [1, 2]]
    """
    found: dict[object, list[int]] = {}
    for place, line in enumerate(lines):
        found.setdefault((line.relative, line.fixed), []).append(place)
    return list(found.values())


@dataclass(frozen=True)
class LineSum:
    """Several lines of one frequency.

    Attributes
    ----------
    name : str
        As ``engine 4 + propeller 4``.
    order : float
        Periods per revolution of the reference shaft.
    fixed : float
        Frequency that is added to that of the order, Hz.
    places : tuple of int
        Of the lines among all.
    """

    name: str
    order: float
    fixed: float
    places: tuple[int, ...]


def sums_of_lines(lines: Sequence[OrderLine]) -> tuple[LineSum, ...]:
    """The frequencies that more than one line has.

    Examples
    --------
    >>> from fractions import Fraction
    >>> engine = [OrderLine("engine", order, Fraction(1)) for order in (3.0, 4.0)]
    >>> sums_of_lines([*engine, OrderLine("propeller", 2.0, Fraction(2))])
    (LineSum(name='engine 4 + propeller 2', order=4.0, fixed=0.0, places=(1, 2)),)
    """
    found = [places for places in lines_of_one_frequency(lines) if len(places) > 1]
    return tuple(
        LineSum(sum_name([lines[one] for one in places]), float(first.relative), first.fixed, tuple(places))
        for places, first in ((places, lines[places[0]]) for places in found)
    )


def sum_name(lines: Sequence[OrderLine]) -> str:
    """What the sum of some lines is called, as ``engine 4 + propeller 4``."""
    return AND.join(map(str, lines))


def is_sum_name(name: str) -> bool:
    """Whether a row of a written table is the sum of others; excitations have names without spaces."""
    return AND in name


def summed_sizes(run: Summable) -> FloatArray:
    """Amplitudes (n_speeds, n_frequencies, n_out), lines of one frequency added; of several cases the largest."""
    found = []
    for places in lines_of_one_frequency(run.lines):
        if len(places) == 1:
            found.append(run.sizes[:, places[0]])
        else:
            cases = (run.values, *run.single_cases)
            found.append(np.max([np.abs(values[:, places].sum(axis=1)) for values in cases], axis=0))
    return np.stack(found, axis=1)
