"""Routes of the shaft lines of a schematic, their nodes and boxes in order, and cuts that fit the page."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import permutations, zip_longest
from typing import TYPE_CHECKING, NamedTuple

from torsionnet.model.channels import Input, Sensor
from torsionnet.model.elements import GROUND, Gear
from torsionnet.model.speeds import speeds_by_reference
from torsionnet.plot.schematics.outlines import DRAGS
from torsionnet.plot.schematics.topology import Connections, Link, Tree, Vertex, connections, heights, trees

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain


PIECE, MISPLACED, LATE = 2e4, 1e6, 30.0
"""Costs in squared points of a cut shaft line, of each piece, of each branch that would fit elsewhere, and of each
point by which such a branch is offset."""


@dataclass(frozen=True)
class LineRoute:
    """Nodes, boxes and links in order along one shaft line of a schematic, and the link from its parent line."""

    incoming: Link | None
    parent: Vertex | None
    vertices: tuple[Vertex, ...]
    links: tuple[Link, ...]
    """Links from each node or box of the shaft line to the next, and, if the line is cut behind the last, the link
    there."""
    before: Link | None = None
    """Link at which the shaft line is cut before its first node or box, None if the line begins there."""
    shares: tuple[tuple[int, int], ...] = ()
    """Pairs (index from 0, number of parts) that tell which part of a node or box of the shaft line is drawn at each
    place; empty: all are whole."""

    def share(self, place: int) -> tuple[int, int]:
        """Pair (index from 0, number of parts) that tells which part of a node is drawn at a place of the line."""
        return self.shares[place] if self.shares else (0, 1)

    def cut(self, first: int, last: int) -> LineRoute:
        """Route of a piece of the shaft line, from the node or box with index ``first`` to the one before ``last``."""
        before = self.links[first - 1] if first else self.before
        incoming = None if first else self.incoming
        shares = self.shares[first:last]
        return LineRoute(incoming, self.parent, self.vertices[first:last], self.links[first:last], before, shares)

    def split(self, crowded: Mapping[Vertex, int]) -> LineRoute:
        """Copy of the route in which crowded nodes are split into parts with a piece of shaft between the parts."""
        vertices: list[Vertex] = []
        links: list[Link] = []
        shares: list[tuple[int, int]] = []
        for vertex, onward in zip_longest(self.vertices, self.links):
            parts = crowded.get(vertex, 1)
            vertices += [vertex] * parts
            links += [Link(vertex, vertex)] * (parts - 1) + ([onward] if onward is not None else [])
            shares += [(part, parts) for part in range(parts)]
        return LineRoute(self.incoming, self.parent, tuple(vertices), tuple(links), self.before, tuple(shares))


class BranchWidth(NamedTuple):
    """Distance in points of a branch from the start of its node, and width in points with the branch's own branches."""

    x: float
    need: float


class RouteStep(NamedTuple):
    """Widths in points of one node of a shaft line with the elements after it, and of the texts beyond either side."""

    width: float
    left: float
    right: float
    leaving: tuple[BranchWidth, ...]

    @property
    def whole(self) -> float:
        """Width in points of a node of a shaft line with the elements after it and the texts beyond either side."""
        return self.left + self.width + self.right


def line_routes(tree: Tree) -> dict[Vertex, LineRoute]:
    """Routes of the shaft lines of a tree, by the first node or box of each, lines nearer to the root first."""
    height = heights(tree)
    routes: dict[Vertex, LineRoute] = {}
    heads: list[tuple[Link | None, Vertex | None, Vertex]] = [(None, None, tree.root)]
    for incoming, parent, head in heads:
        vertices, links = [head], []
        while True:
            here = vertices[-1]
            going = [(link, child) for link, child in tree.children[here] if not link.is_gear]
            onward = max(going, key=lambda pair: (height[pair[1]], -pair[0].rank), default=None)
            heads += [(link, here, child) for link, child in tree.children[here] if (link, child) != onward]
            if onward is None:
                break
            links.append(onward[0])
            vertices.append(onward[1])
        routes[head] = LineRoute(incoming, parent, tuple(vertices), tuple(links))
    return routes


