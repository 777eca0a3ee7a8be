"""One shaft line of a schematic: nodes, the elements between them, and what leaves the line."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from torsionnet.report import glyphs
from torsionnet.report.blocks import LEADING, ROLES, Block, LooseEnd, Stroke, Texts, text_width, widest
from torsionnet.report.bodies import body, ending
from torsionnet.report.boxes import box
from torsionnet.report.drops import ELBOW, Drop, Exit, Stage, attach, ratio_of
from torsionnet.report.labels import symbol
from torsionnet.report.texts import broken
from torsionnet.report.topology import Link, Vertex

if TYPE_CHECKING:
    from torsionnet.report.plan import Plan

GAP = 9.0
Leaving: TypeAlias = Sequence[tuple[Link, Vertex]]
Settle: TypeAlias = Callable[[Exit], Drop]
"""Gives what leaves a line its block."""


class Line:
    """Builds a line along y = 0 from left to right; ``x`` is how far it has come."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.block = Block()
        self.x = 0.0
        self.exits: list[Exit] = []
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
            box(self, vertex, before, after, leaving)
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
        for link, child in leaving:
            self.leave(link, child, vertex)
        for number, link, target in loops:
            self.close(number, link, target)
        for number in targets:
            self.block.anchors[number] = (self.stretch(14), 0)
        end = self.x
        if held is not None:
            end = ending(self, held)
            named = self.pad(node, start)
        elif leaving and leaving[-1][0].is_gear and not (after or loops or targets):
            end = self.exits[-1].last
        self.block.line((start, 0), (end, 0))
        self.brackets.append((start, named, node))

    def pad(self, node: str, start: float) -> float:
        """Make a station wide enough for its name."""
        self.x += max(0, widest(self.plan.node_texts(node)) + 8 - (self.x - start))
        return self.x

    def marker(self, texts: Texts, strokes: Callable[[float], list[Stroke]], top: float) -> None:
        """A mark on the shaft with a name above it."""
        texts = broken(texts)
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
        for name, what, element in self.plan.taps.get(node, ()):
            if wanted(element):
                texts = [(symbol(name), "sensor"), (what, "what")]
                self.marker(texts, lambda x: glyphs.sensor_mark(x, torque=True), 20)

    def leave(self, link: Link, child: Vertex, parent: Vertex) -> None:
        if not link.is_gear:
            self.exits.append(Exit(self.stretch(18), 0, child))
            return
        widths, stages = self.gear_widths(link), []
        first = self.x + widths[0] / 2
        for element, width in zip(link.elements, widths, strict=True):
            offset = self.stretch(width) - first
            ratio = ratio_of(element, parent.name, self.values)
            stages.append(Stage(element, offset, self.plan.texts(element), ratio))
        self.exits.append(Exit(first, 0, child, tuple(stages)))

    def close(self, number: int, link: Link, end: Vertex) -> None:
        """An element that closes a loop, on a line of its own with a loose end."""
        line = Line(self.plan)
        line.gap(link)
        line.loose(number, end)
        self.exits.append(Exit(self.stretch(18), 0, line.block))

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
        drawn = [glyphs.inline_glyph(element, self.values).scaled(self.plan.scale) for element in link.elements]
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

    def finish(self, settle: Settle, *, may_rise: bool) -> Block:
        """Name the nodes above everything else on the line, then let the other lines leave."""
        top = max((box[3] for box in self.block.boxes), default=0.0) + 5
        for x0, x1, node in self.brackets:
            self.bracket(x0 + 3, x1 - 3, top)
            self.block.write((x0 + x1) / 2, top + 1, self.plan.node_texts(node))
        attach(self.block, [settle(each) for each in self.exits], may_rise=may_rise)
        self.block.anchors[-1] = (self.x, 0)
        return self.block

    def bracket(self, x0: float, x1: float, y: float) -> None:
        self.block.strokes.append(Stroke(((x0, y - 3), (x0, y), (x1, y), (x1, y - 3)), "faint"))
        self.block.boxes.append((x0, x1, y - 2, y + 1))
