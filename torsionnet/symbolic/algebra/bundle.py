"""Determinants of a block of laws between two coordinates, recorded without a division.

With rows a_e = (a_ev, a_ec) of the laws y_e between a coordinate v and a coordinate c below it, and A_c and Q_c the
determinants of what hangs on c, with c free and held,

    held at v    Q = A_c + sum_e y_e a_ec^2 Q_c
    free at v    A = sum_e y_e a_ev^2 A_c + sum_{e<f} y_e y_f (a_ev a_fc - a_fv a_ec)^2 Q_c
    motion of c  -sum_e y_e a_ev a_ec Q_c

under a unit torque on v (Cauchy-Binet). A shaft with inertia of its own has the two rows (1, -1) and (1, 1).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Any

from torsionnet.symbolic.algebra.block_tree import GraphBlock
from torsionnet.symbolic.algebra.network import Stiffness, SymbolRow, vanishes
from torsionnet.symbolic.algebra.program import Program, ProgramNode


@dataclass(frozen=True)
class Quotient:
    """Dynamic stiffness of a law as a quotient above / below of program nodes, rigid where ``below`` is zero."""

    above: ProgramNode
    below: ProgramNode


def quotient(law: Stiffness, program: Program) -> Quotient:
    """Dynamic stiffness of a law as a quotient of program nodes with the denominator 1."""
    return Quotient(program.leaf(law), program.leaf(1))


def sum_of_quotients(laws: Sequence[tuple[Quotient, Any]], program: Program) -> Quotient:
    """Sum over laws of dynamic stiffness times squared ratio of motion, as one quotient of program nodes."""
    total = Quotient(program.leaf(0), program.leaf(1))
    for law, ratio in laws:
        above = program.leaf(ratio**2) * law.above
        total = Quotient(total.above * law.below + above * total.below, total.below * law.below)
    return total


@dataclass(frozen=True, eq=False)
class Bundle:
    """Block of all laws between two coordinates, with the stiffness (quotient) of all parts beyond the lower one."""

    block: GraphBlock[Quotient]
    hanging: Quotient
    program: Program

    @cached_property
    def held(self) -> ProgramNode:
        """Dynamic stiffness determinant of block and parts beyond, upper coordinate held, as a program node."""
        far = self._sum([row[self._child] ** 2 for row in self._rows])
        return self.hanging.above * self._below() + far * self.hanging.below

    @cached_property
    def free(self) -> ProgramNode:
        """Dynamic stiffness determinant of block and parts beyond, upper coordinate free, as a program node."""
        total = self._sum([row[self.block.top] ** 2 for row in self._rows]) * self.hanging.above
        both = self._pairs()
        return total if both.is_zero else total + both * self.hanging.below

    def carried(self, end: str) -> ProgramNode:
        """Numerator (program node) of the lower coordinate's angle, no parts beyond, under unit torque on the upper."""
        return self._sum([-row[self.block.top] * row[end] for row in self._rows])

    def reading(self, row: SymbolRow) -> ProgramNode:
        """Numerator (program node) of a sensor's reading in the block under a unit torque on the upper coordinate."""
        near, far = row.get(self.block.top, 0), row.get(self._child, 0)
        twists = [own[self._child] * (near * own[self._child] - far * own[self.block.top]) for own in self._rows]
        total = self.program.leaf(near) * self.hanging.above * self._below()
        return total + self._sum([0 if vanishes(twist) else twist for twist in twists]) * self.hanging.below

    @property
    def _child(self) -> str:
        return self.block.below[0]

    @property
    def _rows(self) -> list[SymbolRow]:
        return [member.row for member in self.block.members]

    def _below(self, *without: int) -> ProgramNode:
        """Product of the stiffness denominators of all laws of the block except those whose numbers are given."""
        result = self.program.leaf(1)
        for number, member in enumerate(self.block.members):
            if number not in without:
                result = result * member.law.below
        return result

    def _sum(self, factors: Sequence[Any]) -> ProgramNode:
        """Sum of the laws' dynamic stiffnesses, each times its entry of ``factors``, times all laws' denominators."""
        total = self.program.leaf(0)
        for number, (factor, member) in enumerate(zip(factors, self.block.members, strict=True)):
            total = total + self.program.leaf(factor) * member.law.above * self._below(number)
        return total

    def _pairs(self) -> ProgramNode:
        """Program node of the sum over pairs of parallel laws of both stiffnesses times a squared determinant.

        The determinant is that of the rows of both laws; the sum is multiplied by all denominators.
        """
        total, top, child = self.program.leaf(0), self.block.top, self._child
        for (i, one), (j, other) in combinations(enumerate(self.block.members), 2):
            across = one.row[top] * other.row[child] - other.row[top] * one.row[child]
            if not vanishes(across):
                both = one.law.above * other.law.above * self._below(i, j)
                total = total + self.program.leaf(across**2) * both
        return total
