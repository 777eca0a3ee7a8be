"""Orders of several measurements of one drivetrain, calculated together once for the same values of the unknowns.

A campaign has many records with few lines each: the work of an evaluation hardly depends on the number of lines.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np

from torsionnet.identification.orders.order_block import OrderBlock
from torsionnet.identification.orders.parametric_orders import ParametricOrders
from torsionnet.identification.residuals.measurement_block import MeasurementBlock
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.sensitivity import Evaluation

MOST_LINES_TOGETHER = 5000
"""Number of lines up to which measurements are calculated together: with 40 causes of a misfit as unknowns, the
derivatives of the receptances of an engine of six cylinders then take some 20 MB for each output."""


@dataclass(frozen=True, eq=False)
class PartOfOrders:
    """Complex amplitudes of one measurement of orders, a part of those calculated together, in SI units."""

    whole: ParametricOrders
    lines: slice

    @property
    def drivetrain(self) -> AssembledModel:
        return self.whole.drivetrain

    @property
    def names(self) -> tuple[str, ...]:
        return self.whole.names

    @property
    def start(self) -> FloatArray:
        """Values (n,) of the unknowns in the model as given, in SI units."""
        return self.whole.start

    @property
    def frequencies(self) -> FloatArray:
        """Frequency in Hz of each measured line, order times speed, shape (n_lines,)."""
        return self.whole.frequencies[self.lines]

    @property
    def unit(self) -> str:
        """SI unit of the amplitudes."""
        return self.whole.units[int(self.whole.output_of[self.lines.start])]

    def at(self, values: Sequence[float] | FloatArray) -> Evaluation:
        """Amplitudes (n_lines, 1, 1) and derivatives (n_lines, 1, 1, n), in SI units, at values (n,) of the unknowns.

        Raises
        ------
        SolveError
            They are not finite there.
        """
        found = self.whole.at(values)
        return Evaluation(found.values[self.lines], found.jacobian[self.lines])


def with_shared_orders(blocks: Sequence[MeasurementBlock]) -> list[MeasurementBlock]:
    """Residual blocks, those of orders of the same drivetrain with their orders calculated together."""
    found = list(blocks)
    groups: dict[tuple[int, str], list[int]] = {}
    for place, block in enumerate(blocks):
        if isinstance(block, OrderBlock) and isinstance(block.response, ParametricOrders):
            groups.setdefault((id(block.response.drivetrain), block.response.speed_of), []).append(place)
    for group in groups.values():
        for together in _in_batches(group, [len(block.frequencies) for block in blocks]):
            whole = _joined([blocks[place].response for place in together])  # type: ignore[misc]
            first = 0
            for place in together if len(together) > 1 else ():
                last = first + len(blocks[place].frequencies)
                found[place] = copy(blocks[place])
                found[place].response = PartOfOrders(whole, slice(first, last))
                first = last
    return found


def _in_batches(places: Sequence[int], counts: Sequence[int]) -> list[list[int]]:
    """Places of blocks that are calculated together, as many as their lines (``counts``) allow."""
    found: list[list[int]] = []
    lines = 0
    for place in places:
        lines += counts[place]
        if not found or lines > MOST_LINES_TOGETHER:
            found.append([])
            lines = counts[place]
        found[-1].append(place)
    return found


def _joined(several: Sequence[ParametricOrders]) -> ParametricOrders:
    first = several[0]
    outputs = tuple(dict.fromkeys(output for one in several for output in one.outputs))
    output_of = [np.full(len(one.orders), outputs.index(one.outputs[0]), dtype=np.intp) for one in several]
    return ParametricOrders(
        first.drivetrain,
        first.names,
        outputs,
        np.concatenate([one.orders for one in several]),
        np.concatenate([one.speeds for one in several]),
        np.concatenate(output_of),
        first.speed_of,
    )
