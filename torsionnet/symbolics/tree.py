"""The division-free recursion on a forest.

With g_v the dynamic stiffness to ground at coordinate v, and laws y_e on the motions alpha_e theta_v + beta_e theta_c
between v and its child c,

    F_c = A_c + sum_e beta_e^2 y_e Q_c,   Q_v = prod F_c,   A_v = g_v Q_v + sum_c B_c prod_{c' != c} F_c'
    B_c = sum_e alpha_e^2 y_e A_c + sum_{e<f} (alpha_e beta_f - alpha_f beta_e)^2 y_e y_f Q_c

where the second sum, by Cauchy and Binet, is there only if several motions are resisted between the same two
coordinates, as by a shaft with its own inertia. det D = A_root, and for the torque at the root and the motion at j

    adj_j = prod_path(-sum_e alpha_e beta_e y_e) * prod_{subtrees hanging off the path} F * Q_j

On a tree of single laws nothing is subtracted or divided: every coefficient of the expanded result is positive where
the ratios are. The twist along an edge needs no subtraction either: where theta_v has F_c, a theta_v + b theta_c has
a A_c + sum_e (a beta_e - b alpha_e) beta_e y_e Q_c.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations
from typing import Any, NamedTuple

from torsionnet.symbolics.network import Edge, Graph, SymbolRow, vanishes
from torsionnet.symbolics.program import Node, Program


class Strand(NamedTuple):
    """A law on near * theta_parent + far * theta_child."""

    law: Any
    near: Any
    far: Any


@dataclass(frozen=True)
class Branch:
    """All laws between a parent and its child."""

    parent: str
    child: str
    strands: tuple[Strand, ...]

    def crossings(self) -> Iterator[tuple[Strand, Strand, Any]]:
        """Pairs of strands with the square of the determinant of their rows."""
        for e, f in combinations(self.strands, 2):
            yield e, f, (e.near * f.far - f.near * e.far) ** 2


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
        strands: dict[str, list[Strand]] = {}
        for edge in attached.get(name, ()):
            other = edge.second if edge.first == name else edge.first
            if name not in above or above[name].parent != other:
                strands.setdefault(other, []).append(Strand(edge.law, *edge.coefficients(name)))
        below[name] = tuple(Branch(name, other, tuple(found)) for other, found in strands.items())
        above |= {branch.child: branch for branch in below[name]}
        order += strands
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
            self.F[child] = self.A[child] + self._sum(branch, lambda e: e.far**2) * self.Q[child]
        others = self._products_without_one([branch.child for branch in branches])
        self.Q[name] = self._hanging(name)
        total = self.program.leaf(self.graph.grounds[name]) * self.Q[name] if name in self.graph.grounds else None
        for branch, rest in zip(branches, others, strict=True):
            term = self._handed_up(branch) * rest
            total = term if total is None else total + term
        self.A[name] = self.program.leaf(0) if total is None else total

    def _handed_up(self, branch: Branch) -> Node:
        """F_c times the stiffness of the branch at its parent."""
        total = self._sum(branch, lambda e: e.near**2) * self.A[branch.child]
        for e, f, factor in branch.crossings():
            y = self.program.leaf(e.law) * self.program.leaf(f.law) * self.program.leaf(factor)
            total = total + y * self.Q[branch.child]
        return total

    def _sum(self, branch: Branch, factor: Callable[[Strand], Any]) -> Node:
        """Sum of the laws of a branch, each with a factor."""
        total = self.program.leaf(0)
        for strand in branch.strands:
            number = factor(strand)
            if not vanishes(number):
                total = total + self.program.leaf(number) * self.program.leaf(strand.law)
        return total

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
            passed = self._sum(branch, lambda e: -e.near * e.far)
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
            if branch and branch.parent in row:
                a, b = row[branch.parent], row[child]
                passed = self._sum(branch, lambda e, a=a, b=b: (a * e.far - b * e.near) * e.far)  # type: ignore[misc]
                carried = self._carried(branch.parent) * self._hanging(branch.parent, child)
                return carried * (self.program.leaf(a) * self.A[child] + passed * self.Q[child])
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
