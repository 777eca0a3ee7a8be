"""Linear problem behind a response, with rows of laws, unit excitations, and motions and reactions to solve for.

Columns below ``n_free`` are coordinates, which follow from the equations of motion. Those from there on are given: an
imposed angle, or the gap of a rigid connection, which is held at zero so that its reaction can be read.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

from torsionnet.solve.dynamic_stiffness.elimination_plan import EliminationPlan
from torsionnet.solve.dynamic_stiffness.graph_plan import make_plan
from torsionnet.solve.dynamic_stiffness.row_algebra import DOUBLE, Accuracy, Row
from torsionnet.solve.dynamic_stiffness.tape import Tape
from torsionnet.solve.dynamic_stiffness.tape_writing import make_tape

MOST_SINGLE_TORQUES = 4
"""Largest number of excitation torques that are solved one by one, since each then has its own coordinate at the root
of the tree."""
GOLDEN = (math.sqrt(5) - 1) / 2
"""Golden ratio minus one, whose multiples modulo 1 spread the scale factors of coordinates most evenly."""


@dataclass(frozen=True)
class Loading:
    """Unit excitation, torques ``load`` in N m by column and angles ``motion`` in rad of given columns.

    All other given columns are at rest.
    """

    load: Row = field(default_factory=dict)
    motion: Row = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class ResponseProblem:
    """Linear problem behind a response, with rows of laws, excitations, and motions and reactions to solve for.

    Attributes
    ----------
    laws : sequence of rows
        gamma of every law over all columns.
    n_free : int
        Number of coordinates.
    excitations : tuple of Loading
    outputs : tuple of rows
        Rows of the motions to be solved for, over all columns.
    reactions : tuple of int
        Given columns whose reaction is solved for: the torque that the drivetrain, held there, exerts.
    other_order : bool
        Whether to eliminate towards another root, in coordinates of odd sizes: which gives the same but for rounding.
    accuracy : Accuracy
        Of the coefficients in all rows.
    """

    laws: Sequence[Row]
    n_free: int
    excitations: tuple[Loading, ...]
    outputs: tuple[Row, ...]
    reactions: tuple[int, ...] = ()
    other_order: bool = False
    accuracy: Accuracy = DOUBLE

    @property
    def n_read(self) -> int:
        return len(self.outputs) + len(self.reactions)

    @cached_property
    def parts(self) -> tuple[tuple[list[int], ResponseProblem], ...]:
        """Groups of excitation numbers that one elimination solves, each group with its response problem.

        Few torques are solved one by one, and all imposed motions at once.
        """
        loads = [number for number, one in enumerate(self.excitations) if not one.motion]
        motions = [number for number, one in enumerate(self.excitations) if one.motion]
        groups = [[number] for number in loads] if len(loads) <= MOST_SINGLE_TORQUES else [loads]
        groups += [motions] if motions else []
        if len(groups) == 1:
            return ((groups[0], self),)
        return tuple((group, self._only([self.excitations[number] for number in group])) for group in groups)

    @cached_property
    def in_other_order(self) -> ResponseProblem:
        """Copy of the response problem with another elimination order and scales, so that rounding errors differ.

        Where what is read is a small difference, as of 1 and a share next to it, its digits end with those of the 1,
        however the stiffnesses are moved. In other sizes it is no longer 1.
        """
        return replace(self, other_order=True)

    def _only(self, excitations: Sequence[Loading]) -> ResponseProblem:
        return replace(self, excitations=tuple(excitations))

    def _sized(self, row: Row) -> Row:
        if not self.other_order:
            return row
        return {column: value * _odd(column) if column < self.n_free else value for column, value in row.items()}

    @cached_property
    def plan(self) -> EliminationPlan:
        return make_plan(
            [self._sized(law) for law in self.laws],
            self.n_free,
            [self._sized(excitation.load) for excitation in self.excitations],
            [excitation.motion for excitation in self.excitations],
            [self._sized(output) for output in self.outputs],
            self.reactions,
            other_order=self.other_order,
            accuracy=self.accuracy,
        )

    @cached_property
    def tape(self) -> Tape:
        return make_tape(self.plan)


def _odd(column: int) -> float:
    """Scale factor between 1 and 2 of a coordinate, different for each column."""
    return 1 + (column + 1) * GOLDEN % 1
