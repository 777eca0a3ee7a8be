"""Recursion without division on a tree of blocks, for a network's determinant and the readings of sensors.

Below a coordinate v hang blocks, each with its determinants A_b and Q_b for v free and held (see
:mod:`torsionnet.symbolic.algebra.bundle` and :mod:`torsionnet.symbolic.algebra.loops`). With g_v the dynamic stiffness
to ground,

    Q_v = prod Q_b,   A_v = g_v Q_v + sum_b A_b prod_{b' != b} Q_b'

det D = A_root, and for the torque at the root and the motion at j

    adj_j = prod_path(motion carried through the block) * prod_{blocks hanging off the path} Q_b * Q_j

without a subtraction or division where every block is a single edge: every coefficient of the expanded result is
positive where the ratios are.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol, TypeAlias

from torsionnet.symbolic.algebra.block_tree import GraphBlock, Orientation, orient, roots_of
from torsionnet.symbolic.algebra.bundle import Bundle, Quotient, sum_of_quotients
from torsionnet.symbolic.algebra.network import Network, SymbolRow
from torsionnet.symbolic.algebra.program import Program, ProgramNode


class SolvedBlock(Protocol):
    """Protocol of a block's determinants and readings, with all parts of the network beyond the block."""

    @property
    def held(self) -> ProgramNode:
        """Dynamic stiffness determinant of block and parts beyond, coordinate nearest the root held, a program node."""
        ...

    @property
    def free(self) -> ProgramNode:
        """Dynamic stiffness determinant of block and parts beyond, coordinate nearest the root free, a program node."""
        ...

    def carried(self, end: str) -> ProgramNode:
        """Numerator (program node) of a coordinate's angle without parts beyond, under unit torque nearest the root."""
        ...

    def reading(self, row: SymbolRow) -> ProgramNode:
        """Numerator (program node) of a sensor's reading in the block under a unit torque nearest the root."""
        ...


BlockSolver: TypeAlias = Callable[[GraphBlock[Quotient], Mapping[str, Quotient], Program], SolvedBlock]
"""Function that solves a block of more than two coordinates, from the block, the stiffness of the parts beyond it by
coordinate and a program, and returns its determinants and readings (:class:`SolvedBlock`)."""


@dataclass
class Recursion:
    """Determinants of a network's parts beyond every coordinate, by its name, with it free (A) and held (Q)."""

    network: Network[Quotient]
    program: Program
    root: str
    solve_block: BlockSolver
    A: dict[str, ProgramNode] = field(default_factory=dict)
    Q: dict[str, ProgramNode] = field(default_factory=dict)
    solved: dict[GraphBlock[Quotient], SolvedBlock] = field(default_factory=dict)

    @cached_property
    def tree(self) -> Orientation[Quotient]:
        return orient(self.network, self.root)

    def __post_init__(self) -> None:
        for name in reversed(self.tree.order):
            self._eliminate(name)

    @property
    def determinant(self) -> ProgramNode:
        """Determinant det D of the whole network's dynamic stiffness, as a node of the program."""
        return self.A[self.root] * self.beside

    @property
    def held(self) -> ProgramNode:
        """Determinant of the whole network's dynamic stiffness with the root held, as a node of the program."""
        return self.Q[self.root] * self.beside

    @cached_property
    def beside(self) -> ProgramNode:
        """Product, a program node, of the determinants of all parts of the network not connected to the root."""
        result = self.program.leaf(1)
        for other in roots_of(self.network, self.root)[1:]:
            result = result * Recursion(self.network, self.program, other, self.solve_block).A[other]
        return result

    def _eliminate(self, name: str) -> None:
        blocks = self.tree.below[name]
        for block in blocks:
            self.solved[block] = self._solve(block)
        own = self._ground(name)
        held = self._hanging(name)
        self.Q[name] = own.below * held
        total = own.above * held
        for block, rest in zip(blocks, self._products_without_one(blocks), strict=True):
            total = total + own.below * self.solved[block].free * rest
        self.A[name] = total

    def _solve(self, block: GraphBlock[Quotient]) -> SolvedBlock:
        hanging = {name: Quotient(self.A[name], self.Q[name]) for name in block.below}
        if block.is_bundle:
            return Bundle(block, hanging[block.below[0]], self.program)
        return self.solve_block(block, hanging, self.program)

    def _ground(self, name: str) -> Quotient:
        return sum_of_quotients([(law, 1) for law in self.network.grounds.get(name, ())], self.program)

    def _hanging(self, name: str, without: GraphBlock[Quotient] | None = None) -> ProgramNode:
        result = self.program.leaf(1)
        for block in self.tree.below[name]:
            if block is not without:
                result = result * self.solved[block].held
        return result

    def _products_without_one(self, blocks: Sequence[GraphBlock[Quotient]]) -> list[ProgramNode]:
        ahead, behind = [self.program.leaf(1)], [self.program.leaf(1)]
        for block in blocks[:-1]:
            ahead.append(ahead[-1] * self.solved[block].held)
        for block in reversed(blocks[1:]):
            behind.append(behind[-1] * self.solved[block].held)
        return [a * b for a, b in zip(ahead, reversed(behind), strict=True)] if blocks else []

    def _aside(self, name: str, block: GraphBlock[Quotient]) -> ProgramNode:
        """Product, a program node, of the determinants of all blocks below a held coordinate but one block."""
        return self._ground(name).below * self._hanging(name, block)

    def _carried(self, end: str) -> ProgramNode:
        """Product (program node) of the blocks' angle numerators to ``end`` and of the determinants off that path."""
        result = self.beside
        for block, far in self.tree.path(end):
            result = result * self.solved[block].carried(far) * self._aside(block.top, block)
        return result

    def motion(self, end: str) -> ProgramNode:
        """Numerator of the angle at ``end`` under a unit torque at the root, det D times that angle, a program node."""
        return self._carried(end) * self.Q[end]

    def reading(self, row: SymbolRow) -> ProgramNode:
        """Numerator of a sensor's reading under a unit torque at the root, det D times the reading, a program node."""
        row = {name: value for name, value in row.items() if name in self.Q}
        block = self._common(row)
        if block is not None:
            return self._carried(block.top) * self._aside(block.top, block) * self.solved[block].reading(row)
        total = self.program.leaf(0)
        for name, value in row.items():
            total = total + self.program.leaf(value) * self.motion(name)
        return total

    def _common(self, row: SymbolRow) -> GraphBlock[Quotient] | None:
        """Block of the network that contains all coordinates of a row, or None if no block does."""
        found = [self.tree.above[name] for name in row if name in self.tree.above] if len(row) > 1 else []
        return next((block for block in found if block.covers(row)), None)
