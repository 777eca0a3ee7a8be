"""Lines of a Holzer table through a drivetrain, a main line, and branches that join it.

Two nodes with a spring, a shaft, a gear or a rigid coupling between them follow each other. Elements that close a loop
or tie three nodes, as planetary sets do, are not followed: their torques count at their nodes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from torsionnet.machinery.holzer.holzer_balance import NodeLoad

Neighbours = Mapping[str, Mapping[str, tuple[NodeLoad, ...]]]
"""Torques of the elements between two neighbouring nodes, by node and neighbour."""


@dataclass(frozen=True)
class HolzerLine:
    """Names of the nodes on a line of a Holzer table from its free end, and of the node that a branch joins.

    ``joins`` is empty for a main line.
    """

    nodes: tuple[str, ...]
    joins: str = ""

    def steps(self) -> Iterator[tuple[str, str]]:
        """Yield every node with its successor, which is empty after the last node of a main line."""
        yield from zip(self.nodes, (*self.nodes[1:], self.joins), strict=True)


def holzer_lines(
    nodes: Sequence[str], loads: Iterable[NodeLoad], first: str | None
) -> tuple[list[HolzerLine], Neighbours]:
    """Main lines and branches of a Holzer table, by names of nodes, and the torque laws between neighbouring nodes."""
    tree = _tree(nodes, loads)
    found: list[HolzerLine] = []
    seen: set[str] = set()
    for node in ([first] if first else []) + list(nodes):
        if node not in seen:
            start = node if node == first else _first_end(tree, node, nodes)
            main = _farthest(tree, start, set())
            found += _with_branches(tree, HolzerLine(tuple(main)), set(main))
            seen |= {one for line in found for one in line.nodes}
    return found, tree


def _tree(nodes: Sequence[str], loads: Iterable[NodeLoad]) -> dict[str, dict[str, tuple[NodeLoad, ...]]]:
    """Torques between neighbouring nodes, by node and neighbour, without elements that would close a loop."""
    tree: dict[str, dict[str, tuple[NodeLoad, ...]]] = {node: {} for node in nodes}
    home = {node: node for node in nodes}
    for load in loads:
        if len(load.ends) != 2:
            continue
        one, other = load.ends
        if other in tree[one]:
            tree[one][other] = tree[other][one] = (*tree[one][other], load)
        elif _root(home, one) != _root(home, other):
            home[_root(home, one)] = _root(home, other)
            tree[one][other] = tree[other][one] = (load,)
    return tree


def _root(home: dict[str, str], node: str) -> str:
    while home[node] != node:
        home[node] = home[home[node]]
        node = home[node]
    return node


def _first_end(tree: Neighbours, node: str, nodes: Sequence[str]) -> str:
    """Name of the first free end, in the order of the model, among the nodes connected to a node."""
    there = set(_connected(tree, node))
    return next((one for one in nodes if one in there and len(tree[one]) == 1), node)


def _connected(tree: Neighbours, node: str) -> Iterator[str]:
    stack: list[tuple[str, str]] = [(node, "")]
    while stack:
        here, before = stack.pop()
        yield here
        stack += [(other, here) for other in tree[here] if other != before]


def _farthest(tree: Neighbours, start: str, barred: set[str]) -> list[str]:
    """Names of the nodes on the longest path from a node that passes no barred node."""
    before = {start: ""}
    order = [start]
    for node in order:
        for other in tree[node]:
            if other not in before and other not in barred:
                before[other] = node
                order.append(other)
    node, way = order[-1], []
    while node:
        way.append(node)
        node = before[node]
    return way[::-1]


def _with_branches(tree: Neighbours, line: HolzerLine, taken: set[str]) -> Iterator[HolzerLine]:
    yield line
    for node in line.nodes:
        for other in tree[node]:
            if other not in taken:
                way = _farthest(tree, other, taken)[::-1]
                taken |= set(way)
                yield from _with_branches(tree, HolzerLine(tuple(way), joins=node), taken)
