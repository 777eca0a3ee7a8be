"""Shaft line of a schematic, drawn from left to right with its nodes, the elements between them, and branches."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any, TypeAlias

from torsionnet.model.elements import GROUND, Element
from torsionnet.plot.drawing.labels import symbol
from torsionnet.plot.drawing.pieces import LEADING, ROLES, Box, Owner, Piece, Stroke, Texts, label_width, text_width
from torsionnet.plot.schematics import outlines, symbols
from torsionnet.plot.schematics.drawing_plan import Mark
from torsionnet.plot.schematics.outlines import Glyph
from torsionnet.plot.schematics.symbols import far_end
from torsionnet.plot.schematics.topology import Link, Vertex
from torsionnet.plot.schematics.wires import (
    ELBOW,
    Branch,
    BranchStart,
    GearPair,
    PlannedRow,
    place_branches,
    wheel_ratio,
)

if TYPE_CHECKING:
    from torsionnet.plot.schematics.drawing_plan import DrawingPlan
    from torsionnet.plot.schematics.topology import BoxElement


# Symbols at a node of a schematic, as discs, elements to ground or a mass, and the element at a shaft line's end.

WALL, LEADER = 18.0, 14.0  # points: half height of a wall or disc at the end of a line, length of a mark's leader


def draw_body(line: PlannedRow, disc: Element | None, hanging: Element | None) -> None:
    """Draw at a node of the schematic a disc and the element that hangs below it, either of which may be missing."""
    drawn, key = line.plan.bodies_drawn, (disc.name if disc else "", hanging.name if hanging else "")
    if key not in drawn:
        drawn[key] = _body(line, disc, hanging)
    half_width = 10.0 * line.plan.scale
    line.put(drawn[key], half_width, half_width)


def _body(line: PlannedRow, disc: Element | None, hanging: Element | None) -> Piece:
    above = line.plan.texts(disc) if disc else []
    below = line.plan.texts(hanging) if hanging else []
    scale, piece = line.plan.scale, Piece()
    half = line.plan.discs.get(disc.name, 0.0) if disc else 0.0
    if disc:
        with piece.owned("element", disc.name):
            piece.strokes += outlines.disc(0, half, scale * outlines.DISC_WIDTH)
            piece.boxes.append((-8 * scale, 8 * scale, -half, half))
            piece.write(0, half + 3, above)
    if hanging:
        with piece.owned("element", hanging.name):
            _hang(line, piece, hanging, -half, below)
    return piece


def _hang(line: PlannedRow, piece: Piece, element: Element, y: float, texts: Texts) -> None:
    """Draw an element of the schematic downwards from y to its far end, texts below and marks of its sensors above."""
    length, half_width = 14.0, 8.0
    y = _tapped(line, piece, element, y)
    if element.glyph == "clamp":
        piece.strokes.append(Stroke(((0, y), (0, y - length))))
    else:
        glyph = line.plan.glyph(element)
        length, half_width = glyph.length, glyph.half_width
        piece.strokes += glyph.hanging(0, y)
    end = far_end(element, line.values)
    foot = outlines.ground(0, y - length) if end == GROUND else outlines.mass(0, y - length) if end else []
    piece.strokes += foot
    bottom = min([y - length, *(v for stroke in foot for _, v in stroke.points)]) - 1
    wide = max(half_width, outlines.GROUND_WIDTH / 2 + 1)
    piece.boxes.append((-wide, wide, bottom, y))
    piece.write(0, bottom - 2, texts, upward=False)


def _tapped(line: PlannedRow, piece: Piece, element: Element, y: float) -> float:
    """Draw the marks of an element's torque sensors downwards, and return the y in points where the element begins."""
    for tap in line.plan.sensors_on(element):
        mark = tap.mark(alone=True)
        texts = mark.texts
        height = sum(LEADING * ROLES[role].size for _, role in texts) + 4
        piece.strokes.append(Stroke(((0, y), (0, y - height))))
        with piece.owned("sensor", tap.name):
            piece.strokes += outlines.side_mark(0, y - height / 2, LEADER)
            piece.boxes += [(-6, LEADER, y - height / 2 - 5, y - height / 2 + 5), (-4, 4, y - height, y)]
            piece.write(LEADER + 3 + label_width(texts) / 2, y - 2, texts, upward=False)
        y -= height
    return y


