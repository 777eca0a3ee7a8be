"""Sums of order lines of one frequency, such as order 4 of engine and propeller on a shaft, as a test measures them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.machinery.orders.order_line import OrderLine

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
    found: dict[object, list[int]] = {}
    for place, line in enumerate(lines):
        found.setdefault((line.relative, line.fixed), []).append(place)
    return list(found.values())


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
    found = [places for places in lines_of_one_frequency(lines) if len(places) > 1]
    return tuple(
        LineSum(sum_name([lines[one] for one in places]), float(first.relative), first.fixed, tuple(places))
        for places, first in ((places, lines[places[0]]) for places in found)
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
    found = []
    for places in lines_of_one_frequency(run.lines):
        if len(places) == 1:
            found.append(run.sizes[:, places[0]])
        else:
            cases = (run.values, *run.case_values)
            found.append(np.max([np.abs(values[:, places].sum(axis=1)) for values in cases], axis=0))
    return np.stack(found, axis=1)
