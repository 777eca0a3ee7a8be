"""Plan of a schematic, with elements, inputs and sensors by node, sizes of discs, and texts of labels."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import zip_longest
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

from torsionnet.model.channels import Input
from torsionnet.model.definition import all_nodes
from torsionnet.model.element_base.laws import Part as LawOrConstraint
from torsionnet.model.elements import GROUND, Element, Law, Values
from torsionnet.model.parts.flattening import copies_of_part
from torsionnet.plot.drawing.labels import value_lines
from torsionnet.plot.drawing.pieces import Box, Piece, Texts
from torsionnet.plot.schematics.glyphs import inline_glyph
from torsionnet.plot.schematics.outlines import DRAGS, Glyph
from torsionnet.plot.schematics.taps import Tap, break_lines, is_on_link, planetary_set_lines
from torsionnet.plot.schematics.topology import (
    BoxElement,
    Connections,
    EpicyclicSet,
    Link,
    Tree,
    Vertex,
    connections,
    trees,
)

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain


# Copy of a drivetrain for a schematic that draws each copy of a part as one box.


@dataclass(frozen=True, eq=False, repr=False)
class PartBox(Element):
    """Box in a schematic that stands for all elements of one copy of a part; it has no laws."""

    glyph: ClassVar[str] = "part"

    joined: tuple[tuple[str, str], ...] = ()
    inner: tuple[str, ...] = ()

    @property
    def ports(self) -> dict[str, str]:
        return dict(self.joined)

    def own_parts(self, value: Values) -> tuple[LawOrConstraint, ...]:
        del value
        return ()

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return self.inner


def with_part_boxes(drivetrain: Drivetrain) -> Drivetrain:
    """Copy of a drivetrain with one box as element in place of each copy of a part; itself if it uses no parts.

    Sensors on elements within a part are not drawn; motions of its nodes stand at its first port.
    """
    definition = drivetrain.definition
    if definition.authored is None or not definition.authored.authored.use:
        return drivetrain
    elements = dict(definition.elements)
    for use_name, use in definition.authored.authored.use.items():
        for copy in copies_of_part(use_name, use):
            prefix = f"{copy.name}."
            inside = [element for name, element in definition.elements.items() if name.startswith(prefix)]
            outer = {*copy.nodes.values(), GROUND}
            inner = tuple(node for node in all_nodes(inside) if node not in outer)
            elements = {name: element for name, element in elements.items() if not name.startswith(prefix)}
            elements[copy.name] = PartBox(
                copy.name, description=use.part, joined=tuple(copy.nodes.items()), inner=inner
            )
    sensors = {
        name: sensor for name, sensor in definition.sensors.items() if not sensor.is_on_element or sensor.of in elements
    }
    drawn = replace(definition, elements=elements, sensors=sensors, excitations={}, limits={}, load=None, authored=None)
    return drivetrain.with_definition(drawn)


MOST_NAMED_NODES = 40
"""Largest number of nodes with which the elements of a schematic have names and values; above, only nodes are named, in
smaller symbols."""

SMALL_DISC, LARGE_DISC = 15.0, 34.0  # points: half heights of the discs of the smallest and largest inertia
COMPACT_SCALE = 0.6
"""Size of the symbols in a drawing of many nodes, as a multiple of the usual size."""

Pairs: TypeAlias = list[tuple[Element | None, Element | None]]


@dataclass
class DrawingPlan:
    """Drivetrain with what a schematic draws at each node, and the sizes and texts of its symbols."""

    drivetrain: Drivetrain
    connected: Connections
    page: float
    """Width in points of the schematic, beyond which its shaft lines are cut and go on below."""
    compact: bool
    discs: Mapping[str, float]
    """Half heights in points of the discs of inertias, by name of the element."""
    loops: dict[Vertex, list[tuple[int, Link, Vertex]]] = field(default_factory=dict)
    """Lists of links that close loops of the schematic, as (number, link, other end), by the node or box where they
    begin."""
    targets: dict[str, list[int]] = field(default_factory=dict)
    """Lists of the numbers of the schematic's loops that end at a node, by name of the node."""

    bodies_drawn: dict[tuple[str, str], Piece] = field(default_factory=dict)
    """Drawings of pairs of a disc and a hanging element, by their names, as both are measured and drawn."""
    links_drawn: dict[int, tuple[Piece, float, list[Box]]] = field(default_factory=dict)
    """Drawings of elements between two nodes, with width and room around, by the identity of their link."""
    _glyphs: dict[str, Glyph] = field(default_factory=dict)
    _scaled: dict[int, tuple[Glyph, Glyph]] = field(default_factory=dict)
    _texts: dict[str, Texts] = field(default_factory=dict)

    @property
    def scale(self) -> float:
        """Size of the symbols of the schematic as a multiple of the usual size."""
        return COMPACT_SCALE if self.compact else 1.0

    @cached_property
    def homes(self) -> dict[str, str]:
        """Names of the drawn nodes at which inputs and sensors of hidden nodes stand, by name of the hidden node.

        Stations within a shaft go to the shaft's first end, planets to the carrier.
        """
        shafts = {
            inner: next(node for node in element.ports.values() if node != GROUND)
            for element in self.drivetrain.elements.values()
            for inner in element.internal_nodes
        }
        sets = [box for box in self.connected.boxes.values() if isinstance(box, EpicyclicSet)]
        return shafts | {planet: each.ports["carrier"] for each in sets for planet in each.planets}

    @cached_property
    def housings(self) -> dict[str, list[str]]:
        """Lists of the names of the gears whose housing is on a node, by name of the node."""
        by_node: dict[str, list[str]] = {}
        inside = {element.name for box in self.connected.boxes.values() for element in getattr(box, "elements", ())}
        for element in self.drivetrain.elements.values():
            node = element.ports.get("housing", GROUND)
            if node != GROUND and element.name not in inside and not isinstance(element, PartBox):
                by_node.setdefault(node, []).append(element.name)
        return by_node

    @cached_property
    def inputs(self) -> dict[str, list[tuple[str, str]]]:
        """Lists of pairs (name, description) of the inputs on a node, by name of the node."""
        return self._by_node((name, _input_words(given), given.of) for name, given in self.drivetrain.inputs.items())

    @cached_property
    def reactions(self) -> dict[str, list[tuple[str, str]]]:
        """Lists of pairs (name, description) of the inputs between two nodes, by name of the second node."""
        return self._by_node(
            (name, f"of {given.of}", given.against)
            for name, given in self.drivetrain.inputs.items()
            if given.against is not None
        )

    @cached_property
    def motions(self) -> dict[str, list[tuple[str, str]]]:
        """Lists of pairs (name, quantity) of the sensors of a node's motion, by name of the node."""
        return self._by_node(
            (name, f"{sensor.quantity}{f' against {sensor.against}' if sensor.against else ''}", sensor.of)
            for name, sensor in self.drivetrain.sensors.items()
            if not sensor.is_on_element
        )

    def _by_node(self, channels: Iterable[tuple[str, str, str]]) -> dict[str, list[tuple[str, str]]]:
        """Lists of pairs (name, description) of inputs or sensors, by name of the drawn node at which they stand.

        The description names a node that is hidden.
        """
        by_node: dict[str, list[tuple[str, str]]] = {}
        for name, what, node in channels:
            text = f"{what} at {node}" if node in self.homes else what
            by_node.setdefault(self.homes.get(node, node), []).append((name, text))
        return by_node

    @cached_property
    def taps(self) -> dict[str, list[Tap]]:
        """Lists of the sensors of torque and twist, by name of the node at which they are drawn."""
        by_node: dict[str, list[Tap]] = {}
        for name, sensor in self.drivetrain.sensors.items():
            element = self.drivetrain.elements.get(sensor.of)
            if not sensor.is_on_element or element is None:
                continue
            port, node = _taken(element, sensor.at)
            by_node.setdefault(self.homes.get(node, node), []).append(Tap(name, sensor.quantity, element.name, port))
        return by_node

    def sensors_on(self, element: Element) -> list[Tap]:
        """List of the sensors of the torque or twist of an element."""
        return [tap for taps in self.taps.values() for tap in taps if tap.element == element.name]

    def is_drawn_beside(self, tap: Tap, node: str) -> bool:
        """Whether a sensor is drawn beside its element because that element leads on from the node."""
        return any(is_on_link(tap, link) for link in self._links[node])

    @cached_property
    def _links(self) -> dict[str, list[Link]]:
        by_node: dict[str, list[Link]] = {node: [] for node in self.drivetrain.nodes}
        for link in self.connected.links:
            for vertex in (link.first, link.second):
                if not vertex.is_box:
                    by_node[vertex.name].append(link)
        return by_node

    def bodies(self, node: str, *, at_end: bool) -> tuple[Pairs, Element | None]:
        """Pairs (disc, element hanging below) at a node, and the element to ground that ends the shaft line, if any."""
        attached = self.connected.attached[node]
        discs = [element for element in attached if element.glyph == "disc"]
        others = [element for element in attached if element.glyph != "disc"]
        last = next((element for element in others if element.glyph not in DRAGS), None) if at_end else None
        hanging = [element for element in others if element is not last]
        return list(zip_longest(discs, hanging)), last

    def node_texts(self, node: str) -> Texts:
        """Lines (text, role) of a node's label in the schematic, its name, and the gears whose housing it is."""
        gears = self.housings.get(node, []) if not self.compact else []
        return break_lines([*([(f"housing of {', '.join(gears)}", "what")] if gears else []), (node, "node")])

    def glyph(self, element: Element) -> Glyph:
        """Symbol of an element between two ends in the size of the schematic."""
        if element.name not in self._glyphs:
            full = inline_glyph(element, self.drivetrain.exact_values)
            if id(full) not in self._scaled:
                self._scaled[id(full)] = full, full.scaled(self.scale)
            self._glyphs[element.name] = self._scaled[id(full)][1]
        return self._glyphs[element.name]

    def texts(self, element: BoxElement) -> Texts:
        """Lines (text, role) of an element's label in the schematic, its name and its main values."""
        if self.compact:
            return []
        if element.name not in self._texts:
            self._texts[element.name] = self._new_texts(element)
        return self._texts[element.name]

    def _new_texts(self, element: BoxElement) -> Texts:
        if isinstance(element, PartBox):
            return break_lines([(element.name, "name"), (element.description, "what")])
        if isinstance(element, EpicyclicSet):
            return planetary_set_lines(element, self.drivetrain.exact_values)
        lines = [(text, "value") for text in value_lines(element, self.drivetrain.exact_values)]
        if getattr(element, "locked", False):
            lines.append(("locked", "value"))
        housing = element.ports.get("housing", GROUND)
        if housing != GROUND:
            lines.append((f"housing: {housing}", "node"))
        return break_lines([(element.name, "name"), *lines])