def draw_line_end(line: PlannedRow, element: Element) -> float:
    """Draw the element to ground or a mass that ends a shaft line, and return the x in points where the shaft stops."""
    texts = line.plan.texts(element)
    glyph = None if element.glyph == "clamp" else line.plan.glyph(element)
    length, half_width = (glyph.length, glyph.half_width) if glyph else (0.0, 0.0)
    end = far_end(element, line.values)
    last = outlines.wall(length / 2, WALL) if end == GROUND else outlines.disc(length / 2 + 4, WALL) if end else []
    high = max(WALL, half_width) if end else half_width
    piece = Piece()
    with piece.owned("element", element.name):
        piece.strokes += [*(glyph.along(-length / 2, 0) if glyph else []), *last]
        piece.boxes.append((-length / 2, length / 2 + 8, -high, high))
        piece.write(0, high + 4, texts)
    return line.put(piece, length / 2 + 8, length / 2 + 8) - length / 2


# Boxes of a schematic for elements with three and more ports, as planetary sets, with the ports at their edges.

HALF_HEIGHT = 35.0
"""Half the height in points of a box of the schematic: room for a symbol and the names of the ports below it."""
BOX_GAP, STUB = 10.0, 12.0  # points: more than the texts in width, piece of shaft below a port


def draw_box(
    line: PlannedRow, vertex: Vertex, before: Link | None, after: Link | None, leaving: Sequence[tuple[Link, Vertex]]
) -> None:
    """Draw an element with three and more ports as a box on a shaft line of the schematic.

    The line enters left and goes on right, other ports below.
    """
    with line.block.owned(*vertex.owner):
        _draw(line, vertex, before, after, leaving)


def _draw(
    line: PlannedRow, vertex: Vertex, before: Link | None, after: Link | None, leaving: Sequence[tuple[Link, Vertex]]
) -> None:
    element = line.plan.connected.boxes[vertex.name]
    texts = line.plan.texts(element)
    below = _ports_below(line, vertex, element, leaving)
    side = max((text_width(link.port, "port") + 8 for link in (before, after) if link is not None), default=8.0)
    slots = [max(30.0, text_width(port, "port") + 8) for port in below]
    # Room for the symbol between the ports of the line, for the texts, and for the ports below side by side.
    width = max(2 * (symbols.HALF_SIZE + side), label_width(texts) + BOX_GAP, sum(slots) + 8)
    before_x, middle = line.x, line.keep_free(width)
    start, end = middle - width / 2, middle + width / 2
    line.block.line((before_x, 0), (start, 0))
    line.block.strokes.append(outlines.rectangle(start, end, -HALF_HEIGHT, HALF_HEIGHT, outlines.BOX))
    line.block.strokes += symbols.box_symbol(element, middle, HALF_HEIGHT - symbols.HALF_SIZE - 5)
    line.block.boxes.append((start, end, -HALF_HEIGHT, HALF_HEIGHT))
    line.block.write(middle, HALF_HEIGHT + 3, texts)
    for link, left in ((before, True), (after, False)):
        if link is not None:
            half = text_width(link.port, "port") / 2 + 4
            line.block.write(start + half if left else end - half, -10, [(link.port, "port")])
    x = middle - sum(slots) / 2
    for (port, use), slot in zip(below.items(), slots, strict=True):
        line.block.write(x + slot / 2, -HALF_HEIGHT + 2, [(port, "port")])
        _port(line, x + slot / 2, use, vertex.owner)
        x += slot


def _ports_below(
    line: PlannedRow, vertex: Vertex, element: BoxElement, leaving: Sequence[tuple[Link, Vertex]]
) -> dict[str, Any]:
    """Targets of the ports at the lower edge of a schematic's box by port, a node, box or loop, None for ground."""
    below: dict[str, Any] = {link.port: child for link, child in leaving}
    below |= {link.port: (number, link, end) for number, link, end in line.plan.loops.get(vertex, ())}
    return below | {port: None for port, node in element.ports.items() if node == "ground"}


