"""Graph of a drivetrain with nodes and connections, for drawings and connectivity."""

from __future__ import annotations

from itertools import combinations, pairwise
from typing import TYPE_CHECKING

from torsionnet.model.elements import Element

if TYPE_CHECKING:
    from collections.abc import Iterator

    import networkx as nx

    from torsionnet.model.model import Model


def graph(drivetrain: Model) -> nx.MultiGraph[str]:
    """Graph of the drivetrain (networkx): its nodes, and an edge for each pair of ports that an element connects.

    Node ``ground`` is there if an element is attached to it. Elements with one port are in the node attribute
    ``elements``; edges carry ``element``, which is their key, too, and ``kind``.

    Examples
    --------
    >>> import torsionnet as tn
    >>> graph = tn.load("dmf_rig").graph()
    >>> sorted(graph["motor"]["primary"])
    ['torque_meter']
    >>> graph.nodes["secondary"]["elements"]
    ('clamp',)
    """
    import networkx as nx

    graph: nx.MultiGraph[str] = nx.MultiGraph(name=drivetrain.title)
    alone: dict[str, list[str]] = {node: [] for node in drivetrain.nodes}
    graph.add_nodes_from(drivetrain.nodes)
    for element in drivetrain.elements.values():
        for first, second in connections(element):
            graph.add_edge(first, second, key=element.name, element=element.name, kind=element.kind)
        if len(element.ports) == 1:
            alone[next(iter(element.ports.values()))].append(element.name)
    for node in graph:
        graph.nodes[node]["elements"] = tuple(alone.get(node, ()))
    return graph


def connections(element: Element) -> Iterator[tuple[str, str]]:
    """Pairs of nodes that an element connects; along the stations of a shaft in segments, else every pair of ports.

    Two ports on one node are no connection.
    """
    ends = list(element.ports.values())
    if element.internal_nodes:
        yield from pairwise((ends[0], *element.internal_nodes, ends[-1]))
    else:
        yield from ((first, second) for first, second in combinations(dict.fromkeys(ends), 2) if first != second)
