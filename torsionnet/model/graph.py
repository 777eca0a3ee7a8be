"""Graph of a drivetrain with nodes and connections, for drawings and connectivity."""

from __future__ import annotations

from itertools import combinations, pairwise
from typing import TYPE_CHECKING

from torsionnet.model.elements import Element

if TYPE_CHECKING:
    from collections.abc import Iterator

    import networkx as nx

    from torsionnet.model.model import Model


def build_graph(drivetrain: Model) -> nx.MultiGraph[str]:
    """Graph of a drivetrain with its nodes, and an edge for each pair of ports that an element connects.

    Parameters
    ----------
    drivetrain : Drivetrain
        Only elements that are switched on take part.

    Returns
    -------
    networkx.MultiGraph
        Node ``ground`` is there if an element is attached to it. The node attribute ``elements`` names the elements
        with one port; the key of an edge and its attribute ``element`` name the element, ``kind`` its type.

    Examples
    --------
    >>> import torsionnet as tn
    >>> graph = build_graph(tn.load("dmf_rig"))
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
