"""Plan of a schematic, with elements, inputs and sensors by node, marks of sensors, sizes of discs, and texts.

Sensors of torque and twist in a schematic, with the element they are on and their mark on the shaft.

A mark reads as the torque of the element it stands beside. So it stands right at its element, and nothing may branch
off between them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import zip_longest
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

from torsionnet.model.channels import Input
from torsionnet.model.definition import all_nodes
from torsionnet.model.element_base.laws import Part as LawOrConstraint
from torsionnet.model.elements import GROUND, Element, Law, Values
from torsionnet.model.parts.flattening import copies_of_part
from torsionnet.plot.drawing.labels import symbol, value_lines
from torsionnet.plot.drawing.pieces import Box, Piece, Stroke, Texts, is_math, text_width
from torsionnet.plot.schematics import outlines
from torsionnet.plot.schematics.outlines import DRAGS, Glyph
from torsionnet.plot.schematics.symbols import inline_glyph
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


# Sensors of torque and twist in a schematic, with the element they are on and their mark on the shaft.

# Labels of a schematic in several lines, with long names broken, and the gears of planetary sets listed.

WIDEST = {"input": 64.0, "sensor": 64.0, "what": 70.0}
"""Greatest width in points of a line of a label, by role of its text, a name in ``ROLES``; marks stand closer to each
other than elements."""

WIDEST_OTHER, WIDEST_SET = 104.0, 150.0  # points, of other roles and of planetary sets


def break_lines(lines: Iterable[tuple[str, str]]) -> Texts:
    """Lines (text, role) of a label, of which wide ones are broken behind underscores, commas and spaces.

    >>> break_lines([("speed", "sensor"), ("angular_velocity_of_the_rotor", "sensor")])
    [('speed', 'sensor'), ('angular_', 'sensor'), ('velocity_of_', 'sensor'), ('the_rotor', 'sensor')]
    """
    return [(piece, role) for text, role in lines for piece in _pieces(text, role, WIDEST.get(role, WIDEST_OTHER))]


def wrap_text(text: str, role: str, limit: float) -> list[str]:
    """List of the lines of a text broken to a width in points at spaces, or at underscores of long words.

    None if it is empty.
    """
    pieces = [""]
    for word in _parts(text, " "):
        for part in _parts(word, "_") if text_width(word, role) > limit else [word]:
            if pieces[-1] and text_width(pieces[-1] + part.rstrip(), role) > limit:
                pieces.append("")
            pieces[-1] += part
    return [piece.strip() for piece in pieces if piece]


def _pieces(text: str, role: str, limit: float) -> list[str]:
    if text_width(text, role) <= limit:
        return [text]
    if is_math(text, role):
        head, equals, tail = text.partition(" = ")
        return [f"{head} =", tail] if equals else [text]
    return wrap_text(text, role, limit)


def _parts(text: str, mark: str) -> list[str]:
    """List of the parts of a text, cut behind each occurrence of ``mark``, but not at the end of the text."""
    *parts, last = text.split(mark)
    whole = [part + mark for part in parts]
    return whole if whole and not last else [*whole, last]


def planetary_set_lines(drawn: EpicyclicSet, values: Mapping[str, Any]) -> Texts:
    """Lines (text, role) of a planetary set's label, names and values of its meshes, and names of its planets.

    Meshes of equal values stand together.
    """
    lines = [*_alike(drawn.sun_meshes, values), *_alike(drawn.ring_meshes, values), *_alike(drawn.bodies, values)]
    planets = f"{'planets' if len(drawn.planets) > 1 else 'planet'}: {', '.join(drawn.planets)}"
    return [(piece, role) for text, role in [*lines, (planets, "node")] for piece in _pieces(text, role, WIDEST_SET)]


def _alike(elements: Sequence[Element], values: Mapping[str, Any]) -> Texts:
    """Lines (text, role) of a label, the names of elements of equal values followed by these values."""
    groups: dict[tuple[str, ...], list[str]] = {}
    for element in elements:
        groups.setdefault(tuple(value_lines(element, values)), []).append(element.name)
    lines: Texts = []
    for shown, names in groups.items():
        lines += [(", ".join(names), "name"), *((text, "value") for text in shown)]
    return lines


# Marks of inputs and sensors on a shaft line, with their names above the shaft.

TOPS = {"input": 19.0, "reaction": 19.0, "motion": 20.0, "torque": 20.0}
"""Heights in points above the shaft at which the name of a mark begins, by kind of mark."""

ARROW = 17.0
"""Half the height of a torque arrow in points."""


@dataclass(frozen=True)
class Mark:
    """Mark in a schematic of an input, of its reaction on a second node, or of a sensor of motion or torque."""

    kind: str
    name: str
    """Text of the name, set as a symbol if it is one."""
    what: str
    channel: str
    """Name of the input or sensor in the model."""

    def piece(self, lift: float = 0.0) -> Piece:
        """Drawing of the mark around x = 0, with its name raised by ``lift`` points above the usual height."""
        top = TOPS[self.kind] + lift
        piece = Piece()
        with piece.owned("input" if self._is_arrow else "sensor", self.channel):
            self._draw(piece, top, lift)
        return piece

    def _draw(self, piece: Piece, top: float, lift: float) -> None:
        if self._is_arrow:
            piece.strokes += outlines.torque_arrow(0.0, opposite=self.kind == "reaction")
            piece.boxes.append((-8, 8, -ARROW - 2, TOPS["input"]))
        else:
            piece.strokes += outlines.sensor_mark(0.0, torque=self.kind == "torque", leader=top)
            piece.boxes.append((-5, 5, -5, TOPS["torque"]))
        if lift:
            leader = Stroke(((0, ARROW), (0, top)), "leader")
            piece.strokes += [leader] if self._is_arrow else []
            piece.boxes.append((-1.5, 1.5, 0, top))
        piece.write(0, top, self.texts)

    @property
    def _is_arrow(self) -> bool:
        return self.kind in ("input", "reaction")

    @property
    def texts(self) -> Texts:
        """Lines (text, role) of the label of the mark, its name and its description."""
        return break_lines([(self.name, "input" if self._is_arrow else "sensor"), (self.what, "what")])


@dataclass(frozen=True)
class Tap:
    """Sensor of the torque or twist of an element at one of the ports of that element."""

    name: str
    quantity: str
    element: str
    port: str

    def mark(self, *, alone: bool) -> Mark:
        """Mark of the sensor of torque or twist in a schematic, with name and description.

        ``alone`` if the shaft there carries this element only, so that its name is left out.
        """
        what = self.quantity if alone else f"{self.quantity} of {self.element}"
        return Mark("torque", symbol(self.name), what, self.name)


def is_on_link(tap: Tap, link: Link) -> bool:
    """Whether a sensor is on an element of a schematic's link, or at the port of a box for which the link stands."""
    if link.elements:
        return any(element.name == tap.element for element in link.elements)
    boxes = {vertex.name for vertex in (link.first, link.second) if vertex.is_box}
    return tap.element in boxes and tap.port == link.port


def marks_beside(taps: Iterable[Tap], link: Link, *, alone: bool = True) -> list[Mark]:
    """List of the marks of the sensors that belong to a link of the schematic, to stand right beside the link."""
    return [tap.mark(alone=alone and len(link.elements) == 1) for tap in taps if is_on_link(tap, link)]


# Plan of a schematic, with elements, inputs and sensors by node, sizes of discs, and texts of labels.

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
