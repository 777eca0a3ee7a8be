"""Topology of a schematic, a spanning tree of its nodes and boxes, and the links that close loops."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, TypeAlias

from torsionnet.model.elements import GROUND, Element, Gear
from torsionnet.plot.drawing.pieces import Owner
from torsionnet.plot.schematics.outlines import DRAGS

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain


# Planetary sets that a model builds from single gears, recognised by their planets and drawn as one box.

MESHES_OF_PLANET = 2  # with the sun and with the ring


@dataclass(frozen=True)
class EpicyclicSet:
    """Planetary set of gears on one moving housing, the carrier, whose planets mesh with a sun and with a ring.

    ``planets`` are the nodes of the planets, ``bodies`` the elements on these nodes alone.
    """

    kind: ClassVar[str] = "epicyclic"
    glyph: ClassVar[str] = "planetary"

    name: str
    ports: Mapping[str, str]
    sun_meshes: tuple[Element, ...]
    ring_meshes: tuple[Element, ...]
    planets: tuple[str, ...]
    bodies: tuple[Element, ...]

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        """Names of the nodes inside the box of a planetary set, which the schematic does not draw: the planets."""
        return self.planets

    @property
    def elements(self) -> tuple[Element, ...]:
        """Elements inside the schematic's box of a planetary set, its meshes and the inertias of its planets."""
        return (*self.sun_meshes, *self.ring_meshes, *self.bodies)


BoxElement: TypeAlias = Element | EpicyclicSet
"""Element, or planetary set of several elements, that a schematic draws as a box with three or more ports."""


def epicyclic_sets(drivetrain: Drivetrain) -> list[EpicyclicSet]:
    """List of the planetary sets of a drivetrain in the order of their planets.

    Planets between the same members are one set.
    """
    sets: dict[tuple[str, str, str], list[tuple[str, Element, Element]]] = {}
    at = _at_nodes(drivetrain.elements.values())
    for node, elements in at.items():
        meshes = _meshes(node, elements, drivetrain.exact_values)
        if meshes is not None:
            sun, ring = meshes
            key = (_mate(sun, node), _mate(ring, node), sun.ports["housing"])
            sets.setdefault(key, []).append((node, sun, ring))
    # A planet that is also the sun of another set cannot be hidden in a box.
    inner = {node for planets in sets.values() for node, _, _ in planets}
    return [_set(key, planets, at) for key, planets in sets.items() if not inner & set(key)]


def _set(
    key: tuple[str, str, str], planets: list[tuple[str, Element, Element]], at: Mapping[str, list[Element]]
) -> EpicyclicSet:
    nodes, suns, rings = zip(*planets, strict=True)
    meshes = {*suns, *rings}
    bodies = tuple(element for node in nodes for element in at[node] if element not in meshes)
    return EpicyclicSet(
        suns[0].name, dict(zip(("sun", "ring", "carrier"), key, strict=True)), suns, rings, nodes, bodies
    )


def _at_nodes(elements: Iterable[Element]) -> dict[str, list[Element]]:
    at: dict[str, list[Element]] = {}
    for element in elements:
        for node in dict.fromkeys(element.ports.values()):
            if node != GROUND:
                at.setdefault(node, []).append(element)
    return at


def _meshes(node: str, elements: list[Element], values: Mapping[str, Any]) -> tuple[Element, Element] | None:
    """Two gear pairs of a planet, with its sun (external) and its ring (internal); None if the node is no planet."""
    gears = [element for element in elements if isinstance(element, Gear)]
    alone = all(element in gears or _is_alone(element) for element in elements)
    if len(gears) != MESHES_OF_PLANET or not alone or len({gear.housing for gear in gears}) > 1:
        return None
    if gears[0].housing in (None, GROUND, node) or any(node not in gear.nodes for gear in gears):
        return None
    external = [gear for gear in gears if float(gear.ratio_value(dict(values))) < 0]
    internal = [gear for gear in gears if gear not in external]
    if len(external) != 1 or _mate(external[0], node) in (_mate(internal[0], node), GROUND):
        return None
    return external[0], internal[0]


def _is_alone(element: Element) -> bool:
    """Whether an element acts on a single node, not counting ground."""
    return len([node for node in dict.fromkeys(element.ports.values()) if node != GROUND]) == 1


def _mate(gear: Element, node: str) -> str:
    first, second = list(gear.ports.values())[:2]
    return second if first == node else first


class Vertex(NamedTuple):
    """Vertex of a schematic's graph, a node of the drivetrain or an element with three or more ports drawn as a box."""

    name: str
    is_box: bool = False

    @property
    def owner(self) -> Owner:
        """Part of the drivetrain to which strokes drawn for the vertex belong."""
        return Owner("element" if self.is_box else "node", self.name)


