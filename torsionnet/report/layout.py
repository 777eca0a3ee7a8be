"""Where everything in a schematic goes: shaft lines from left to right, branches and gear stages on lines of their own.

A line is built from its head onwards, every piece in a stretch of its own that is as wide as its symbol and texts; the
lines that leave it are then moved down (or up) to the nearest free place. Everything is in points.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import zip_longest
from typing import TYPE_CHECKING, TypeAlias

from torsionnet.channels import ELEMENT_QUANTITIES
from torsionnet.elements import GROUND, Element, Inertia
from torsionnet.report.blocks import Block
from torsionnet.report.labels import value_lines
from torsionnet.report.lines import Line
from torsionnet.report.topology import Connections, Link, Tree, Vertex, connections, heights, trees

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain

COMPACT = 40
"""More nodes than this: only nodes are named."""

PAGE = 980.0
"""Width in points beyond which the main line goes on below."""

Pairs: TypeAlias = list[tuple[Element | None, Element | None]]
TOLERATED = 0.3
"""Part of a page by which a line may be longer before it is cut."""

SMALL_DISC, LARGE_DISC = 15.0, 34.0


@dataclass
class Plan:
    """What the lines of a drawing need to know about the drivetrain."""

    drivetrain: Drivetrain
    found: Connections
    compact: bool
    discs: Mapping[str, float]
    """Half the height of each inertia's disc, by name."""
    loops: dict[Vertex, list[tuple[int, Link, Vertex]]] = field(default_factory=dict)
    """Links that close loops, at the vertex from which they are drawn."""
    targets: dict[str, list[int]] = field(default_factory=dict)
    """Numbers of the loops that end at a node."""

    @cached_property
    def inputs(self) -> dict[str, list[tuple[str, str]]]:
        """(input, what it is) by node."""
        words = {"torque": "torque", "angle": "imposed angle"}
        return self._by_node((name, words[given.quantity], given.of) for name, given in self.drivetrain.inputs.items())

    @cached_property
    def motions(self) -> dict[str, list[tuple[str, str]]]:
        """(sensor, quantity) of the motion of nodes, by node."""
        return self._by_node(
            (name, sensor.quantity, sensor.of)
            for name, sensor in self.drivetrain.sensors.items()
            if sensor.quantity not in ELEMENT_QUANTITIES
        )

    def _by_node(self, channels: Iterable[tuple[str, str, str]]) -> dict[str, list[tuple[str, str]]]:
        """Stations within a shaft are not drawn: what is there goes to the shaft's first end, and says so."""
        homes = {
            inner: next(node for node in element.ports.values() if node != GROUND)
            for element in self.drivetrain.elements.values()
            for inner in element.internal_nodes
        }
        found: dict[str, list[tuple[str, str]]] = {}
        for name, what, node in channels:
            text = f"{what} at {node}" if node in homes else what
            found.setdefault(homes.get(node, node), []).append((name, text))
        return found

    @cached_property
    def taps(self) -> dict[str, list[tuple[str, str, str]]]:
        """(sensor, quantity, element) of torques and twists, by the node where they are taken."""
        found: dict[str, list[tuple[str, str, str]]] = {}
        for name, sensor in self.drivetrain.sensors.items():
            element = self.drivetrain.elements.get(sensor.of)
            if sensor.quantity not in ELEMENT_QUANTITIES or element is None:
                continue
            port = sensor.at or next(iter(element.ports))
            nodes = [element.ports.get(port, port), *element.ports.values()]
            node = next(node for node in nodes if node != GROUND)
            found.setdefault(node, []).append((name, sensor.quantity, element.name))
        return found

    def bodies(self, node: str, *, at_end: bool) -> tuple[Pairs, Element | None]:
        """Discs with what hangs below them, and what the line ends in: a clamp or an element to ground."""
        attached = self.found.attached[node]
        discs = [element for element in attached if element.glyph == "disc"]
        others = [element for element in attached if element.glyph != "disc"]
        last = next((element for element in others if element.glyph != "damper"), None) if at_end else None
        hanging = [element for element in others if element is not last]
        return list(zip_longest(discs, hanging)), last

    def texts(self, element: Element) -> list[tuple[str, str]]:
        """Name and main values of an element."""
        if self.compact:
            return []
        lines = [(text, "value") for text in value_lines(element, self.drivetrain.exact_values)]
        if getattr(element, "locked", False):
            lines.append(("locked", "value"))
        housing = element.ports.get("housing", "ground")
        if housing != "ground":
            lines.append((f"housing: {housing}", "node"))
        return [(element.name, "name"), *lines]


def make_plan(drivetrain: Drivetrain) -> tuple[Plan, list[Tree]]:
    found = connections(drivetrain)
    inner = {node for element in drivetrain.elements.values() for node in element.internal_nodes}
    grown, left = trees(found, [node for node in drivetrain.nodes if node not in inner])
    compact = len(drivetrain.nodes) > COMPACT
    plan = Plan(drivetrain, found, compact, disc_sizes(drivetrain))
    places = {vertex: place for tree in grown for place, vertex in enumerate(tree.order)}
    for number, link in enumerate(left):
        start, end = sorted((link.first, link.second), key=lambda vertex: (not vertex.is_box, places[vertex]))
        plan.loops.setdefault(start, []).append((number, link, end))
        plan.targets.setdefault(end.name, []).append(number)
    return plan, grown