def line_width(start: float, steps: Sequence[RouteStep]) -> float:
    """Width in points of a shaft line in one piece, with all its branches."""
    x = start + max(0.0, steps[0].left - start)
    far = x
    for step in steps:
        far = max(far, x + step.width + step.right, *(x + leaving.x + leaving.need for leaving in step.leaving))
        x += step.width
    return far


def piece_starts(start: float, steps: Sequence[RouteStep], room: float, margin: float) -> list[int]:
    """Indices, from 0, of the nodes or boxes of a shaft line at which the pieces of the cut line begin.

    Few, of like width, with room for branches.
    """
    if line_width(start, steps) <= room:
        return [0]
    narrow = room - margin
    best: list[float] = [0.0]
    came: list[int] = [0]
    for end in range(1, len(steps) + 1):
        choices = {first: best[first] + _cost_of_piece(steps[first:end], start if first == 0 else 0.0, narrow)
                   for first in _firsts(steps, end, narrow)}  # fmt: skip
        first = min(choices, key=lambda place: choices[place])
        best.append(choices[first])
        came.append(first)
    begins = [came[-1]]
    while begins[-1]:
        begins.append(came[begins[-1]])
    return begins[::-1]


def _firsts(steps: Sequence[RouteStep], end: int, room: float) -> list[int]:
    """Indices of the nodes of a line at which a piece that ends before index ``end`` may begin to fit a room in points.

    At least one step.
    """
    firsts = [end - 1]
    width = steps[end - 1].width + steps[end - 1].right
    for first in range(end - 2, -1, -1):
        width += steps[first].width
        if width + steps[first].left > room:
            break
        firsts.append(first)
    return firsts


def _cost_of_piece(piece: Sequence[RouteStep], start: float, room: float) -> float:
    """Cost in squared points of a piece of a cut shaft line, from empty room, squared, and branches that do not fit."""
    x, cost = max(start, piece[0].left), PIECE
    for step in piece:
        for leaving in step.leaving:
            begin = x + leaving.x
            if begin + leaving.need > room:
                cost += MISPLACED * (step.left + leaving.x + leaving.need <= room) + LATE * begin
        x += step.width
    far = max(x + piece[-1].right, line_width(start, piece) if cost < MISPLACED else x)
    return cost + (room - min(far, room)) ** 2 + MISPLACED * max(0.0, x - room)


# Nodes of a drivetrain on the axis of a mode shape plot, in the schematic's order, and the ratios of their speeds.

BRANCHING_ELEMENTS = 3
"""Least number of elements leading on from a node that make it a branching point."""
BRANCH_GAP = 0.7
"""Additional distance between two branches on the axis of a mode shape plot, as a multiple of that between nodes."""


@dataclass(frozen=True)
class Station:
    """Node at a place x, in distances between nodes, on the axis of a mode shape plot.

    ``again`` if a branch begins with the node of the main line repeated.
    """

    x: float
    node: str
    again: bool = False


@dataclass(frozen=True)
class Join:
    """Connection of two neighbouring stations of a mode shape plot by an element.

    A shaft, a gear (label: its ratio), or a box.
    """

    first: int
    second: int
    kind: str
    label: str = ""


@dataclass
class Axis:
    """Axis of a mode shape plot, with stations from left to right, connections and borders between branches."""

    stations: list[Station] = field(default_factory=list)
    joins: list[Join] = field(default_factory=list)
    borders: list[float] = field(default_factory=list)
    begins: bool = False
    """Whether the next station added to the axis begins a branch."""

    @property
    def end(self) -> float:
        """Place of the last station on the axis, in distances between nodes."""
        return self.stations[-1].x if self.stations else 0.0

    def add(self, node: str, kind: str = "", label: str = "", *, again: bool = False) -> None:
        """Add a node as a station behind the last one of the axis, joined by an element of a kind if that is given."""
        x = self.end + 1.0 if self.stations else 0.0
        self.stations.append(Station(x + (BRANCH_GAP if self.begins else 0.0), node, again))
        if kind:
            place = len(self.stations) - 1
            self.joins.append(Join(place - 1, place, kind, label))
        self.begins = False

    def border(self) -> None:
        """Begin another branch on the axis of a mode shape plot, with a border before the branch."""
        if self.stations:
            self.borders.append(self.end + (1.0 + BRANCH_GAP) / 2)
            self.begins = True


