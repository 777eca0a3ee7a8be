"""Free end of a drivetrain at which its torsional vibration is measured on board."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

from torsionnet.model.definition import Definition
from torsionnet.model.elements import GROUND


def free_end(definition: Definition) -> str:
    """Name of the node at the free end of the engine: the end of the drivetrain nearest to a cylinder.

    Without an engine with cylinders the first end in the order of the model; without ends the first node.

    Examples
    --------
    >>> import torsionnet as tn
    >>> [free_end(tn.load(name).definition) for name in ("marine_medium_speed", "bulk_carrier")]
    ['free_end', 'c1']
    """
    neighbours = _neighbours(definition)
    ends = [node for node, others in neighbours.items() if len(others) == 1] or list(neighbours)
    far = _distances(neighbours, _cylinder_nodes(definition))
    return min(ends, key=lambda node: far.get(node, len(neighbours)), default="")


def _neighbours(definition: Definition) -> dict[str, set[str]]:
    """Nodes that an element connects with each node, in the order in which the elements name them."""
    neighbours: dict[str, set[str]] = {}
    for element in definition.active:
        nodes = [node for node in element.ports.values() if node != GROUND]
        for node in nodes:
            neighbours.setdefault(node, set())
        for node, other in combinations(nodes, 2):
            neighbours[node].add(other)
            neighbours[other].add(node)
    return neighbours


def _cylinder_nodes(definition: Definition) -> list[str]:
    """Nodes of the cylinders of all engines, or nothing where none runs."""
    each = (getattr(excitation, "cylinders", {}) for excitation in definition.excitations.values())
    return [str(node) for cylinders in each for node in cylinders.values()]


def _distances(neighbours: Mapping[str, set[str]], start: list[str]) -> dict[str, int]:
    """Number of elements between each node and the nearest node to start from, of the nodes connected to one."""
    distances = {node: 0 for node in start if node in neighbours}
    order = list(distances)
    for node in order:
        for other in sorted(neighbours[node]):
            if other not in distances:
                distances[other] = distances[node] + 1
                order.append(other)
    return distances
