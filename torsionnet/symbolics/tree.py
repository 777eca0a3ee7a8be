"""The division-free recursion on a forest.

With g_v the dynamic stiffness to ground at coordinate v, and a child edge of dynamic stiffness y on the motion
alpha theta_v + beta theta_c,

    F_c = A_c + beta^2 y Q_c,   Q_v = prod F_c,   A_v = g_v Q_v + sum_c alpha^2 y A_c prod_{c' != c} F_c'

det D = A_root, and for the torque at the root and the motion at j

    adj_j = prod_path(-alpha beta y) * prod_{subtrees hanging off the path} F * Q_j

without a subtraction or division: every coefficient of the expanded result is positive where the ratios are. The twist
along an edge alone needs no subtraction either, alpha theta_v + beta theta_c being alpha A_c where theta_v has F_c.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from torsionnet.symbolics.network import Edge, Graph, SymbolRow, vanishes
from torsionnet.symbolics.program import Node, Program


@dataclass(frozen=True)
class Branch:
    """An edge as seen from the root: parent, child, and y with its row."""

    parent: str
    child: str
    law: Any
    near: Any
    far: Any


@dataclass(frozen=True)
class Orientation:
    """The tree that hangs on a root: coordinates from the root outwards, and the edges between them."""

    root: str
    order: tuple[str, ...]
    above: Mapping[str, Branch]
    below: Mapping[str, tuple[Branch, ...]]

    def path(self, end: str) -> list[Branch]:
        """Edges from the root to a coordinate."""
        found = []
        while end != self.root:
            found.append(self.above[end])
            end = found[-1].parent
        return found[::-1]


def orient(graph: Graph, root: str) -> Orientation:
    """Hang the tree of ``root`` on it."""
    attached = _attached(graph.edges)
    order = [root]
    above: dict[str, Branch] = {}
    below: dict[str, tuple[Branch, ...]] = {}
    for name in order:
        branches = []
        for edge in attached.get(name, ()):
            other = edge.second if edge.first == name else edge.first
            if name in above and above[name].parent == other:
                continue
            branch = Branch(name, other, edge.law, *edge.coefficients(name))
            branches.append(branch)
            above[other] = branch
            order.append(other)
        below[name] = tuple(branches)
    return Orientation(root, tuple(order), above, below)


def _attached(edges: Iterable[Edge]) -> dict[str, list[Edge]]:
    found: dict[str, list[Edge]] = {}
    for edge in edges:
        found.setdefault(edge.first, []).append(edge)
        found.setdefault(edge.second, []).append(edge)
    return found


def recursion(graph: Graph, program: Program, root: str) -> Recursion:
    """The recursion on one tree, taken down once."""
    key = (graph, root)
    if key not in program.memory:
        program.memory[key] = Recursion(graph, program, root)
    found: Recursion = program.memory[key]
    return found


@dataclass
class Recursion:
    """A, Q and F of every coordinate of one tree, taken down in a program."""

    graph: Graph
    program: Program
    root: str
    A: dict[str, Node] = field(default_factory=dict)
    Q: dict[str, Node] = field(default_factory=dict)
    F: dict[str, Node] = field(default_factory=dict)

    @cached_property
    def tree(self) -> Orientation:
        return orient(self.graph, self.root)

    def __post_init__(self) -> None:
        for name in reversed(self.tree.order):
            self._eliminate(name)

    @property
    def determinant(self) -> Node:
        """Det D of this tree."""
        return self.A[self.root]

    def _eliminate(self, name: str) -> None:
        branches = self.tree.below[name]
        for branch in branches:
            child = branch.child
            self.F[child] = self.A[child] + self._stiffness(branch, branch.far**2) * self.Q[child]
        others = self._products_without_one([branch.child for branch in branches])
        self.Q[name] = self._hanging(name)
        total = self.program.leaf(self.graph.grounds[name]) * self.Q[name] if name in self.graph.grounds else None
        for branch, rest in zip(branches, others, strict=True):
            term = self._stiffness(branch, branch.near**2) * self.A[branch.child] * rest
            total = term if total is None else total + term
        self.A[name] = self.program.leaf(0) if total is None else total

    def _stiffness(self, branch: Branch, factor: Any) -> Node:
        y = self.program.leaf(branch.law)
        return y if factor == 1 else self.program.leaf(factor) * y

    def _hanging(self, name: str, without: str = "") -> Node:
        result = self.program.leaf(1)
        for branch in self.tree.below[name]:
            if branch.child != without:
                result = result * self.F[branch.child]
        return result

    def _products_without_one(self, children: Sequence[str]) -> list[Node]:
        ahead, behind = [self.program.leaf(1)], [self.program.leaf(1)]
        for child in children[:-1]:
            ahead.append(ahead[-1] * self.F[child])
        for child in reversed(children[1:]):
            behind.append(behind[-1] * self.F[child])
        return [a * b for a, b in zip(ahead, reversed(behind), strict=True)] if children else []

    def _carried(self, end: str) -> Node:
        """Product along the path to ``end``, with all that hangs off it."""
        result = self.program.leaf(1)
        for branch in self.tree.path(end):
            passed = self._stiffness(branch, -branch.near * branch.far)
            result = result * passed * self._hanging(branch.parent, branch.child)
        return result

    def motion(self, end: str) -> Node:
        """Det D times the angle at ``end`` under a unit torque at the root."""
        return self._carried(end) * self.Q[end]

    def reading(self, row: SymbolRow) -> Node:
        """Det D times row theta under a unit torque at the root; other trees do not move."""
        row = {name: value for name, value in row.items() if name in self.Q}
        twist = self._twist(row)
        if twist is not None:
            return twist
        total = self.program.leaf(0)
        for name, value in row.items():
            total = total + self.program.leaf(value) * self.motion(name)
        return total

    def _twist(self, row: SymbolRow) -> Node | None:
        """The reading along an edge, without a subtraction."""
        if len(row) != 2:  # noqa: PLR2004
            return None
        for child in row:
            branch = self.tree.above.get(child)
            if branch and branch.parent in row and vanishes(row[branch.parent] * branch.far - row[child] * branch.near):
                scale = row[branch.parent]
                carried = self._carried(branch.parent) * self._hanging(branch.parent, child)
                return carried * self.program.leaf(scale) * self.A[child]
        return None


def roots_of(graph: Graph, first: str = "") -> list[str]:
    """One root for every tree of a forest; that of the tree with ``first`` is ``first``."""
    left = dict.fromkeys([first, *graph.coordinates] if first else graph.coordinates)
    roots = []
    while left:
        root = next(iter(left))
        roots.append(root)
        for name in orient(graph, root).order:
            left.pop(name, None)
    return roots


def determinant(graph: Graph, program: Program, first: str = "") -> Node:
    """Det D of a forest."""
    result = program.leaf(1)
    for root in roots_of(graph, first):
        result = result * recursion(graph, program, root).determinant
    return result


def bilinear(graph: Graph, program: Program, reading: SymbolRow, load: SymbolRow) -> Node:
    """Reading^T adj(D) load of a forest."""
    total = program.leaf(0)
    for root, share in load.items():
        part = recursion(graph, program, root).reading(reading)
        for other in roots_of(graph, root)[1:]:
            part = part * recursion(graph, program, other).determinant
        total = total + program.leaf(share) * part
    return total