def _port(line: PlannedRow, x: float, use: Any, owner: Owner) -> None:
    if isinstance(use, Vertex):
        line.exits.append(BranchStart(x, -HALF_HEIGHT, use, owner=owner))
    elif use is None:
        line.block.strokes += [
            Stroke(((x, -HALF_HEIGHT), (x, -HALF_HEIGHT - 10))),
            *outlines.ground(x, -HALF_HEIGHT - 10),
        ]
        line.block.boxes.append((x - 14, x + 14, -HALF_HEIGHT - 17, -HALF_HEIGHT))
    else:
        line.exits.append(BranchStart(x, -HALF_HEIGHT, _loop(line, owner, *use), owner=owner))


def _loop(line: PlannedRow, owner: Owner, number: int, link: Link, end: Vertex) -> Piece:
    """Drawing of a short shaft with a loose end, at a port of a schematic's box whose link closes a loop."""
    piece = type(line)(line.plan, wall=6.0)
    with piece.block.owned(*owner):
        piece.block.line((0, 0), (STUB, 0))
        piece.x = STUB
        piece.draw_marks_on_shaft(piece.link_marks(end.name, link))
    piece.add_loose_end(number, end)
    return piece.block


GAP = 9.0
"""Distance in points between the texts of gears side by side in a schematic."""


Leaving: TypeAlias = Sequence[tuple[Link, Vertex]]
NodeSymbol: TypeAlias = "Mark | tuple[Element | None, Element | None]"
"""Symbol at a node of a schematic, a mark on the shaft, or a pair of a disc and the element that hangs below it."""

DrawBranch: TypeAlias = Callable[[BranchStart], Branch]
"""Function that takes a branch of the schematic still to be placed and returns it with its finished drawing."""


