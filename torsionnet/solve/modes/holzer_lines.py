"""The order in which a Holzer table goes through a drivetrain: a main line, and branches that join it.

Two nodes with a spring, a shaft, a gear or a rigid coupling between them follow each other. What closes a loop, and
what ties three nodes, as planetary sets do, is not followed: its torque counts where it acts.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from torsionnet.solve.modes.holzer_balance import NodeLoad

Neighbours = Mapping[str, Mapping[str, tuple[NodeLoad, ...]]]
"""Node -> node next to it -> what lies between."""


@dataclass(frozen=True)
class HolzerLine:
    """Nodes from a free end on; ``joins`` is the node after the last one, empty for a main line."""

    nodes: tuple[str, ...]
    joins: str = ""

    def steps(self) -> Iterator[tuple[str, str]]:
        """Every node with the one after it, empty after the last of a main line."""
        yield from zip(self.nodes, (*self.nodes[1:], self.joins), strict=True)


def lines(nodes: Sequence[str], loads: Iterable[NodeLoad], first: str | None) -> tuple[list[HolzerLine], Neighbours]:
    """Main lines and branches, each branch behind the line it joins, and what lies between neighbours."""
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
    """Pairs of nodes that are next to each other, without those that would close a loop."""
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
    """The free end that stands first in the model."""
    there = set(_reached(tree, node))
    return next((one for one in nodes if one in there and len(tree[one]) == 1), node)


def _reached(tree: Neighbours, node: str) -> Iterator[str]:
    stack: list[tuple[str, str]] = [(node, "")]
    while stack:
        here, before = stack.pop()
        yield here
        stack += [(other, here) for other in tree[here] if other != before]


def _farthest(tree: Neighbours, start: str, barred: set[str]) -> list[str]:
    """The longest way from a node that passes none of the barred ones."""
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