def disc_sizes(drivetrain: Drivetrain) -> dict[str, float]:
    """Half heights between two limits, by the logarithm of the inertia."""
    values = {
        element.name: float(element.inertia.evaluate(drivetrain.exact_values))
        for element in drivetrain.elements.values()
        if isinstance(element, Inertia)
    }
    logs = {name: math.log10(value) for name, value in values.items() if value > 0}
    low, high = min(logs.values(), default=0), max(logs.values(), default=0)
    # Within a decade or two a small difference should not look like a large one.
    span = max(high - low, 2.0)
    middle = (low + high) / 2
    return {
        name: SMALL_DISC + (LARGE_DISC - SMALL_DISC) * (0.5 + (logs.get(name, low) - middle) / span) for name in values
    }


def blocks(drivetrain: Drivetrain) -> list[Block]:
    """One block for each connected part."""
    plan, grown = make_plan(drivetrain)
    return [_whole(tree, plan) for tree in grown]


@dataclass(frozen=True)
class Course:
    """Which vertices make up a line, and how it is reached."""

    incoming: Link | None
    vertices: tuple[Vertex, ...]
    links: tuple[Link, ...]
    """Between the vertices; one more where the line is cut."""
    before: Link | None = None
    """The link at the cut."""


def courses(tree: Tree) -> dict[Vertex, Course]:
    """The lines of a tree by their heads, those nearer to the root first."""
    height = heights(tree)
    found: dict[Vertex, Course] = {}
    heads: list[tuple[Link | None, Vertex]] = [(None, tree.root)]
    for incoming, head in heads:
        vertices, links = [head], []
        while True:
            going = [(link, child) for link, child in tree.children[vertices[-1]] if not link.is_gear]
            onward = max(going, key=lambda pair: (height[pair[1]], -pair[0].rank), default=None)
            heads += [pair for pair in tree.children[vertices[-1]] if pair != onward]
            if onward is None:
                break
            links.append(onward[0])
            vertices.append(onward[1])
        found[head] = Course(incoming, tuple(vertices), tuple(links))
    return found


def _whole(tree: Tree, plan: Plan) -> Block:
    """Lines from the tips towards the root, so that each finds the lines leaving it finished."""
    found = courses(tree)
    done: dict[Vertex, Block] = {}
    for head, course in reversed(found.items()):
        pieces = _pieces(course, plan) if head == tree.root else [course]
        built = [_line(piece, tree, plan, done, top=head == tree.root) for piece in pieces]
        done[head] = _stacked(built)
    return done[tree.root]


def _line(course: Course, tree: Tree, plan: Plan, done: Mapping[Vertex, Block], *, top: bool) -> Block:
    line = Line(plan)
    if course.incoming is not None:
        line.begin(course.incoming)
    before = course.incoming or course.before
    for vertex, onward in zip_longest(course.vertices, course.links):
        leaving = [(link, done[child]) for link, child in tree.children[vertex] if child in done]
        line.vertex(vertex, before, onward, leaving)
        if onward is not None:
            line.gap(onward)
        before = onward
    return line.finish(may_rise=top)


def _pieces(course: Course, plan: Plan) -> list[Course]:
    """A main line cut into pieces of about one width if it is too long; the link at a cut ends the piece before it."""
    widths = _widths(course, plan)
    count = max(1, math.ceil(sum(widths) / PAGE - TOLERATED))
    limit = sum(widths) / count
    if count == 1:
        return [course]
    pieces: list[Course] = []
    start, width, before = 0, 0.0, None
    last = len(widths) - 1
    for place, step in enumerate(widths):
        width += step
        if place == last or width > limit - step / 2:
            piece = slice(start, place + 1)
            pieces.append(Course(course.incoming, course.vertices[piece], course.links[piece], before))
            start, width = place + 1, 0.0
            before = course.links[place] if place < last else None
    return pieces


def _widths(course: Course, plan: Plan) -> list[float]:
    """Width of each vertex with the elements after it."""
    widths = []
    for vertex, onward in zip_longest(course.vertices, course.links):
        probe = Line(plan)
        probe.vertex(vertex, None, onward, [])
        if onward is not None:
            probe.gap(onward)
        widths.append(probe.x)
    return widths


def _stacked(built: list[Block]) -> Block:
    """Pieces of a line below each other, each led on to the next."""
    whole = built[0]
    far = max(piece.extent[1] for piece in built) + 8
    for piece in built[1:]:
        bottom = whole.extent[2]
        left, _, _, top = piece.extent
        drop, lane, edge = bottom - 30 - top, bottom - 14, left - 14
        x, y = whole.anchors.pop(-1)
        whole.line((x, y), (far, y), (far, lane), (edge, lane), (edge, drop), (0, drop))
        whole.add(piece.shifted(0, drop))
    whole.anchors.pop(-1, None)
    return whole
