"""Graph of a drivetrain for a mass-elastic sheet, with inertias of nodes, connections between two, speed ratios."""

from __future__ import annotations

import warnings
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

from torsionnet.base.errors import TorsionnetWarning, UsageError
from torsionnet.drivetrain import Drivetrain
from torsionnet.io.part_descriptions import describe_element_part
from torsionnet.io.unlinear_laws import refuse_laws_of_motion
from torsionnet.model.elements import GROUND, Constraint, Element, Law, Row, Shaft, Values

NODES_PER_CONNECTION = 2
"""Most nodes that a row of a mass-elastic sheet connects, the two ends of a shaft."""
MOST_LISTED_PARTS = 4
"""Parts without a column in a sheet that an error message lists, beyond which it gives their number."""


@dataclass(frozen=True)
class Connection:
    """Spring (N m/rad), damper (N m s/rad) or rigid connection (stiffness None) on theta_first - tau theta_second."""

    name: str
    first: str
    second: str
    tau: Any = 1
    stiffness: float | None = None
    damping: float = 0.0
    loss_factor: float = 0.0
    diameters: tuple[float, float] | None = None

    def from_node(self, node: str) -> Connection:
        """Connection with ``node`` as its first end, and stiffness and damping in SI referred to that node."""
        if node == self.first:
            return self
        factor = float(self.tau) ** 2
        stiffness = None if self.stiffness is None else self.stiffness * factor
        return replace(self, first=self.second, second=self.first, tau=1 / self.tau, stiffness=stiffness,
                       damping=self.damping * factor)  # fmt: skip


@dataclass
class MassElasticGraph:
    """Inertia (kg m^2) and damping to ground (N m s/rad) by node, connections, and speed ratios to one node."""

    inertias: dict[str, float]
    dampings: dict[str, float]
    connections: list[Connection] = field(default_factory=list)
    ratios: dict[str, Any] = field(default_factory=dict)

    @property
    def connections_at(self) -> dict[str, list[Connection]]:
        """Connections between two nodes by node, each listed at both of its ends; those to ground are left out."""
        found: dict[str, list[Connection]] = {node: [] for node in self.inertias}
        for one in self.connections:
            if GROUND not in (one.first, one.second):
                found[one.first].append(one)
                found[one.second].append(one)
        return found


def mass_elastic_graph(drivetrain: Drivetrain, reference: str) -> MassElasticGraph:
    """Graph of a drivetrain as a mass-elastic sheet shows it, with speed ratios relative to the node ``reference``.

    Raises
    ------
    UsageError
        Naming parts that a sheet has no column for.

    Warns
    -----
    TorsionnetWarning
        A shaft is lumped whose inertia is consistent with its twist.
    """
    refuse_laws_of_motion(drivetrain, "a mass-elastic sheet")
    nodes = list(drivetrain.nodes)
    graph = MassElasticGraph(dict.fromkeys(nodes, 0.0), dict.fromkeys(nodes, 0.0))
    value, refused = Values(drivetrain.exact_values), []
    for given in drivetrain.elements.values():
        element = _lumped(given)
        for part in element.parts(value):
            rigid = isinstance(part, Constraint)
            written = (
                _law(graph, element, part, value)
                if isinstance(part, Law)
                else rigid and len(part.row) <= NODES_PER_CONNECTION
            )
            if written and part.row and rigid:
                graph.connections.append(_connected(element.name, part.row))
            refused += [] if written else [describe_element_part(element, part)]
    if refused:
        rest = f" and {len(refused) - MOST_LISTED_PARTS} more" if len(refused) > MOST_LISTED_PARTS else ""
        raise UsageError(f"a mass-elastic sheet has no column for {'; '.join(refused[:MOST_LISTED_PARTS])}{rest}")
    graph.connections = list(_named(graph.connections))
    graph.ratios = _ratios(graph, reference)
    return graph


def _lumped(element: Element) -> Element:
    """Shaft with its inertia lumped on the ends of its segments, as a sheet has only masses and springs."""
    if not isinstance(element, Shaft) or element.inertia != "consistent":
        return element
    text = f"the inertia of {element.name} is lumped at the ends of its segments, which moves natural frequencies"
    warnings.warn(f"{text}; inertia: lumped in the model does the same", TorsionnetWarning, stacklevel=4)
    return replace(element, inertia="lumped")


def _law(graph: MassElasticGraph, element: Element, law: Law, value: Values) -> bool:
    """Add a law of an element to the graph and return whether a mass-elastic sheet can hold the law."""
    if (
        law.table is not None
        or len(law.row) > NODES_PER_CONNECTION
        or (len(law.row) == NODES_PER_CONNECTION and law.inertia != 0)
    ):
        return False
    if not law.row:
        return True
    node, share = next(iter(law.row.items()))
    factor = float(share) ** 2
    inertia, damping, stiffness = (float(one) * factor for one in (law.inertia, law.damping, law.stiffness))
    section = element.diameters
    diameters = None if section is None else (float(value(section[0])), float(value(section[1])))
    if len(law.row) == 1:
        graph.inertias[node] += inertia
        if not stiffness:
            graph.dampings[node] += damping
            return True
    elif not stiffness and not damping:
        return True
    one = _connected(element.name, law.row)
    lossy = float(law.loss_factor)
    graph.connections.append(replace(one, stiffness=stiffness, damping=damping, loss_factor=lossy, diameters=diameters))
    return True


def _connected(name: str, row: Row) -> Connection:
    (first, share), *rest = row.items()
    if not rest:
        return Connection(name, first, GROUND)
    second, other = rest[0]
    return Connection(name, first, second, -other / (Fraction(share) if isinstance(share, int) else share))


def _named(connections: list[Connection]) -> Iterator[Connection]:
    """Yield the connections with unique names, numbered where one element has several."""
    names = [one.name for one in connections]
    for index, one in enumerate(connections):
        several = names.count(one.name) > 1
        yield replace(one, name=f"{one.name}_{names[:index].count(one.name) + 1}") if several else one


def _ratios(graph: MassElasticGraph, reference: str) -> dict[str, Any]:
    """Speed of every node over that of the reference, by node, or UsageError where nothing or two things tell it."""
    ratios: dict[str, Any] = {reference: Fraction(1)}
    at, waiting = graph.connections_at, deque([reference])
    while waiting:
        node = waiting.popleft()
        for one in at[node]:
            there = one.from_node(node)
            speed = ratios[node] / there.tau
            if there.second not in ratios:
                ratios[there.second] = speed
                waiting.append(there.second)
            elif abs(float(ratios[there.second] / speed) - 1) > 1e-9:
                raise UsageError(
                    f"the ratio of {one.name} is not that of the speeds of its nodes by another way through the plant; "
                    "a sheet has one speed for each mass, so switch one of the ways off"
                )
    unconnected = [node for node in graph.inertias if node not in ratios]
    if unconnected:
        raise UsageError(
            f"nothing connects {unconnected[0]} with {reference} in this configuration; a sheet holds one plant"
        )
    return ratios
