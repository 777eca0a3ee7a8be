"""What a solver is asked: laws over coordinates and given motions, what drives them, and what is read.

Columns below ``n_free`` are coordinates, which follow from the equations of motion. Those from there on are given: an
imposed angle, or the gap of a rigid connection, which is held at zero so that its reaction can be read.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

from torsionnet.solve.graph_plan import make_plan
from torsionnet.solve.plan import Plan
from torsionnet.solve.row_algebra import Row
from torsionnet.solve.tape import Tape
from torsionnet.solve.taping import make_tape

ALONE = 4
"""Up to so many torques are solved one by one, each with its own coordinate at the root of the tree."""


@dataclass(frozen=True)
class Excitation:
    """A unit of what drives: ``load``, N m by column, and ``motion``, rad of given columns; the others stand still."""

    load: Row = field(default_factory=dict)
    motion: Row = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Problem:
    """Laws over all columns, what drives, and what is read.

    Attributes
    ----------
    laws : sequence of rows
        gamma of every law over all columns.
    n_free : int
        Number of coordinates.
    excitations : tuple of Excitation
    outputs : tuple of rows
        Motions asked for, over all columns.
    reactions : tuple of int
        Given columns; asked for is the torque on each that the drivetrain, held there, exerts.
    turned : bool
        Whether to eliminate towards another root, which gives the same but for rounding.
    """

    laws: Sequence[Row]
    n_free: int
    excitations: tuple[Excitation, ...]
    outputs: tuple[Row, ...]
    reactions: tuple[int, ...] = ()
    turned: bool = False

    @property
    def n_read(self) -> int:
        return len(self.outputs) + len(self.reactions)

    @cached_property
    def parts(self) -> tuple[tuple[list[int], Problem], ...]:
        """Which excitations are solved together: torques one by one where they are few, and all imposed motions."""
        loads = [number for number, one in enumerate(self.excitations) if not one.motion]
        motions = [number for number, one in enumerate(self.excitations) if one.motion]
        groups = [[number] for number in loads] if len(loads) <= ALONE else [loads]
        groups += [motions] if motions else []
        if len(groups) == 1:
            return ((groups[0], self),)
        return tuple((group, self._only([self.excitations[number] for number in group])) for group in groups)

    @cached_property
    def otherwise(self) -> Problem:
        """The same by another order of elimination."""
        return replace(self, turned=True)

    def _only(self, excitations: Sequence[Excitation]) -> Problem:
        return replace(self, excitations=tuple(excitations))

    @cached_property
    def plan(self) -> Plan:
        return make_plan(
            self.laws,
            self.n_free,
            [excitation.load for excitation in self.excitations],
            [excitation.motion for excitation in self.excitations],
            self.outputs,
            self.reactions,
            turned=self.turned,
        )

    @cached_property
    def tape(self) -> Tape:
        return make_tape(self.plan)
