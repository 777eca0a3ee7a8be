"""Determinants of blocks with closed loops or laws over several coordinates, by deletion and contraction.

det(D + y a a^T) = det D + y a_v^2 det(D on the motions with a = 0), and so for every bilinear form of the adjugate:
one law less in the first term, one coordinate less in the second, and both again trees of smaller blocks. Blocks with
more than a few loops are left to sympy's characteristic polynomial.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import comb

from torsionnet.symbolic.algebra.charpoly import ExpandedBlock
from torsionnet.symbolic.algebra.network import (
    ONE,
    Contraction,
    Network,
    NetworkMember,
    Program,
    ProgramNode,
    SymbolRow,
    add_parallel_laws,
)
from torsionnet.symbolic.algebra.recursion import GraphBlock, Quotient, Recursion, SolvedBlock, sum_of_quotients

MOST_LOOPS = 3
"""Largest number of loops in a block solved by deletion and contraction, as with more the characteristic polynomial is
shorter."""
MOST_FORESTS = 2000
"""Largest number of forests that deletion and contraction may lead to in one block, as that is the length of the
result."""


def solve_block(block: GraphBlock[Quotient], hanging: Mapping[str, Quotient], program: Program) -> SolvedBlock:
    """Solved block of more than two coordinates, with its determinants and readings, parts beyond it included."""
    loops = loops_of(block)
    if loops > MOST_LOOPS or comb(len(block.members), loops) > MOST_FORESTS:
        return ExpandedBlock(block, hanging, program)
    return SplitBlock(block, hanging, program)


def loops_of(block: GraphBlock[Quotient]) -> int:
    """Number of loops of a block, its laws over more than two coordinates plus its pairs beyond a spanning tree."""
    pairs = {frozenset(member.row) for member in block.members if len(member.row) == 2}
    wide = sum(len(member.row) > 2 for member in block.members)
    return wide + max(0, len(pairs) - len(block.below))


@dataclass(frozen=True, eq=False)
class SplitBlock:
    """Block solved by splitting off one law, once without that law and once with its motion constrained to zero."""

    block: GraphBlock[Quotient]
    hanging: Mapping[str, Quotient]
    program: Program
    others: dict[str, SplitBlock] = field(default_factory=dict)

    @cached_property
    def network(self) -> Network[Quotient]:
        """Network of one block, in which the parts beyond it are laws to ground."""
        grounds = (NetworkMember({name: ONE}, law) for name, law in self.hanging.items())
        return Network((self.block.top, *self.block.below), (*self.block.members, *grounds))

    @cached_property
    def member(self) -> NetworkMember[Quotient]:
        """Law that is split off a block, the one over most coordinates, else of the fewest between two coordinates."""
        among = Counter(frozenset(member.row) for member in self.block.members)
        return max(self.block.members, key=lambda member: (len(member.row), -among[frozenset(member.row)]))

    @cached_property
    def contraction(self) -> Contraction[Quotient]:
        return self.network.without(self.member).contracted(self.member.row, keep=self.block.top)

    @cached_property
    def deleted(self) -> Recursion:
        return Recursion(self.network.without(self.member), self.program, self.block.top, solve_block)

    @cached_property
    def contracted(self) -> Recursion:
        network = add_parallel_laws(self.contraction.network, lambda laws: sum_of_quotients(laws, self.program))
        return Recursion(network, self.program, self.block.top, solve_block)

    @cached_property
    def weight(self) -> ProgramNode:
        """Program node that multiplies the determinant of the network in which the split law's motion is zero."""
        result = self.program.leaf(self.contraction.factor) * self.member.law.above
        for law in self.contraction.idle:
            result = result * law.below
        return result

    def _joined(self, deleted: ProgramNode, contracted: ProgramNode) -> ProgramNode:
        return self.member.law.below * deleted + self.weight * contracted

    @cached_property
    def held(self) -> ProgramNode:
        """Dynamic stiffness determinant of block and parts beyond, coordinate nearest the root held, a program node."""
        return self._joined(self.deleted.held, self.contracted.held)

    @cached_property
    def free(self) -> ProgramNode:
        """Dynamic stiffness determinant of block and parts beyond, coordinate nearest the root free, a program node."""
        return self._joined(self.deleted.determinant, self.contracted.determinant)

    def reading(self, row: SymbolRow) -> ProgramNode:
        """Numerator (program node) of a sensor's reading in the block under a unit torque nearest the root."""
        return self._joined(self.deleted.reading(row), self.contracted.reading(self.contraction.row(row)))

    def carried(self, end: str) -> ProgramNode:
        """Numerator (program node) of a coordinate's angle without parts beyond, under unit torque nearest the root."""
        if end not in self.others:
            bare = {name: law for name, law in self.hanging.items() if name != end}
            self.others[end] = replace(self, hanging=bare, others={})
        return self.others[end].reading({end: ONE})