def plain_axis(nodes: Iterable[str]) -> Axis:
    """Axis of a mode shape plot with nodes in the order given, not joined."""
    return Axis([Station(float(place), node) for place, node in enumerate(nodes)])


def node_axis(drivetrain: Drivetrain, without: Collection[str] = ()) -> Axis:
    """Axis of a mode shape plot with a drivetrain's main line, branches in the schematic's order, and hidden nodes."""
    connected = connections(drivetrain)
    connected.links = [
        link for link in connected.links if link.first.name not in without and link.second.name not in without
    ]
    hidden = {*_hidden(connected, drivetrain), *without}
    grown, _ = trees(connected, [node for node in drivetrain.nodes if node not in hidden])
    axis = Axis()
    for tree in grown:
        for route in _in_depth(line_routes(tree)):
            _add_line_nodes(axis, route, drivetrain)
    left = [node for node in drivetrain.nodes if node not in {*without, *(station.node for station in axis.stations)}]
    for place, node in enumerate(left):
        if place == 0:
            axis.border()
        axis.add(node)
    return axis


def _in_depth(routes: Mapping[Vertex, LineRoute]) -> Iterator[LineRoute]:
    """Yield the routes of shaft lines, each followed by its branches, from the branches at its end to the first."""
    leaving: dict[Vertex | None, list[LineRoute]] = {}
    for route in routes.values():
        leaving.setdefault(route.parent, []).append(route)
    stack = leaving.get(None, [])[::-1]
    while stack:
        route = stack.pop()
        yield route
        following = [other for vertex in reversed(route.vertices) for other in leaving.get(vertex, ())]
        stack += following[::-1]


def _hidden(connected: Connections, drivetrain: Drivetrain) -> set[str]:
    drawn = [*drivetrain.elements.values(), *connected.boxes.values()]
    return {node for element in drawn for node in element.internal_nodes}


def _add_line_nodes(axis: Axis, route: LineRoute, drivetrain: Drivetrain) -> None:
    """Add the nodes of one shaft line of the schematic to the axis of a mode shape plot; boxes are passed through."""
    kind, label = "", ""
    if route.incoming is None or route.parent is None:
        axis.border()
    else:
        # A gear at the end of a line is no branch: the line goes on behind it.
        if not axis.stations or route.parent.name != axis.stations[-1].node:
            axis.border()
            if not route.parent.is_box:
                axis.add(route.parent.name, again=True)
        if not route.parent.is_box:
            label = _ratio_label(route.incoming, drivetrain)
            kind = _through(axis, route.incoming, route.vertices[0])
    for vertex, onward in zip_longest(route.vertices, route.links):
        if not vertex.is_box:
            axis.add(vertex.name, kind, label)
        if onward is not None:
            label = ""
            following = onward.other(vertex)
            kind = "" if vertex.is_box and not axis.stations else _through(axis, onward, following)


def _through(axis: Axis, link: Link, end: Vertex) -> str:
    """Add the nodes within the shaft of a link to the axis, and return the link's kind, "box", "gear" or "shaft"."""
    if not link.elements:
        return "box"
    if link.is_gear:
        return "gear"
    inner = list(link.elements[0].internal_nodes)
    ports = list(link.elements[0].ports.values())
    for node in inner if ports[-1] == end.name else reversed(inner):
        axis.add(node, "shaft")
    return "shaft"