@dataclass(frozen=True)
class Link:
    """Link of two vertices of a schematic's graph, by elements in parallel or by the port of a box at its node.

    A link by a port has no elements.
    """

    first: Vertex
    second: Vertex
    elements: tuple[Element, ...] = ()
    port: str = ""

    @property
    def is_gear(self) -> bool:
        """Whether the elements of the link are gears."""
        return bool(self.elements) and _steps(self.elements[0])

    def other(self, vertex: Vertex) -> Vertex:
        """Vertex of the schematic's graph (a node or box) at the other end of the link."""
        return self.second if vertex == self.first else self.first

    @property
    def rank(self) -> int:
        """Rank of the link from 0 to 2, the lower the sooner a line of the drawing follows the link.

        0 shafts, 1 gears and ports, 2 dampers (close loops).
        """
        if not self.elements:
            return 1
        return 2 if all(element.glyph in DRAGS for element in self.elements) else 1 if self.is_gear else 0


@dataclass
class Connections:
    """List of links of a schematic's graph, lists of elements attached to single nodes by node, and boxes by name."""

    links: list[Link] = field(default_factory=list)
    attached: dict[str, list[Element]] = field(default_factory=dict)
    boxes: dict[str, BoxElement] = field(default_factory=dict)


@dataclass
class Tree:
    """Spanning tree of one connected part of a schematic's graph, with children in the order of a depth-first walk."""

    root: Vertex
    children: dict[Vertex, list[tuple[Link, Vertex]]]
    order: list[Vertex]
    """List of all vertices (nodes and boxes) of the tree, parents before children."""


def _steps(element: Element) -> bool:
    return element.glyph == "gear" and GROUND not in list(element.ports.values())[:2]


def connections(drivetrain: Drivetrain) -> Connections:
    """Links, elements on single nodes, and boxes of a schematic, into which a drivetrain's elements are sorted."""
    connected = Connections(attached={node: [] for node in drivetrain.nodes})
    parallel: dict[tuple[frozenset[str], bool], list[Element]] = {}
    sets = epicyclic_sets(drivetrain)
    connected.boxes |= {each.name: each for each in sets}
    inside = {element.name for each in sets for element in each.elements}
    for element in drivetrain.elements.values():
        if element.name in inside:
            continue
        ends = _ends(element)
        if _is_box(element):
            connected.boxes[element.name] = element
        elif len(ends) == 1:
            connected.attached[ends[0]].append(element)
        elif ends:
            parallel.setdefault((frozenset(ends), _steps(element)), []).append(element)
    # Elements between the same two nodes are one link, drawn side by side.
    for group in parallel.values():
        first, second = _ends(group[0])
        connected.links.append(Link(Vertex(first), Vertex(second), tuple(group)))
    for name, drawn in connected.boxes.items():
        for port, node in drawn.ports.items():
            if node != GROUND:
                connected.links.append(Link(Vertex(name, is_box=True), Vertex(node), port=port))
    return connected


def _is_box(element: Element) -> bool:
    """Whether an element is drawn as a box of the schematic.

    It has three ports or more, apart from the housing of a gear.
    """
    ports = [port for port in element.ports if element.glyph != "gear" or port != "housing"]
    return len(ports) > 2


def _ends(element: Element) -> list[str]:
    """Names of the at most two nodes between which an element lies, without ground.

    A gear's moving housing counts only if a shaft is held.
    """
    nodes = [node for node in dict.fromkeys(element.ports.values()) if node != GROUND]
    return nodes[:2]


def trees(connected: Connections, nodes: Iterable[str]) -> tuple[list[Tree], list[Link]]:
    """Spanning trees of a schematic's connected parts, as a list, and the list of the links that close loops."""
    table: dict[Vertex, list[Link]] = {Vertex(node): [] for node in nodes}
    table |= {Vertex(name, is_box=True): [] for name in connected.boxes}
    for link in sorted(connected.links, key=lambda link: link.rank):
        table[link.first].append(link)
        table[link.second].append(link)
    grown: list[Tree] = []
    seen: set[Vertex] = set()
    used: set[int] = set()
    for start in table:
        if start in seen:
            continue
        joined = _walk(start, table, seen)
        _open_at_shafts(connected.links, joined)
        used |= {id(link) for links in joined.values() for link, _ in links}
        grown.append(_rooted(_best_root(start, joined), joined))
    return grown, [link for link in connected.links if id(link) not in used]


