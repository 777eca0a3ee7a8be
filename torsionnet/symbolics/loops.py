"""Closed loops: deletion and contraction of the edges that close them, down to forests.

det(D + y a a^T) = det D + y a_v^2 det(D on the motions with a = 0), and so for every bilinear form of the adjugate:
one law less in the first term, one coordinate less in the second. Laws over three or more coordinates are taken apart
in the same way. More than a few loops are left to sympy's characteristic polynomial.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from torsionnet.symbolics.network import Edge, Graph, Member, Network, SymbolRow
from torsionnet.symbolics.program import Node, Program
from torsionnet.symbolics.tree import bilinear, determinant

MOST_LOOPS = 3
MOST_FORESTS = 2000
"""Forests that deletion and contraction may lead to."""


@dataclass(frozen=True)
class Forest:
    """A forest, the product of the laws contracted on the way to it, and the rows asked about."""

    factor: Node
    graph: Graph
    rows: tuple[SymbolRow, ...]


class TooManyLoopsError(Exception):
    """Deletion and contraction would lead to too many forests."""


def forests(network: Network, rows: Sequence[SymbolRow], program: Program) -> list[Forest]:
    """The forests whose determinants, times their factors, add up to that of the network."""
    if len(closing(network.graph)) > MOST_LOOPS:
        raise TooManyLoopsError
    found = []
    for forest in _split(network, tuple(rows), program.leaf(1), program):
        found.append(forest)
        if len(found) > MOST_FORESTS:
            raise TooManyLoopsError
    return found


def _split(network: Network, rows: tuple[SymbolRow, ...], factor: Node, program: Program) -> Iterator[Forest]:
    graph = network.graph
    loops = closing(graph)
    if not loops:
        yield Forest(factor, graph, rows)
        return
    network = graph.network
    member = next(m for m in network.members if m.row == loops[0].row and m.law == loops[0].law)
    rest = network.without(member)
    yield from _split(rest, rows, factor, program)
    contraction = rest.contracted(member.row)
    weight = factor * program.leaf(member.law) * program.leaf(contraction.factor)
    yield from _split(contraction.network, tuple(contraction.row(row) for row in rows), weight, program)


def closing(graph: Graph) -> list[Member]:
    """Laws over more than two coordinates, and edges beyond a spanning forest.

    Edges between the same two coordinates go together; where several do, they are in the forest if they can be.
    """
    home = {name: name for name in graph.coordinates}

    def top(name: str) -> str:
        while home[name] != name:
            name = home[name]
        return name

    together: dict[frozenset[str], list[Edge]] = {}
    for edge in graph.edges:
        together.setdefault(frozenset((edge.first, edge.second)), []).append(edge)
    found = list(graph.wide)
    for edges in sorted(together.values(), key=len, reverse=True):
        first, second = top(edges[0].first), top(edges[0].second)
        if first == second:
            found += [edge.member for edge in edges]
        home[first] = second
    return found


def network_determinant(network: Network, program: Program, first: str = "") -> Node:
    """Det D of any network."""
    try:
        parts = forests(network, (), program)
    except TooManyLoopsError:
        from torsionnet.symbolics.charpoly import charpoly_determinant

        return charpoly_determinant(network, program)
    total = program.leaf(0)
    for forest in parts:
        root = first if first in forest.graph.coordinates else ""
        total = total + forest.factor * determinant(forest.graph, program, root)
    return total


def network_bilinear(network: Network, program: Program, reading: SymbolRow, load: SymbolRow) -> Node:
    """Reading^T adj(D) load of any network."""
    try:
        parts = forests(network, (reading, load), program)
    except TooManyLoopsError:
        from torsionnet.symbolics.charpoly import charpoly_bilinear

        return charpoly_bilinear(network, program, reading, load)
    total = program.leaf(0)
    for forest in parts:
        total = total + forest.factor * bilinear(forest.graph, program, *forest.rows)
    return total
