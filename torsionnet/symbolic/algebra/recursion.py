"""Recursion without division on a tree of blocks, for a network's determinant and the readings of sensors.

Below a coordinate v hang blocks, each with its determinants A_b and Q_b for v free and held (see
:mod:`torsionnet.symbolic.algebra.deletion_contraction` for loops). With g_v the dynamic stiffness to ground,

    Q_v = prod Q_b,   A_v = g_v Q_v + sum_b A_b prod_{b' != b} Q_b'

det D = A_root, and for the torque at the root and the motion at j

    adj_j = prod_path(motion carried through the block) * prod_{blocks hanging off the path} Q_b * Q_j

without a subtraction or division where every block is a single edge: every coefficient of the expanded result is
positive where the ratios are.

Tree of the blocks of a symbolic network, which are joined to each other at one coordinate each.

A block holds coordinates that laws tie to each other in more than one way, or just two coordinates: everything between
the two ends of a shaft, a gear mesh, the three members of a planetary set. Seen from a root, each block hangs on the
one of its coordinates that is nearest.

Determinants of a block of laws between two coordinates, recorded without a division.

With rows a_e = (a_ev, a_ec) of the laws y_e between a coordinate v and a coordinate c below it, and A_c and Q_c the
determinants of what hangs on c, with c free and held,

    held at v    Q = A_c + sum_e y_e a_ec^2 Q_c
    free at v    A = sum_e y_e a_ev^2 A_c + sum_{e<f} y_e y_f (a_ev a_fc - a_fv a_ec)^2 Q_c
    motion of c  -sum_e y_e a_ev a_ec Q_c

under a unit torque on v (Cauchy-Binet). A shaft with inertia of its own has the two rows (1, -1) and (1, 1).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain, combinations
from typing import Any, Generic, Protocol, TypeAlias

import networkx as nx

from torsionnet.base.program import Program, ProgramNode
from torsionnet.base.registers import Groups
from torsionnet.symbolic.algebra.network import L, Network, NetworkMember, Stiffness, SymbolRow, vanishes


@dataclass(frozen=True, eq=False)
class GraphBlock(Generic[L]):
    """Block of a symbolic network, the laws over its coordinate ``top`` (nearest to the root) and those ``below``."""

    top: str
    below: tuple[str, ...]
    members: tuple[NetworkMember[L], ...]

    @property
    def is_bundle(self) -> bool:
        """Whether all laws of a network's block act between the same two coordinates."""
        return len(self.below) == 1

    def covers(self, row: SymbolRow) -> bool:
        """Whether all coordinates of a row of the network belong to the block."""
        return all(name == self.top or name in self.below for name in row)


@dataclass(frozen=True, eq=False)
class Orientation(Generic[L]):
    """Tree of a network's blocks seen from a root coordinate, with the blocks above and below every coordinate."""

    root: str
    order: tuple[str, ...]
    above: Mapping[str, GraphBlock[L]]
    below: Mapping[str, tuple[GraphBlock[L], ...]]

    def path(self, end: str) -> list[tuple[GraphBlock[L], str]]:
        """Blocks of a network from the root to a coordinate, each with the coordinate at which the path leaves it."""
        steps = []
        while end != self.root:
            steps.append((self.above[end], end))
            end = self.above[end].top
        return steps[::-1]


def orient(network: Network[L], root: str) -> Orientation[L]:
    """Tree of all blocks of a network that are connected to the coordinate ``root``, seen from there."""
    blocks = _blocks(network)
    order = [root]
    above: dict[str, GraphBlock[L]] = {}
    below: dict[str, tuple[GraphBlock[L], ...]] = {}
    hung: set[int] = set()
    for name in order:
        hanging = []
        for number, (coordinates, members) in blocks.get(name, {}).items():
            # A block hangs on that coordinate of it which is reached first.
            if number not in hung:
                others = tuple(other for other in coordinates if other != name)
                hanging.append(GraphBlock(name, others, members))
                above |= dict.fromkeys(others, hanging[-1])
                order += others
                hung.add(number)
        below[name] = tuple(hanging)
    return Orientation(root, tuple(order), above, below)


