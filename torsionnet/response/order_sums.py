"""Lines of one frequency, as order 4 of an engine and of the propeller on its shaft: a test measures their sum."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from torsionnet.response.frequency_response import ComplexArray, FloatArray
from torsionnet.response.order_line import OrderLine


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


def sum_name(lines: Sequence[OrderLine]) -> str:
    """What the sum of some lines is called, as ``engine 4 + propeller 4``."""
    return " + ".join(map(str, lines))


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