def _taken(element: Element, at: str | None) -> tuple[str, str]:
    """Names of the port and the node at which a torque sensor is drawn: its own, unless that is the ground."""
    ports = list(element.ports.items())
    return next(((port, node) for port, node in ports if at in (port, node) and node != GROUND),
                next(pair for pair in ports if pair[1] != GROUND))  # fmt: skip


def make_plan(drivetrain: Drivetrain, page: float) -> tuple[DrawingPlan, list[Tree]]:
    """Plan of a schematic, and list with a spanning tree for each connected part of the drivetrain."""
    connected = connections(drivetrain)
    compact = len(drivetrain.nodes) > MOST_NAMED_NODES
    plan = DrawingPlan(drivetrain, connected, page, compact, disc_sizes(drivetrain, COMPACT_SCALE if compact else 1.0))
    grown, left = trees(connected, [node for node in drivetrain.nodes if node not in plan.homes])
    places = {vertex: place for tree in grown for place, vertex in enumerate(tree.order)}
    for number, link in enumerate(left):
        start, end = sorted((link.first, link.second), key=lambda vertex: (not vertex.is_box, places[vertex]))
        plan.loops.setdefault(start, []).append((number, link, end))
        plan.targets.setdefault(end.name, []).append(number)
    return plan, grown


