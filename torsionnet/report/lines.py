"""One shaft line of a schematic: nodes, the elements between them, and what leaves the line."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from torsionnet.report import glyphs
from torsionnet.report.blocks import LEADING, ROLES, Block, LooseEnd, Stroke, text_width, widest
from torsionnet.report.bodies import body, ending
from torsionnet.report.drops import ELBOW, Drop, Stage, attach, ratio_of
from torsionnet.report.labels import symbol
from torsionnet.report.topology import Link, Vertex

if TYPE_CHECKING:
    from torsionnet.elements import Element
    from torsionnet.report.layout import Plan

GAP = 10.0
BOX_HALF = 27.0
Texts: TypeAlias = list[tuple[str, str]]
Leaving: TypeAlias = Sequence[tuple[Link, Block]]


class Line:
    """Builds a line along y = 0 from left to right; ``x`` is how far it has come."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.block = Block()
        self.x = 0.0
        self.drops: list[Drop] = []
        self.brackets: list[tuple[float, float, str]] = []

    @property
    def values(self) -> Any:
        return self.plan.drivetrain.exact_values

    def stretch(self, width: float) -> float:
        """Go on by a width; gives its middle."""
        self.x += width
        return self.x - width / 2

    def begin(self, incoming: Link) -> None:
        """Come from another line: through gears in the first stretches, else by the elements after a wire."""
        if incoming.is_gear:
            widths = self.gear_widths(incoming)
            self.x = sum(widths) - widths[0] / 2
            self.block.line((ELBOW, 0), (self.x, 0))
        elif incoming.elements:
            self.gap(incoming)
        else:
            self.block.line((0, 0), (8, 0))
            self.x = 8

    def gear_widths(self, link: Link) -> list[float]:
        return [max(26.0, widest(self.plan.texts(element)) + GAP) for element in link.elements]

    def vertex(self, vertex: Vertex, before: Link | None, after: Link | None, leaving: Leaving) -> None:
        if vertex.is_box:
            self.box(vertex, before, after, leaving)
        else:
            self.station(vertex, before, after, leaving)

    def station(self, vertex: Vertex, before: Link | None, after: Link | None, leaving: Leaving) -> None:
        """Everything at one node."""
        start, node = self.x, vertex.name
        loops, targets = self.plan.loops.get(vertex, ()), self.plan.targets.get(node, ())
        early = {element.name for element in before.elements} if before else set()
        self.taps(node, lambda element: element in early)
        self.inputs_and_motion(node)
        last = not (after or leaving or loops or targets)
        bodies, held = self.plan.bodies(node, at_end=last)
        for discs, hanging in bodies:
            body(self, discs, hanging)
        self.taps(node, lambda element: element not in early)
        if held is None:
            self.pad(node, start)
        named = self.x
        for link, block in leaving:
            self.leave(link, block, vertex)
        for number, link, target in loops:
            self.close(number, link, target)
        for number in targets:
            self.block.anchors[number] = (self.stretch(14), 0)
        end = self.x
        if held is not None:
            end = ending(self, held)
            named = self.pad(node, start)
        elif leaving and leaving[-1][0].is_gear and not (after or loops or targets):
            end = self.drops[-1].last
        self.block.line((start, 0), (end, 0))
        self.brackets.append((start, named, node))

    def pad(self, node: str, start: float) -> float:
        """Make a station wide enough for its name."""
        self.x += max(0, text_width(node, "node") + 8 - (self.x - start))
        return self.x

    def marker(self, texts: Texts, strokes: Callable[[float], list[Stroke]], top: float) -> None:
        """A mark on the shaft with a name above it."""
        middle = self.stretch(max(18.0, widest(texts) + GAP))
        self.block.strokes += strokes(middle)
        self.block.boxes.append((middle - 8, middle + 8, -top if top < 20 else -5, top))  # noqa: PLR2004
        self.block.write(middle, top, texts)

    def inputs_and_motion(self, node: str) -> None:
        for name, what in self.plan.inputs.get(node, ()):
            self.marker([(symbol(name), "input"), (what, "what")], glyphs.torque_arrow, 19)
        for name, what in self.plan.motions.get(node, ()):
            texts = [(symbol(name), "sensor"), (what, "what")]
            self.marker(texts, lambda x: glyphs.sensor_mark(x, torque=False), 20)

    def taps(self, node: str, wanted: Callable[[str], bool]) -> None:
        """Torques and twists taken at this node."""
        for name, quantity, element in self.plan.taps.get(node, ()):
            if wanted(element):
                texts = [(symbol(name), "sensor"), (quantity, "what")]
                self.marker(texts, lambda x: glyphs.sensor_mark(x, torque=True), 20)

    def leave(self, link: Link, block: Block, parent: Vertex) -> None:
        if not link.is_gear:
            self.drops.append(Drop(self.stretch(18), 0, block))
            return
        widths, stages = self.gear_widths(link), []
        first = self.x + widths[0] / 2
        for element, width in zip(link.elements, widths, strict=True):
            offset = self.stretch(width) - first
            ratio = ratio_of(element, parent.name, self.values)
            stages.append(Stage(element, offset, self.plan.texts(element), ratio))
        self.drops.append(Drop(first, 0, block, tuple(stages)))

    def close(self, number: int, link: Link, end: Vertex) -> None:
        """An element that closes a loop, on a line of its own with a loose end."""
        line = Line(self.plan)
        line.gap(link)
        line.loose(number, end)
        self.drops.append(Drop(self.stretch(18), 0, line.block))

    def loose(self, number: int, end: Vertex) -> None:
        """Lead to the node, or name it where no way is free: room for the name is kept either way."""
        width = text_width(end.name, "node") + 10
        tag = (self.x, self.x + width, -8.0, 8.0)
        self.block.ends.append(LooseEnd(number, end.name, self.x, 0, tag))
        self.block.boxes.append(tag)
        self.x += width

    def gap(self, link: Link) -> None:
        """The elements of a link, in parallel; a port of a box is a short piece of shaft."""
        if not link.elements:
            self.block.line((self.x, 0), (self.x + 12, 0))
            self.x += 12
            return
        drawn = [glyphs.inline_glyph(element, self.values) for element in link.elements]
        texts = [self.plan.texts(element) for element in link.elements]
        rails = 12.0 if len(drawn) > 1 else 0.0
        # The texts of all but the first strand stand between the rails.
        span = max(*(glyph.length for glyph in drawn), *(widest(lines) for lines in texts[1:]), 0.0) + rails
        start = self.x
        middle = self.stretch(max(span + 6, *(widest(lines) + GAP for lines in texts)))
        left, right, y = middle - span / 2, middle + span / 2, 0.0
        for place, (glyph, lines) in enumerate(zip(drawn, texts, strict=True)):
            if place:
                y -= drawn[place - 1].reach + 8 + sum(LEADING * ROLES[role].size for _, role in lines) + glyph.reach
            self.strand(glyph, lines, (left, right), y)
        for x in (left, right) if rails else ():
            self.block.line((x, 0), (x, y))
        self.block.line((start, 0), (left, 0))
        self.block.line((right, 0), (self.x, 0))

    def strand(self, glyph: glyphs.Glyph, texts: Texts, ends: tuple[float, float], y: float) -> None:
        """One of the elements side by side."""
        middle = (ends[0] + ends[1]) / 2
        begin = middle - glyph.length / 2
        self.block.strokes += glyph.along(begin, y)
        self.block.boxes.append((*ends, y - glyph.reach, y + glyph.reach))
        self.block.write(middle, y + glyph.reach + 2, texts)
        if begin > ends[0]:
            self.block.line((ends[0], y), (begin, y))
            self.block.line((begin + glyph.length, y), (ends[1], y))

    def box(self, vertex: Vertex, before: Link | None, after: Link | None, leaving: Leaving) -> None:
        """An element with three ports: in on the left, on to the right, the others below."""
        element, texts = self.plan.found.boxes[vertex.name], self.plan.texts(self.plan.found.boxes[vertex.name])
        below = self.ports_below(vertex, element, leaving)
        sides = sum(text_width(link.port, "port") + 8 for link in (before, after) if link is not None)
        slots = [max(30.0, text_width(port, "port") + 8) for port in below]
        width = max(70.0, widest(texts) + GAP, sides + 8, sum(slots) + 8)
        start, middle = self.x, self.stretch(width)
        self.block.strokes.append(glyphs.rectangle(start, self.x, -BOX_HALF, BOX_HALF, glyphs.WHEEL))
        self.block.boxes.append((start, self.x, -BOX_HALF, BOX_HALF))
        self.block.write(middle, BOX_HALF + 3, texts)
        for link, left in ((before, True), (after, False)):
            if link is not None:
                half = text_width(link.port, "port") / 2 + 4
                self.block.write(start + half if left else self.x - half, -3, [(link.port, "port")])
        x = middle - sum(slots) / 2
        for (port, use), slot in zip(below.items(), slots, strict=True):
            self.block.write(x + slot / 2, -BOX_HALF + 2, [(port, "port")])
            self.port(x + slot / 2, use)
            x += slot

    def ports_below(self, vertex: Vertex, element: Element, leaving: Leaving) -> dict[str, Any]:
        """Port to what is there: a block, a loop, or None for ground."""
        below: dict[str, Any] = {link.port: block for link, block in leaving}
        below |= {link.port: (number, end) for number, link, end in self.plan.loops.get(vertex, ())}
        return below | {port: None for port, node in element.ports.items() if node == "ground"}

    def port(self, x: float, use: Any) -> None:
        if isinstance(use, Block):
            self.drops.append(Drop(x, -BOX_HALF, use))
        elif use is None:
            self.block.strokes += [
                Stroke(((x, -BOX_HALF), (x, -BOX_HALF - 10))),
                *glyphs.ground(x, -BOX_HALF - 10),
            ]
            self.block.boxes.append((x - 14, x + 14, -BOX_HALF - 17, -BOX_HALF))
        else:
            line = Line(self.plan)
            line.block.line((0, 0), (12, 0))
            line.x = 12
            line.loose(*use)
            self.drops.append(Drop(x, -BOX_HALF, line.block))

    def finish(self, *, may_rise: bool) -> Block:
        """Name the nodes above everything else on the line, then let the other lines leave."""
        top = max((box[3] for box in self.block.boxes), default=0.0) + 5
        for x0, x1, node in self.brackets:
            self.block.strokes.append(
                Stroke(((x0 + 3, top - 3), (x0 + 3, top), (x1 - 3, top), (x1 - 3, top - 3)), "faint")
            )
            self.block.boxes.append((x0 + 3, x1 - 3, top - 2, top + 1))
            self.block.write((x0 + x1) / 2, top + 1, [(node, "node")])
        attach(self.block, self.drops, may_rise=may_rise)
        self.block.anchors[-1] = (self.x, 0)
        return self.block
