"""Relative vector sums of an engine's cylinders, by mode and order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from torsionnet.base.phrases import phrase
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table
from torsionnet.machinery.phasors.star_diagram import StarDiagram

EQUAL_SUMS = 1e-6
"""Difference of relative vector sums up to which orders count as having equal sums; far above rounding, far below what
is shown."""
ROUNDED_SUM = 1e-9
"""Relative vector sum below which a table shows 0: what rounding leaves of vectors that cancel."""


@dataclass(frozen=True)
class VectorSum:
    """Relative vector sum of one order on one mode, as a number of cylinders at the largest amplitude.

    ``|sum_z theta_z exp(-j h alpha_z)| / max theta``.
    """

    mode: Annotated[int, Out("mode")]
    order: Annotated[float, Out("order")]
    sum: Annotated[float, Out("vector sum", digits=4)]


@dataclass(frozen=True, eq=False)
class VectorSums:
    """Relative vector sums of an engine, with the star diagram of every mode and order.

    Attributes
    ----------
    excitation : str
    modes : tuple of int
    orders : tuple of float
    stars : mapping
        Star diagram by mode and order.
    """

    excitation: str
    modes: tuple[int, ...]
    orders: tuple[float, ...]
    stars: dict[tuple[int, float], StarDiagram]

    def of(self, mode: int, order: float) -> float:
        """Relative vector sum of an order on a mode, as a number of cylinders at the largest amplitude."""
        return abs(self.stars[mode, order].sum)

    def rows(self) -> tuple[VectorSum, ...]:
        """Relative vector sums of an engine as plain rows, sorted by mode, then by order."""
        return tuple(VectorSum(mode, order, self.of(mode, order)) for mode in self.modes for order in self.orders)

    def groups(self) -> tuple[tuple[float, ...], ...]:
        """Groups (tuples) of orders whose vector sums are equal on all modes, sorted by the first order of each group.

        In-line engines that fire evenly repeat their stars: order h has that of order h plus half the number of
        cylinders (four-stroke) or plus all of them (two-stroke), and the mirror image has the same sum.
        """
        found: list[list[float]] = []
        for order in self.orders:
            sums = self._sums(order)
            alike = next((group for group in found if np.allclose(self._sums(group[0]), sums, atol=EQUAL_SUMS)), None)
            if alike is None:
                found.append([order])
            else:
                alike.append(order)
        return tuple(map(tuple, found))

    def table(self) -> Table:
        """Table of relative vector sums, a row for each group of orders and a column for each mode."""
        columns = (Column("orders"), *(Column(phrase("mode {number}", number=mode), "", 4, 4) for mode in self.modes))
        rows = tuple((order_names(group), *map(_shown, self._sums(group[0]))) for group in self.groups())
        return Table(phrase("{name}: relative vector sums", name=self.excitation), columns, rows)

    def _sums(self, order: float) -> list[float]:
        return [self.of(mode, order) for mode in self.modes]


def _shown(value: float) -> float:
    return 0.0 if value < ROUNDED_SUM else value


def order_names(orders: Sequence[float]) -> str:
    """Text of the numbers of orders, separated by commas."""
    return ", ".join(f"{order:g}" for order in orders)
