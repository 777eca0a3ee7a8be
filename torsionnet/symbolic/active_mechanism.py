"""Symbolic drivetrains with actions, whose torques follow the motion and are unknowns beside the coordinates.

The torques T of the actions with laws N/E e^(-s tau), and those of rigid connections that are read, are unknowns beside
the coordinates,

    [ D(s)                -B    A^T ] [ q      ]   [ load ]
    [ -N e^(-s tau) L      E    0   ] [ T      ] = [ 0    ]
    [ A                    0    0   ] [ lambda ]   [ 0    ]

so that numerators and the determinant are polynomials in s, in the delays and in all coefficients, without a division
and without the poles of the drivetrain that the loops have moved.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, TypeAlias

from torsionnet.base.program import ProgramNode
from torsionnet.linear.assembly.symbolic import symbol_of
from torsionnet.model.elements import Action
from torsionnet.symbolic.algebra.delay import delay_symbol
from torsionnet.symbolic.algebra.minors import sparse_determinant
from torsionnet.symbolic.algebra.network import ZERO, Stiffness, SymbolRow
from torsionnet.symbolic.mechanism import PURE_S, Mechanism, SymbolicPart

Entries: TypeAlias = dict[int, ProgramNode]


@dataclass(eq=False)
class ActiveMechanism(Mechanism):
    """Symbolic drivetrain whose numerators and determinant include the torques of its actions as unknowns."""

    has_actions: ClassVar[bool] = True

    def determinant(self, load: SymbolRow) -> ProgramNode:
        del load
        return self._determinant

    def numerator(self, parts: Collection[SymbolicPart], load: Mapping[str, int]) -> ProgramNode:
        read: Entries = {}
        for part in parts:
            factor = self.program.leaf(part.factor)
            for law in [PURE_S] * part.power + ([part.law] if part.law else []):
                factor = factor * self.program.leaf(law)
            for column, value in self._read(part).items():
                _add(read, column, factor * self.program.leaf(value) * -1)
        # det [[P, b], [-r, 0]] = r adj(P) b, the numerator of the reading r by Cramer's rule.
        loaded = {self._column[name]: value for name, value in self.row(load).items() if name in self._column}
        last, rows = len(self._rows), [dict(row) for row in self._rows]
        for place, value in loaded.items():
            rows[place][last] = self.program.leaf(value)
        return sparse_determinant([*rows, read], self.program)

    @cached_property
    def _determinant(self) -> ProgramNode:
        return sparse_determinant(self._rows, self.program)

    @cached_property
    def _column(self) -> dict[str, int]:
        return {name: place for place, name in enumerate(self.kinematics.coordinates)}

    @cached_property
    def _acting(self) -> dict[int, int]:
        """Number of the row and column of each action's torque in the equations, by the action's number."""
        acting = [number for number, (_, action) in enumerate(self.kinematics.actions) if self._acts(action)]
        return {number: len(self._column) + place for place, number in enumerate(acting)}

    def _acts(self, action: Action) -> bool:
        return action.acts and bool(self.row(action.sensed))

    @cached_property
    def _rigid(self) -> dict[int, int]:
        """Number of the row and column of each read rigid connection's torque in the equations, by its number."""
        return {number: len(self._column) + len(self._acting) + place for place, number in enumerate(self.loose)}

    def _read(self, part: SymbolicPart) -> dict[int, Any]:
        if part.rigid is not None:
            return {self._rigid[part.rigid]: 1}
        if part.action is not None:
            return {self._acting[part.action]: 1} if part.action in self._acting else {}
        return {self._column[name]: value for name, value in self.row(part.row).items() if name in self._column}

    @cached_property
    def _rows(self) -> list[Entries]:
        rows: list[Entries] = [{} for _ in range(len(self._column) + len(self._acting) + len(self._rigid))]
        for member in self.network.members:
            law = self.program.leaf(member.law)
            for first, a in member.row.items():
                for second, b in member.row.items():
                    _add(rows[self._column[first]], self._column[second], law * self.program.leaf(a * b))
        for number, place in self._acting.items():
            self._act(rows, place, *self.kinematics.actions[number])
        # The torque of a rigid connection is the multiplier of its row, which stands on both sides.
        for number, place in self._rigid.items():
            for name, value in self.row(self.kinematics.constraints[number][1]).items():
                rows[self._column[name]][place] = rows[place][self._column[name]] = self.program.leaf(value)
        return rows

    def _act(self, rows: list[Entries], place: int, owner: str, action: Action) -> None:
        above, below = _lowest(action.numerator, action.denominator)
        law, delay = self._in_s(above) * -1, symbol_of(action.delay)
        if delay != 0:
            law = law * self.program.leaf(delay_symbol(owner))
        # -B T beside D(s) q, and E(s) T - N(s) e^(-s tau) L q = 0
        for name, value in self.row(action.row).items():
            rows[self._column[name]][place] = self.program.leaf(-value)
        for name, value in self.row(action.sensed).items():
            rows[place][self._column[name]] = law * self.program.leaf(value)
        rows[place][place] = self._in_s(below)

    def _in_s(self, coefficients: Sequence[Any]) -> ProgramNode:
        """Polynomial in s as a node of the program, from its coefficients in ascending powers."""
        first = [*coefficients[:3], ZERO, ZERO, ZERO][:3]
        polynomial = self.program.leaf(Stiffness(*first)) if any(first[1:]) else self.program.leaf(first[0])
        if len(coefficients) > len(first):
            s = self.program.leaf(PURE_S)
            polynomial = polynomial + s * s * s * self._in_s(coefficients[3:])
        return polynomial


def _add(entries: Entries, column: int, value: ProgramNode) -> None:
    entries[column] = entries[column] + value if column in entries else value


def _lowest(numerator: Sequence[Any], denominator: Sequence[Any]) -> tuple[list[Any], list[Any]]:
    """Coefficients of an action's numerator and denominator in s, as symbols, without common s or trailing zeros."""
    above, below = ([*map(symbol_of, part)] for part in (numerator, denominator))
    for part in (above, below):
        while part and part[-1] == 0:
            part.pop()
    while above and below and above[0] == 0 and below[0] == 0:
        del above[0], below[0]
    return above, below
