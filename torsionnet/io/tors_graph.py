"""A drivetrain in the words of TORS: disks on nodes, shafts and gears between them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from itertools import zip_longest
from typing import Any, TypeAlias

from torsionnet.core.errors import UsageError
from torsionnet.drivetrain import Drivetrain
from torsionnet.io.tors_elements import SHEAR_MODULUS
from torsionnet.model.elements import (
    GROUND,
    Damper,
    Element,
    Gear,
    HystereticSpring,
    Inertia,
    Law,
    RigidCoupling,
    Shaft,
    Spring,
    Values,
)
from torsionnet.model.elements.element import viscous

Disks: TypeAlias = dict[str, list[dict[str, Any]]]


@dataclass
class Edge:
    """A connection of two nodes: the items of a shaft from first to second, or a gear."""

    first: str
    second: str
    names: list[str]
    items: list[dict[str, Any]] = field(default_factory=list)
    gear: Gear | None = None
    ratio: float = 1.0

    def other(self, node: str) -> str:
        return self.second if node == self.first else self.first


@dataclass
class Graph:
    """Disks by node, and what connects the nodes."""

    disks: Disks
    edges: list[Edge]

    @cached_property
    def at(self) -> dict[str, list[Edge]]:
        """The edges at every node, in the order of the elements."""
        found: dict[str, list[Edge]] = {node: [] for node in self.disks}
        for edge in self.edges:
            for node in (edge.first, edge.second):
                found[node].append(edge)
        return found


def tors_graph(drivetrain: Drivetrain) -> Graph:
    """The drivetrain in words of the format; UsageError names all elements it has no word for."""
    value = Values(drivetrain.exact_values)
    inside = {node for element in drivetrain.elements.values() for node in element.internal_nodes}
    merged = _merged(drivetrain.elements.values(), [node for node in drivetrain.nodes if node not in inside])
    disks: Disks = {node: [] for node in dict.fromkeys(merged.values())}
    edges: list[Edge] = []
    refused: list[str] = []
    for element in drivetrain.elements.values():
        ends = [merged.get(node, node) for node in element.ports.values()]
        if isinstance(element, RigidCoupling) and GROUND not in ends:
            continue
        if isinstance(element, Inertia):
            disks[ends[0]].append(_disk(element.name, inertia=float(value(element.inertia))))
        elif isinstance(element, Damper) and GROUND in ends:
            node = next(end for end in ends if end != GROUND)
            disks[node].append(_disk(element.name, damping=float(value(element.damping))))
        elif GROUND in ends or not isinstance(element, Spring | Damper | Shaft | Gear | HystereticSpring):
            refused.append(f"{element.name} ({element.kind}{' to ground' if GROUND in ends else ''})")
        elif _is_lossy(element, value):
            refused.append(f"{element.name} ({element.kind})")
        elif isinstance(element, Gear):
            _add_gear(element, ends, value, edges, refused)
        elif isinstance(element, Shaft):
            edges.append(Edge(*_two(ends), [element.name], _segments(element, value, disks, ends)))
        else:
            _add_spring(element, ends, value, edges)
    if refused:
        msg = f"TORS has no counterpart of {', '.join(refused)}; it knows disks, shafts and rigid gears in a tree"
        raise UsageError(msg)
    _refuse_loops(disks, edges)
    return Graph(disks, edges)


def _refuse_loops(disks: Disks, edges: list[Edge]) -> None:
    home = {node: node for node in disks}

    def root(node: str) -> str:
        while home[node] != node:
            home[node] = home[home[node]]
            node = home[node]
        return node

    for edge in edges:
        first, second = root(edge.first), root(edge.second)
        if first == second:
            msg = f"{', '.join(edge.names)} closes a loop; TORS holds trees only"
            raise UsageError(msg)
        home[second] = first


def _is_lossy(element: Element, value: Values) -> bool:
    return any(isinstance(part, Law) and bool(part.loss_factor) for part in element.parts(value))


def _two(ends: list[str]) -> tuple[str, str]:
    return ends[0], ends[1]


def _merged(elements: Iterable[Element], nodes: Iterable[str]) -> dict[str, str]:
    """Every node with the one that stands for it: rigid couplings make one of two."""
    home = {node: node for node in nodes}
    for element in elements:
        if isinstance(element, RigidCoupling) and GROUND not in element.nodes:
            first, second = (home[node] for node in element.nodes)
            home = {node: first if other == second else other for node, other in home.items()}
    return home


def _disk(name: str, inertia: float = 0.0, damping: float = 0.0) -> dict[str, Any]:
    return {"name": name, "type": "Disk", "inertia": inertia, "damping": damping}


def _add_spring(element: Any, ends: list[str], value: Values, edges: list[Edge]) -> None:
    """A spring or damper; beside another one on the same nodes it adds to it."""
    stiffness = 0 if isinstance(element, Damper) else value(element.stiffness)
    damping = viscous(element.damping, stiffness, value)
    same = [edge for edge in edges if {edge.first, edge.second} == set(ends) and len(edge.items) == 1]
    for edge in same:
        shaft = edge.items[0]
        if shaft["type"] == "ShaftDiscrete":
            shaft["stiffness"] += float(stiffness)
            shaft["damping"] += float(damping)
            edge.names.append(element.name)
            return
    numbers = {"stiffness": float(stiffness), "damping": float(damping)}
    edges.append(Edge(*_two(ends), [element.name], [{"name": element.name, "type": "ShaftDiscrete", **numbers}]))


def _segments(shaft: Shaft, value: Values, disks: Disks, ends: list[str]) -> list[dict[str, Any]]:
    """Shafts, and where the inertia is lumped the disks between them; those at the ends go to the nodes."""
    n, laws = int(shaft.segments), [part for part in shaft.parts(value) if isinstance(part, Law)]
    names = [shaft.name if n == 1 else f"{shaft.name} {index}" for index in range(1, n + 1)]
    elastic = next(law for law in laws if law.is_elastic)
    if shaft.inertia == "consistent":
        item = _continuous(shaft, value, n)
        item |= {"damping": float(elastic.damping)} if elastic.damping else {}
        return [{"name": name, **item} for name in names]
    numbers = {"stiffness": float(elastic.stiffness), "damping": float(elastic.damping)}
    shafts = [{"name": name, "type": "ShaftDiscrete", **numbers} for name in names]
    lump = max(float(law.inertia) for law in laws)
    if not lump:
        return shafts
    for end in ends:
        disks[end].append(_disk(f"{shaft.name} at {end}", inertia=lump))
    between = [_disk(f"{shaft.name} lump {index}", inertia=2 * lump) for index in range(1, n)]
    return [item for pair in zip_longest(shafts, between) for item in pair if item]


def _continuous(shaft: Shaft, value: Values, n: int) -> dict[str, Any]:
    """A segment of equal stiffness and inertia with the modulus that the format takes for granted."""
    outer, inner, length = (
        1e3 * float(value(size)) for size in (shaft.outer_diameter, shaft.inner_diameter, shaft.length)
    )
    stretch = SHEAR_MODULUS / float(value(shaft.shear_modulus))
    return {
        "type": "ShaftContinuous",
        "length": length / n * stretch,
        "outerDiameter": outer,
        "innerDiameter": inner,
        "density": float(value(shaft.density)) / stretch,
    }


def _add_gear(gear: Gear, ends: list[str], value: Values, edges: list[Edge], refused: list[str]) -> None:
    if gear.stiffness is not None or gear.housing is not None:
        refused.append(f"{gear.name} ({'compliant mesh' if gear.stiffness is not None else 'moving housing'})")
        return
    ratio = float(gear.ratio_value(dict(value.parameters)))
    edges.append(Edge(*_two(ends), [gear.name], gear=gear, ratio=ratio))