def _ratio_label(link: Link, drivetrain: Drivetrain) -> str:
    """Text of the ratio of a gear as the model gives it, speed of the gear's first node over that of the second."""
    gear = link.elements[0] if link.elements else None
    if not isinstance(gear, Gear):
        return ""
    return f"{float(gear.ratio_value(dict(drivetrain.exact_values))):.3g}".replace("-", "−")


@dataclass(frozen=True)
class Ratios:
    """Speed of a reference node divided by each node's speed, by node, and the nodes without such a ratio."""

    of: dict[str, float]
    free: tuple[str, ...]
    """Names of the nodes whose mean speed is independent of the reference node's; their ratio is that of the shaft
    beside them."""
    standing: tuple[str, ...]
    """Names of the nodes that stand still on average while the reference node turns; their ratio is 1."""


def ratios(drivetrain: Drivetrain, reference: str) -> Ratios:
    """Ratios of the mean speed of a reference node to those of all nodes, by name of the node.

    Without one, that of the shaft beside.
    """
    speeds = speeds_by_reference(drivetrain.definition, drivetrain.exact_values, reference)
    standing = tuple(node for node, speed in speeds.items() if speed == 0)
    known = {node: speeds[reference] / speed for node, speed in speeds.items() if speed}
    free = tuple(node for node in drivetrain.nodes if node not in speeds)
    _spread(drivetrain, known, free)
    return Ratios({node: known.get(node, 1.0) for node in drivetrain.nodes}, free, standing)


def _spread(drivetrain: Drivetrain, known: dict[str, float], free: Iterable[str]) -> None:
    """Give every node in ``free`` the ratio of speeds of a node with which it shares an element."""
    missing = set(free)
    beside: dict[str, list[str]] = {}
    for element in drivetrain.elements.values():
        for end, other in permutations(dict.fromkeys((*element.ports.values(), *element.internal_nodes)), 2):
            beside.setdefault(end, []).append(other)
    waiting = list(known)
    for node in waiting:
        for other in beside.get(node, ()):
            if other in missing:
                missing.discard(other)
                known[other] = known[node]
                waiting.append(other)


def idle_nodes(drivetrain: Drivetrain) -> set[str]:
    """Set of the names of the nodes of idle gear wheels, behind which no element leads on.

    A rigid gear leads to an idle wheel from a branching node.
    A node with an input, a sensor, a load or a given speed is no idler.
    """
    channels: tuple[Input | Sensor, ...] = (*drivetrain.inputs.values(), *drivetrain.sensors.values())
    used = {name for channel in channels for name in (channel.of, *channel.nodes)}
    used |= {*drivetrain.mean_torques, *drivetrain.definition.operating_point.speed}
    ways = _ways(drivetrain)
    left = {node: set(names) for node, names in ways.items()}
    idle: set[str] = set()
    waiting = list(drivetrain.nodes)
    while waiting:
        node = waiting.pop()
        gear = drivetrain.elements[next(iter(left[node]))] if len(left[node]) == 1 else None
        if node in used | idle or not isinstance(gear, Gear) or gear.stiffness is not None or node not in gear.nodes:
            continue
        other = gear.nodes[1 - gear.nodes.index(node)]
        if other in ways and len(ways[other]) >= BRANCHING_ELEMENTS:
            idle.add(node)
            left[other].discard(gear.name)
            waiting.append(other)
    return idle


def _ways(drivetrain: Drivetrain) -> dict[str, list[str]]:
    """Lists of the names of the elements that lead on from a node or hold the node still, by name of the node.

    Inertia and drag do neither.
    """
    ways: dict[str, list[str]] = {node: [] for node in drivetrain.nodes}
    for element in drivetrain.elements.values():
        ends = set(element.ports.values())
        holds = element.glyph == "clamp" or (GROUND in ends and element.glyph not in DRAGS)
        if holds or len(ends - {GROUND}) > 1:
            for node in ends & ways.keys():
                ways[node].append(element.name)
    return ways
