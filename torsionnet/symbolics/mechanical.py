"""The continued fraction an engineer writes by hand.

Seen from the root, a branch with the edge y and Z_c behind it is as flexible as both in series,

    1/Z_branch = 1/y + 1/Z_c,   Z_v = g_v + sum of Z_branch,

and a motion is handed on along the path by y/(y + Z_c). Where nothing but one branch hangs on a coordinate its
receptance is that of the branch: ``theta_1/T_T = 1/(k_1 + c_1 s) + 1/(I_2 s^2 + (c_2 + c_B) s + k_2)``.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from typing import Any

from torsionnet.symbolics.loops import closing
from torsionnet.symbolics.network import Graph, SymbolRow, vanishes
from torsionnet.symbolics.readings import Mechanism, Part
from torsionnet.symbolics.tree import Branch, Strand, orient, roots_of


class NoContinuedFractionError(Exception):
    """The drivetrain or the question is not that of a tree."""


def only(branch: Branch) -> Strand:
    """The law of a branch that has one.

    Raises
    ------
    NoContinuedFractionError
        Laws on several motions between the same two coordinates have no flexibility in series.
    """
    if len(branch.strands) != 1:
        raise NoContinuedFractionError
    return branch.strands[0]


@dataclass
class Continued:
    """Receptances of every coordinate of the tree on ``root``, seen from there.

    ``element`` turns laws and ratios into what the fraction is made of: sympy expressions, or steps of a program.
    """

    graph: Graph
    root: str
    element: Callable[[Any], Any]
    receptance: dict[str, Any] = field(default_factory=dict)
    flexibility: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.tree = orient(self.graph, self.root)
        for name in reversed(self.tree.order):
            self._eliminate(name)

    def _eliminate(self, name: str) -> None:
        """None stands for a coordinate nothing holds, and for a branch that holds nothing."""
        branches = [b for b in self.tree.below[name] if self.receptance[b.child] is not None]
        for branch in branches:
            series = self._inverse(branch) + self._squared(only(branch).far) * self.receptance[branch.child]
            self.flexibility[branch.child] = series / self._squared(only(branch).near)
        found = [self.flexibility[branch.child] for branch in branches]
        ground = self.graph.grounds.get(name)
        if ground is None and len(found) == 1:
            self.receptance[name] = found[0]
            return
        total = None if ground is None else self.element(ground)
        for flexibility in found:
            total = self._one / flexibility if total is None else total + self._one / flexibility
        self.receptance[name] = None if total is None else self._one / total

    @property
    def _one(self) -> Any:
        return self.element(1)

    def _inverse(self, branch: Branch) -> Any:
        return self._one / self.element(only(branch).law)

    def _squared(self, coefficient: Any) -> Any:
        return self.element(coefficient**2)

    def motion(self, end: str) -> Any:
        """Motion at ``end`` over motion at the root."""
        result = self._one
        for branch in self.tree.path(end):
            result = result * self._handed_on(branch)
        return result

    def _handed_on(self, branch: Branch) -> Any:
        ratio = self.element(-only(branch).near / only(branch).far)
        receptance = self.receptance[branch.child]
        if receptance is None:
            return ratio
        y = self.element(only(branch).law) * self._squared(only(branch).far)
        return ratio * (y / (y + self._one / receptance))

    def reading(self, row: SymbolRow, law: Any = None) -> Any:
        """Row theta, times a law, over the motion at the root."""
        row = {name: value for name, value in row.items() if name in self.tree.below}
        for child in row if len(row) == 2 else ():  # noqa: PLR2004
            branch = self.tree.above.get(child)
            if (
                branch
                and branch.parent in row
                and vanishes(row[branch.parent] * only(branch).far - row[child] * only(branch).near)
            ):
                return self._torque(branch, row[branch.parent], law)
        total = self.element(0)
        for name, value in row.items():
            total = total + self.element(value) * self.motion(name)
        return total if law is None else self.element(law) * total

    def _torque(self, branch: Branch, scale: Any, law: Any) -> Any:
        """The law times the twist of an edge, times scale over the coefficient of the parent."""
        if branch.child not in self.flexibility:
            return self.element(0)
        carried = self.motion(branch.parent) * self.element(scale / only(branch).near ** 2)
        torque = carried * (self._one / self.flexibility[branch.child])
        if law is not None and law == only(branch).law:
            return torque
        twist = torque / self.element(only(branch).law)
        return twist if law is None else twist * self.element(law)


def response(
    mechanism: Mechanism, parts: Collection[Part], node: str, element: Callable[[Any], Any], *, shift: bool = False
) -> tuple[Any, Any]:
    """(A reading over the motion at the root, the receptance at the root) under a torque on a node.

    With ``shift``, a torque on a coordinate without inertia is moved along the only edge there, to where it arrives.

    Raises
    ------
    NoContinuedFractionError
        There are closed loops, or the torque acts on several coordinates.
    """
    found = mechanism.reduced([mechanism.row({node: 1})])
    graph, load = found.network.graph, found.rows[0]
    if len(load) != 1 or closing(graph):
        raise NoContinuedFractionError
    ((root, share),) = load.items()
    rows = [mechanism.reduced([mechanism.row(part.row)]).rows[0] for part in parts]
    if shift and not any(part.rigid is not None for part in parts):
        root, share = _arrival(graph, root, share, {name for row in rows for name in row})
    tree = Continued(graph, root, element)
    if tree.receptance[root] is None:
        raise NoContinuedFractionError
    total = element(0)
    for part, row in zip(parts, rows, strict=True):
        if part.rigid is None:
            value = tree.reading(row, part.law)
        else:
            value = _handed_through(mechanism, part.rigid, tree, node, element)
        for _ in range(part.power):
            value = value * element("s")
        total = total + element(part.factor) * value
    return total, element(share) * tree.receptance[root]


def _arrival(graph: Graph, root: str, share: Any, read: Collection[str]) -> tuple[str, Any]:
    """Where a torque on a coordinate that holds nothing itself arrives, short of what is read."""
    came = ""
    while root not in graph.grounds and root not in read:
        edges = [
            edge for edge in graph.edges if root in (edge.first, edge.second) and came not in (edge.first, edge.second)
        ]
        if len(edges) != 1:
            break
        near, far = edges[0].coefficients(root)
        came, root = root, edges[0].second if edges[0].first == root else edges[0].first
        share = -far / near * share
    return root, share


def _handed_through(mechanism: Mechanism, rigid: int, tree: Continued, node: str, element: Callable[[Any], Any]) -> Any:
    """The torque a rigid connection hands on: what the side away from the root answers to its motion there."""
    found = mechanism.reduced([mechanism.row({node: 1})], rigid)
    graph, (load, row) = found.network.graph, found.rows
    near = set(orient(graph, next(iter(load))).order) if len(load) == 1 else set()
    away = [name for name in row if name not in near]
    if closing(graph) or len(away) != 1 or away[0] not in roots_of(graph, away[0]):
        raise NoContinuedFractionError
    side = Continued(graph, away[0], element)
    receptance = side.receptance[away[0]]
    if receptance is None:
        return element(0)
    moved = mechanism.reduced([{away[0]: row[away[0]] ** 0}]).rows[0]
    return element(-1 / row[away[0]]) * tree.reading(moved) / receptance