def disc_sizes(drivetrain: Drivetrain, scale: float) -> dict[str, float]:
    """Half heights in points of the discs of inertias by name of the element, rising with the inertia's logarithm."""
    discs = [element for element in drivetrain.elements.values() if element.glyph == "disc"]
    values = {element.name: inertia_of(element, drivetrain.exact_values) for element in discs}
    logs = {name: math.log10(value) for name, value in values.items() if value > 0}
    low, high = min(logs.values(), default=0), max(logs.values(), default=0)
    # Within a decade or two a small difference should not look like a large one.
    span = max(high - low, 2.0)
    middle = (low + high) / 2
    return {
        name: scale * (SMALL_DISC + (LARGE_DISC - SMALL_DISC) * (0.5 + (logs.get(name, low) - middle) / span))
        for name in values
    }


def inertia_of(element: Element, values: Mapping[str, Any]) -> float:
    """Inertia in kg m^2 that an element adds to its nodes."""
    laws = [part for part in element.parts(Values(values)) if isinstance(part, Law)]
    return sum(float(law.inertia) * sum(float(factor) ** 2 for factor in law.row.values()) for law in laws)


def _input_words(channel: Input) -> str:
    """Words beside the arrow of an input in a schematic, such as "torque against motor"."""
    what = {"torque": "torque", "angle": "imposed angle"}[channel.quantity]
    return what if channel.against is None else f"{what} against {channel.against}"