class ShaftLine(PlannedRow):
    """Builder of a shaft line of a schematic along y = 0 from left to right; ``x`` is where the line ends so far."""

    def begin(self, incoming: Link, parent: Vertex | None, head: Vertex) -> None:
        """Draw the start of a schematic's branch line, a shaft beside its gear wheels or elements behind its wire."""
        if incoming.is_gear:
            widths = self.gear_widths(incoming)
            self.x = sum(widths) - (widths[0] + widths[-1]) / 2 + ELBOW + 4
            self.wall = self.x + 2
            with self.block.owned(*head.owner):
                self.block.line((ELBOW, 0), (self.x, 0))
            return
        self.wall = 6.0
        self.draw_incoming(incoming, parent)
        if not incoming.elements:
            with self.block.owned(*head.owner):
                self.block.line((self.x, 0), (self.x + 10, 0))
            self.x += 10

    def draw_incoming(self, incoming: Link, parent: Vertex | None) -> None:
        """Draw the elements between a node of the parent line and this line, with the torque marks of that node."""
        if parent is not None and not parent.is_box:
            with self.block.owned(*parent.owner):
                self.draw_marks_on_shaft(self.link_marks(parent.name, incoming))
        if incoming.elements:
            self.draw_link(incoming)

    def gear_widths(self, link: Link) -> list[float]:
        """List of the widths in points that the gears of a link take side by side with their texts."""
        return [max(26.0, label_width(self.plan.texts(element)) + GAP) for element in link.elements]

    def draw_vertex(
        self,
        vertex: Vertex,
        before: Link | None,
        after: Link | None,
        leaving: Leaving,
        share: tuple[int, int] = (0, 1),
    ) -> None:
        """Draw on the shaft line a box, a node, or a part of a node that has too many symbols for one line."""
        if vertex.is_box:
            draw_box(self, vertex, before, after, leaving)
            return
        with self.block.owned(*vertex.owner):
            if share[0] == share[1] - 1:
                self.draw_node(vertex, before, after, leaving, share)
            else:
                self.draw_part_of_node(vertex, before, share)

    def draw_part_of_node(self, vertex: Vertex, before: Link | None, share: tuple[int, int]) -> None:
        """Draw on the shaft line a part of the symbols of a node that has too many for one line."""
        start = self.x
        self.draw_marks(self.link_marks(vertex.name, before))
        self.draw_symbols(self.node_symbols(vertex.name, at_end=False)[0], share)
        named = self.name(start, self.plan.node_texts(vertex.name))
        self.block.line((start, 0), (self.x, 0))
        self.brackets.append((start, named, vertex.name))

    def node_symbols(self, node: str, *, at_end: bool) -> tuple[list[NodeSymbol], Element | None]:
        """List of the symbols at a node in their order on the shaft, and the element that ends the line, if any.

        Torques of elements that lead on from the node or down to ground are left out: they stand beside the element.
        """
        bodies, held = self.plan.bodies(node, at_end=at_end)
        placed = {element.name for element in (held, *(hanging for _, hanging in bodies)) if element is not None}
        others = [
            tap.mark(alone=False)
            for tap in self.plan.taps.get(node, ())
            if tap.element not in placed and not self.plan.is_drawn_beside(tap, node)
        ]
        return [*self.input_and_motion_marks(node), *bodies, *others], held

    def draw_symbols(self, things: Sequence[NodeSymbol], share: tuple[int, int]) -> None:
        """Draw on the shaft line one part of the symbols at a node; many marks beside each other stand in two rows."""
        part, parts = share
        size = -(-len(things) // parts)
        for _, group in groupby(things[part * size : (part + 1) * size], lambda thing: isinstance(thing, Mark)):
            alike = list(group)
            self.draw_marks([thing for thing in alike if isinstance(thing, Mark)])
            for pair in (thing for thing in alike if not isinstance(thing, Mark)):
                draw_body(self, *pair)

    def draw_node(
        self, vertex: Vertex, before: Link | None, after: Link | None, leaving: Leaving, share: tuple[int, int]
    ) -> None:
        """Draw on the shaft line a node with its symbols, its branches, and the elements that close loops."""
        start, node = self.x, vertex.name
        loops, targets = self.plan.loops.get(vertex, ()), self.plan.targets.get(node, ())
        branches = bool(leaving or loops or targets)
        things, held = self.node_symbols(node, at_end=not (after or branches))
        self.draw_marks(self.link_marks(node, before))
        self.draw_symbols(things, share)
        late = self.link_marks(node, after)
        if held is not None:
            late = [tap.mark(alone=True) for tap in self.plan.sensors_on(held)]
        if not branches:
            self.draw_marks(late)
        named = self.name(start, self.plan.node_texts(node)) if held is None else self.x
        for place, (link, child) in enumerate(leaving, 1):
            self.add_branch(link, child, vertex, alone=place == len(leaving) and not (after or loops or targets))
        for number, link, target in loops:
            self.add_loop(number, link, target)
        for number in targets:
            self.block.anchors[number] = (self.keep_free(14), 0)
        if branches:
            self.draw_marks(late)
        end = self.x
        if held is not None:
            end = draw_line_end(self, held)
            named = self.name(start, self.plan.node_texts(node))
        elif leaving and leaving[-1][0].is_gear and not (after or loops or targets):
            end = self.exits[-1].last
        self.block.line((start, 0), (end, 0))
        self.brackets.append((start, named, node))

    def input_and_motion_marks(self, node: str) -> list[Mark]:
        """List of the marks of the inputs, reactions and motion sensors at a node of the schematic."""
        inputs = [Mark("input", symbol(name), what, name) for name, what in self.plan.inputs.get(node, ())]
        inputs += [
            Mark("reaction", f"\u2212{symbol(name)}", what, name) for name, what in self.plan.reactions.get(node, ())
        ]
        return inputs + [Mark("motion", symbol(name), what, name) for name, what in self.plan.motions.get(node, ())]

    def add_branch(self, link: Link, child: Vertex, parent: Vertex, *, alone: bool) -> None:
        """Add a branch from this shaft line to a node or box of the schematic.

        ``alone`` if nothing else goes on from the node.
        """
        if not link.is_gear:
            self.exits.append(BranchStart(self.keep_free(16), 0, child, owner=parent.owner))
            return
        self.draw_marks(self.link_marks(parent.name, link, alone=alone))
        widths, stages = self.gear_widths(link), []
        places = [self.keep_free(width) for width in widths]
        first = places[0]
        for element, offset in zip(link.elements, (place - first for place in places), strict=True):
            ratio = wheel_ratio(element, parent.name, self.values)
            stages.append(GearPair(element, offset, self.plan.texts(element), ratio))
        self.exits.append(BranchStart(first, 0, child, tuple(stages), parent.owner))

    def add_loop(self, number: int, link: Link, end: Vertex) -> None:
        """Draw the elements that close a loop of the schematic, on a line of their own with a loose end."""
        line = ShaftLine(self.plan, wall=6.0)
        line.draw_incoming(link, link.other(end))
        with line.block.owned(*end.owner):
            line.draw_marks_on_shaft(line.link_marks(end.name, link))
        line.add_loose_end(number, end)
        self.exits.append(BranchStart(self.keep_free(16), 0, line.block, owner=link.other(end).owner))

    def draw_link(self, link: Link) -> None:
        """Draw the elements of a link in parallel on the shaft line; a port of a box is a short piece of shaft."""
        if not link.elements:
            with self.block.owned(*link.first.owner):
                self.block.line((self.x, 0), (self.x + 12, 0))
            self.x += 12
            return
        drawn = self.plan.links_drawn
        if id(link) not in drawn:
            drawn[id(link)] = _between(self.plan, link)
        piece, span, columns = drawn[id(link)]
        start, left, right = self.x, -span / 2, span / 2
        middle = self.put(piece, span / 2 + 3, span / 2 + 3, columns)
        with self.block.owned("element", link.elements[0].name):
            self.block.line((start, 0), (middle + left, 0))
            self.block.line((middle + right, 0), (self.x, 0))

    def finish(self, settle: DrawBranch, *, may_rise: bool) -> Piece:
        """Write the names of the nodes above the line, add its branches, and return the drawing of the shaft line."""
        top = max((draw_box[3] for draw_box in self.block.boxes), default=0.0) + 5
        for x0, x1, node in self.brackets:
            with self.block.owned("node", node):
                self.draw_bracket(x0 + 3, x1 - 3, top)
                self.block.write((x0 + x1) / 2, top + 1, self.plan.node_texts(node))
        place_branches(self.block, [settle(each) for each in self.exits], may_rise=may_rise)
        self.block.anchors[-1] = (self.x, 0)
        return self.block


def _between(plan: DrawingPlan, link: Link) -> tuple[Piece, float, list[Box]]:
    """Drawing around x = 0 of the elements of a link, its width in points, and rectangles in points to be kept free."""
    drawn = [plan.glyph(element) for element in link.elements]
    texts = [plan.texts(element) for element in link.elements]
    rails = 12.0 if len(drawn) > 1 else 0.0
    # The texts of all but the first element stand between the rails.
    span = max(*(glyph.length for glyph in drawn), *(label_width(lines) for lines in texts[1:]), 0.0) + rails
    piece = Piece()
    left, right, y = -span / 2, span / 2, 0.0
    for place, (glyph, lines) in enumerate(zip(drawn, texts, strict=True)):
        if place:
            y -= (
                drawn[place - 1].half_width
                + 8
                + sum(LEADING * ROLES[role].size for _, role in lines)
                + glyph.half_width
            )
        with piece.owned("element", link.elements[place].name):
            _parallel_element(piece, glyph, lines, (left, right), y, below=not rails)
    with piece.owned("element", link.elements[0].name):
        for x in (left, right) if rails else ():
            piece.line((x, 0), (x, y))
    return piece, span, [(left, right, y, 0)] if rails else []


def _parallel_element(
    block: Piece, glyph: Glyph, texts: Texts, ends: tuple[float, float], y: float, *, below: bool
) -> None:
    """Draw an element between two ends, with its texts below if it is alone on its shaft, else above the element."""
    middle = (ends[0] + ends[1]) / 2
    begin = middle - glyph.length / 2
    block.strokes += glyph.along(begin, y)
    block.boxes.append((*ends, y - glyph.half_width, y + glyph.half_width))
    block.write(middle, y - glyph.half_width - 2 if below else y + glyph.half_width + 2, texts, upward=not below)
    if begin > ends[0]:
        block.line((ends[0], y), (begin, y))
        block.line((begin + glyph.length, y), (ends[1], y))