def _blocks(network: Network[L]) -> dict[str, dict[int, tuple[tuple[str, ...], tuple[NetworkMember[L], ...]]]]:
    """Coordinates and laws of all blocks of a network, by coordinate and by number of the block."""
    wide = [member for member in network.members if len(member.row) > 1]
    # A law over three coordinates is a triangle here, which no cut parts, so that it stays in one block.
    graph = nx.Graph(pair for member in wide for pair in combinations(member.row, 2))
    parts = list(nx.biconnected_component_edges(graph))
    home = {frozenset(pair): number for number, part in enumerate(parts) for pair in part}
    members: dict[int, list[NetworkMember[L]]] = {}
    for member in wide:
        first, second, *_ = member.row
        members.setdefault(home[frozenset((first, second))], []).append(member)
    blocks: dict[str, dict[int, tuple[tuple[str, ...], tuple[NetworkMember[L], ...]]]] = {}
    for number, laws in members.items():
        coordinates = tuple(dict.fromkeys(chain.from_iterable(member.row for member in laws)))
        for name in coordinates:
            blocks.setdefault(name, {})[number] = coordinates, tuple(laws)
    return blocks


def roots_of(network: Network[L], first: str = "") -> list[str]:
    """Root coordinate of every connected part of a symbolic network; ``first`` is the root of its own part."""
    parts = Groups(network.coordinates)
    for member in network.members:
        parts.join(*member.row)
    roots: dict[int, str] = {}
    for name in (first, *network.coordinates) if first else network.coordinates:
        roots.setdefault(id(parts.of(name)), name)
    return list(roots.values())


def is_forest(network: Network[L]) -> bool:
    """Whether a network has no closed loop, so that all its blocks are laws between two coordinates."""
    pairs = {frozenset(member.row) for member in network.members if len(member.row) > 1}
    parts = len(roots_of(network))
    # A forest has as many edges as coordinates, less one for each of its trees.
    return all(len(pair) == 2 for pair in pairs) and len(pairs) == len(network.coordinates) - parts


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
        # a / b + r^2 c / d = (a d + r^2 c b) / (b d)
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
        # Q = A_c + sum_e y_e a_ec^2 Q_c
        far = self._sum([row[self._child] ** 2 for row in self._rows])
        return self.hanging.above * self._below() + far * self.hanging.below

    @cached_property
    def free(self) -> ProgramNode:
        """Dynamic stiffness determinant of block and parts beyond, upper coordinate free, as a program node."""
        # A = sum_e y_e a_ev^2 A_c + sum_{e<f} y_e y_f (a_ev a_fc - a_fv a_ec)^2 Q_c
        total = self._sum([row[self.block.top] ** 2 for row in self._rows]) * self.hanging.above
        both = self._pairs()
        return total if both.is_zero else total + both * self.hanging.below

    def carried(self, end: str) -> ProgramNode:
        """Numerator (program node) of the lower coordinate's angle, no parts beyond, under unit torque on the upper."""
        return self._sum([-row[self.block.top] * row[end] for row in self._rows])

    def reading(self, row: SymbolRow) -> ProgramNode:
        """Numerator (program node) of a sensor's reading in the block under a unit torque on the upper coordinate."""
        near, far = row.get(self.block.top, 0), row.get(self._child, 0)
        # near A_c + sum_e y_e a_ec (near a_ec - far a_ev) Q_c, with the motions of v and c under a torque on v
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
        for (i, first), (j, second) in combinations(enumerate(self.block.members), 2):
            # Binet and Cauchy: det of a sum of k a a^T is the sum over pairs of k_i k_j det([a_i a_j])^2.
            across = first.row[top] * second.row[child] - second.row[top] * first.row[child]
            if not vanishes(across):
                both = first.law.above * second.law.above * self._below(i, j)
                total = total + self.program.leaf(across**2) * both
        return total


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
        # Q_v = prod Q_b and A_v = g_v Q_v + sum_b A_b prod_{b' != b} Q_b', with g_v as a quotient.
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
        # Products from both ends, since nothing is divided.
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
        # The motion goes through the blocks on the path, and every block off it is held: its Q.
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
        # Within one block the terms of a twist that would cancel never appear.
        if block is not None:
            return self._carried(block.top) * self._aside(block.top, block) * self.solved[block].reading(row)
        total = self.program.leaf(0)
        for name, value in row.items():
            total = total + self.program.leaf(value) * self.motion(name)
        return total

    def _common(self, row: SymbolRow) -> GraphBlock[Quotient] | None:
        """Block of the network that contains all coordinates of a row, or None if no block does."""
        above = [self.tree.above[name] for name in row if name in self.tree.above] if len(row) > 1 else []
        return next((block for block in above if block.covers(row)), None)
