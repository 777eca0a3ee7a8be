"""Tree of the blocks of a symbolic network, which are joined to each other at one coordinate each.

A block holds coordinates that laws tie to each other in more than one way, or just two coordinates: everything between
the two ends of a shaft, a gear mesh, the three members of a planetary set. Seen from a root, each block hangs on the
one of its coordinates that is nearest.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain, combinations
from typing import Generic

import networkx as nx

from torsionnet.core.groups import Groups
from torsionnet.symbolic.algebra.network import L, Network, NetworkMember, SymbolRow


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
        found = []
        while end != self.root:
            found.append((self.above[end], end))
            end = self.above[end].top
        return found[::-1]


def orient(network: Network[L], root: str) -> Orientation[L]:
    """Tree of all blocks of a network that are connected to the coordinate ``root``, seen from there."""
    blocks = _blocks(network)
    order = [root]
    above: dict[str, GraphBlock[L]] = {}
    below: dict[str, tuple[GraphBlock[L], ...]] = {}
    hung: set[int] = set()
    for name in order:
        found = []
        for number, (coordinates, members) in blocks.get(name, {}).items():
            if number not in hung:
                others = tuple(other for other in coordinates if other != name)
                found.append(GraphBlock(name, others, members))
                above |= dict.fromkeys(others, found[-1])
                order += others
                hung.add(number)
        below[name] = tuple(found)
    return Orientation(root, tuple(order), above, below)


def _blocks(network: Network[L]) -> dict[str, dict[int, tuple[tuple[str, ...], tuple[NetworkMember[L], ...]]]]:
    """Coordinates and laws of all blocks of a network, by coordinate and by number of the block."""
    wide = [member for member in network.members if len(member.row) > 1]
    graph = nx.Graph(pair for member in wide for pair in combinations(member.row, 2))
    parts = list(nx.biconnected_component_edges(graph))
    home = {frozenset(pair): number for number, part in enumerate(parts) for pair in part}
    members: dict[int, list[NetworkMember[L]]] = {}
    for member in wide:
        first, second, *_ = member.row
        members.setdefault(home[frozenset((first, second))], []).append(member)
    found: dict[str, dict[int, tuple[tuple[str, ...], tuple[NetworkMember[L], ...]]]] = {}
    for number, laws in members.items():
        coordinates = tuple(dict.fromkeys(chain.from_iterable(member.row for member in laws)))
        for name in coordinates:
            found.setdefault(name, {})[number] = coordinates, tuple(laws)
    return found


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
    return all(len(pair) == 2 for pair in pairs) and len(pairs) == len(network.coordinates) - parts