def _walk(
    start: Vertex, table: Mapping[Vertex, list[Link]], seen: set[Vertex]
) -> dict[Vertex, list[tuple[Link, Vertex]]]:
    """Pairs (link, vertex at its other end) of a spanning tree by vertex, in both directions, from a depth-first walk.

    Such a walk makes lines long.
    """
    joined: dict[Vertex, list[tuple[Link, Vertex]]] = {start: []}
    seen.add(start)
    stack = [(start, iter(table[start]))]
    while stack:
        vertex, links = stack[-1]
        link = next((link for link in links if link.other(vertex) not in seen), None)
        if link is None:
            stack.pop()
            continue
        new = link.other(vertex)
        seen.add(new)
        joined[vertex].append((link, new))
        joined[new] = [(link, vertex)]
        stack.append((new, iter(table[new])))
    return joined


def _open_at_shafts(links: Iterable[Link], joined: dict[Vertex, list[tuple[Link, Vertex]]]) -> None:
    """Exchange links of a schematic's spanning tree, so that shafts close loops instead of gears.

    No wire can replace a pair of wheels.
    """
    for link in links:
        if not link.is_gear or link.first not in joined or any(link is other for other, _ in joined[link.first]):
            continue
        way = _way(joined, link.first, link.second)
        opened = min((step for step in way if step.elements and not step.is_gear), key=_loose, default=None)
        if opened is not None:
            for old in (opened.first, opened.second):
                joined[old] = [pair for pair in joined[old] if pair[0] is not opened]
            joined[link.first].append((link, link.second))
            joined[link.second].append((link, link.first))


def _loose(link: Link) -> int:
    """Priority of a link for being taken out of a loop of the drivetrain, where the smallest number goes first.

    Dampers first, then single shafts.
    """
    return len(link.elements) - 10 * (link.rank > 0)


def _way(joined: Mapping[Vertex, list[tuple[Link, Vertex]]], start: Vertex, end: Vertex) -> list[Link]:
    """List of the links of the tree on the way between two vertices of a schematic's graph, from the end backwards."""
    arrived: dict[Vertex, tuple[Link, Vertex] | None] = {start: None}
    ahead = [start]
    while end not in arrived:
        vertex = ahead.pop()
        for link, other in joined[vertex]:
            if other not in arrived:
                arrived[other] = (link, vertex)
                ahead.append(other)
    way, step = [], arrived[end]
    while step is not None:
        way.append(step[0])
        step = arrived[step[1]]
    return way


def _best_root(start: Vertex, joined: Mapping[Vertex, list[tuple[Link, Vertex]]]) -> Vertex:
    """Vertex (node or box) of a schematic's graph that is the best root of its spanning tree.

    The first node, or, if it is within a line, the nearer end of the longest way.
    """
    tree = _rooted(start, joined)
    height = heights(tree)
    ways = sorted((height[child] + 1 for link, child in tree.children[start] if not link.is_gear), reverse=True)
    if len(ways) < 2 or 2 * ways[1] < ways[0]:
        return start
    end = _farthest(start, joined)
    other = _farthest(end, joined)
    depth = _depths(tree)
    return min((other, end), key=lambda vertex: depth[vertex])


def _farthest(start: Vertex, joined: Mapping[Vertex, list[tuple[Link, Vertex]]]) -> Vertex:
    tree = _rooted(start, joined)
    depth = _depths(tree)
    return max((vertex for vertex in tree.order if not vertex.is_box), key=lambda vertex: depth[vertex])


def _depths(tree: Tree) -> dict[Vertex, int]:
    depth = {tree.root: 0}
    for vertex in tree.order:
        for _, child in tree.children[vertex]:
            depth[child] = depth[vertex] + 1
    return depth


def _rooted(root: Vertex, joined: Mapping[Vertex, list[tuple[Link, Vertex]]]) -> Tree:
    children: dict[Vertex, list[tuple[Link, Vertex]]] = {}
    order, stack, parent = [], [root], {root: root}
    while stack:
        vertex = stack.pop()
        order.append(vertex)
        children[vertex] = [(link, other) for link, other in joined[vertex] if other != parent[vertex]]
        for _, child in children[vertex]:
            parent[child] = vertex
            stack.append(child)
    return Tree(root, children, order)


def heights(tree: Tree) -> dict[Vertex, int]:
    """Number of links on the longest way from each vertex (node or box) of the tree away from the root, by vertex."""
    lengths: dict[Vertex, int] = {}
    for vertex in reversed(tree.order):
        lengths[vertex] = 1 + max((lengths[child] for _, child in tree.children[vertex]), default=-1)
    return lengths
