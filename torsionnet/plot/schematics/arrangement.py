"""Arrangement of a schematic on a page, with the connected parts of a drivetrain beside each other and a title.

Layout of a schematic, with shaft lines from left to right, branches and gear stages on lines of their own. A line is
built from its first vertex onwards, every symbol in a stretch as wide as the symbol and its texts; branches are then
moved down (or up) to the nearest free place. A line wider than the page is cut and goes on below; a branch without room
begins a band of its own, with flags at both ends. All lengths are in points.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Hashable, Sequence
from dataclasses import fields
from itertools import pairwise, zip_longest
from threading import Lock
from typing import TYPE_CHECKING

from torsionnet.base.errors import UsageError
from torsionnet.base.registers import RecentResults
from torsionnet.model.elements import Element
from torsionnet.plot.drawing.labels import value_lines
from torsionnet.plot.drawing.pieces import LEADING, ROLES, Box, Label, Piece, Stroke, text_width
from torsionnet.plot.schematics.drawing_plan import MOST_NAMED_NODES, DrawingPlan, disc_sizes, make_plan, wrap_text
from torsionnet.plot.schematics.line_routes import (
    BranchWidth,
    LineRoute,
    RouteStep,
    line_routes,
    line_width,
    piece_starts,
)
from torsionnet.plot.schematics.outlines import POINTS_PER_INCH
from torsionnet.plot.schematics.shaft_lines import ShaftLine
from torsionnet.plot.schematics.symbols import inline_glyph
from torsionnet.plot.schematics.topology import Link, Tree, Vertex
from torsionnet.plot.schematics.wires import UP_IF, Branch, BranchStart, draw_loops

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain


# Layout of a schematic, with shaft lines from left to right, branches and gear stages on lines of their own.

PAGE_WIDTH = 545.0
"""Width of a schematic in points unless another is asked for."""

MARGIN = 24.0
"""Width in points kept free at each side for the wires from one piece of a cut shaft line to the next."""

WIRE_ROOM = 30.0
"""Width in points kept free at the sides for wires that close loops of the schematic."""

NARROWEST_BRANCH = 0.45
"""Least room beside a shaft line, as a share of the page's width, in which a branch may be cut into pieces."""

UP_IF_CUT = 1.5
"""Ratio of the distance upwards to that downwards below which a loop of the schematic is drawn above a shaft line that
is cut and goes on below: a larger value leads more of them above the line, out of its way."""
INDENT = 26.0
"""Width in points by which the pieces of a cut shaft line that begins at gears are indented, clear of the wheels."""


PLAIN = ("inertia", "spring", "damper")
"""Kinds of elements of which only sizes of discs, symbols and texts follow from values."""
BYTES_OF_STROKE = 1000
"""Size in bytes of a stroke with its points, roughly."""
_RECENT, _ARRANGING = RecentResults(), Lock()

TIP, HALF, PAD = 5.0, 7.0, 10.0  # points: tip of a flag, half its height, room beside its text
LONGEST_FLAG = 24
"""Largest number of characters of a node's name on a flag of the schematic, the sign where a branch is drawn elsewhere;
the rest is cut off."""


def layout_bands(drivetrain: Drivetrain, page: float = PAGE_WIDTH) -> list[list[Piece]]:
    """Drawings of shaft lines for a page width in points, a list from top to bottom for each connected part."""
    plan, grown = make_plan(drivetrain, page)
    if plan.loops:
        plan.page -= WIRE_ROOM
    return [PartLayout(tree, plan).bands() for tree in grown]


class PartLayout:
    """Layout of one connected part of a drivetrain in a schematic.

    Its lines, their widths, and the lines that wait for a band of their own.
    """

    def __init__(self, tree: Tree, plan: DrawingPlan) -> None:
        self.tree: Tree = tree
        self.plan: DrawingPlan = plan
        self.routes: dict[Vertex, LineRoute] = line_routes(tree)
        self.starts: dict[Vertex, float] = {}
        self.steps: dict[Vertex, list[RouteStep]] = {}
        self.needs: dict[Vertex, float] = {}
        self.waiting: deque[Vertex] = deque([tree.root])
        for head in reversed(self.routes):
            self._measure(head)

    def _measure(self, head: Vertex) -> None:
        """Store the widths in points of a shaft line of the schematic and its nodes, after those of its branches."""
        if math.isinf(self.plan.page):  # no line is cut
            self.starts[head], self.steps[head], self.needs[head] = 0.0, [RouteStep(0.0, 0.0, 0.0, ())], 0.0
            return
        self._steps(head)
        room = self.plan.page - MARGIN - INDENT
        wide = zip(self.routes[head].vertices, self.steps[head], strict=True)
        crowded = {vertex: math.ceil(step.whole / (0.8 * room)) for vertex, step in wide if step.whole > room}
        if crowded:
            self.routes[head] = self.routes[head].split(crowded)
            self._steps(head)
        self.needs[head] = line_width(self.starts[head], self.steps[head])

    def _steps(self, head: Vertex) -> None:
        route, line = self.routes[head], ShaftLine(self.plan, measures=True)
        if route.incoming is not None:
            line.begin(route.incoming, route.parent, head)
        self.starts[head] = line.x
        self.steps[head] = [self._draw_one(line, route.cut(place, place + 1)) for place in range(len(route.vertices))]

    def _draw_one(self, line: ShaftLine, route: LineRoute) -> RouteStep:
        """Draw one node or box of a shaft line, and return the widths in points that it takes."""
        start, boxes, columns, exits = line.x, len(line.block.boxes), len(line.columns), len(line.exits)
        self._fill(line, route)
        taken = [*line.block.boxes[boxes:], *line.columns[columns:]]
        left = start - min((box[0] for box in taken), default=start)
        right = max((box[1] for box in taken), default=line.x) - line.x
        heads = ((each, each.what) for each in line.exits[exits:])
        leaving = [BranchWidth(each.x - start, self.needs[what]) for each, what in heads if isinstance(what, Vertex)]
        return RouteStep(line.x - start, max(0.0, left), max(0.0, right), tuple(leaving))

    def bands(self) -> list[Piece]:
        """List of the drawings of the main line, and of each branch for which there was no room beside its own line."""
        bands = []
        while self.waiting:
            head = self.waiting.popleft()
            bands.append(self._band(head))
        return bands

    def _band(self, head: Vertex) -> Piece:
        route = self.routes[head]
        if route.incoming is None:
            return self._route(head, self.plan.page, top=True)
        came = route.incoming
        line = ShaftLine(self.plan)
        with line.block.owned("node", self._shared_node(head)):
            line.x = _flag(line.block, 0.0, self._shared_node(head)) + 6
            line.block.line((line.x - 6, 0), (line.x, 0))
        if not came.is_gear:
            line.draw_incoming(came, route.parent)
        return self._route(head, self.plan.page, top=True, begun=line)

    def _route(self, head: Vertex, room: float, *, top: bool = False, begun: ShaftLine | None = None) -> Piece:
        """Drawing of a shaft line with all its branches, cut into pieces if it is wider than ``room`` points."""
        route = self.routes[head]
        start = begun.x if begun is not None else self.starts[head]
        indent = INDENT if begun is None and route.incoming is not None and route.incoming.is_gear else 0.0
        begins = piece_starts(start, self.steps[head], room, MARGIN + indent)
        narrow = room if len(begins) == 1 else room - MARGIN - indent
        built = []
        for first, last in zip_longest(begins, begins[1:], fillvalue=len(route.vertices)):
            piece = route.cut(first, last)
            line = ShaftLine(self.plan)
            if first == 0 and begun is not None:
                line = begun
            elif piece.incoming is not None:
                line.begin(piece.incoming, piece.parent, head)
            self._fill(line, piece)
            built.append(self._finished(line, narrow, may_rise=top and first == 0, loops_up=last < len(route.vertices)))
        return _stacked(built, indent)

    def _fill(self, line: ShaftLine, route: LineRoute) -> None:
        before = route.incoming or route.before
        for place, (vertex, onward) in enumerate(zip_longest(route.vertices, route.links)):
            leaving = [pair for pair in self.tree.children[vertex] if self._leaves(pair)]
            line.draw_vertex(vertex, before, onward, leaving, route.share(place))
            if onward is not None:
                line.draw_link(onward)
            before = onward

    def _leaves(self, pair: tuple[Link, Vertex]) -> bool:
        return pair[1] in self.routes and self.routes[pair[1]].incoming is pair[0]

    def _finished(self, line: ShaftLine, room: float, *, may_rise: bool, loops_up: bool) -> Piece:
        overhang = max(0.0, -min((box[0] for box in line.block.boxes), default=0.0))
        # Where the line goes on below, what leads a loop around it stays out of its way.
        return line.finish(
            lambda each: self._drawn_branch(each, room - overhang - each.x, UP_IF_CUT if loops_up else UP_IF),
            may_rise=may_rise,
        )

    def _drawn_branch(self, leaving: BranchStart, room: float, loops_up_if: float) -> Branch:
        """Branch of the schematic with its line as finished drawing, or a flag if there is no room for the line."""
        x, y, what, stages = leaving.x, leaving.y, leaving.what, leaving.stages
        if isinstance(what, Piece):
            return Branch(x, y, what, stages, up_if=loops_up_if, owner=leaving.owner)
        if self.needs[what] <= room or self._may_be_cut(what, room):
            up_if = UP_IF if self.needs[what] <= room else 0.0
            return Branch(x, y, self._route(what, room), stages, up_if=up_if, owner=leaving.owner)
        self.waiting.append(what)
        block = Piece()
        begin = stages[-1].offset + 18 if stages else 12.0
        with block.owned("node", self._shared_node(what)):
            block.line((0, 0), (begin, 0))
            _flag(block, begin, self._shared_node(what))
        return Branch(x, y, block, stages, owner=leaving.owner)

    def _shared_node(self, head: Vertex) -> str:
        """Name of the node on the flags that mark where a branch leaves its line and where it is drawn instead."""
        route = self.routes[head]
        shaft = route.incoming is not None and route.incoming.elements and not route.incoming.is_gear
        return route.parent.name if shaft and route.parent is not None else head.name

    def _may_be_cut(self, head: Vertex, room: float) -> bool:
        """Whether a branch too wide for a page needs no more pieces in a ``room`` in points than on a whole page."""
        steps, start = self.steps[head], self.starts[head]
        if room < max(NARROWEST_BRANCH * self.plan.page, start, *(step.whole + MARGIN + INDENT for step in steps)):
            return False
        return (
            len(piece_starts(start, steps, room, MARGIN + INDENT))
            <= len(piece_starts(start, steps, self.plan.page, MARGIN))
            > 1
        )


def _stacked(built: list[Piece], indent: float) -> Piece:
    """Drawing of the pieces of a cut shaft line one below the other, joined by wires."""
    whole = built[0]
    for before, piece in pairwise(built):
        bottom = whole.extent[2]
        drop, lane, edge = bottom - 30 - piece.extent[3], bottom - 14, indent - 14
        begin, x_before = indent - piece.extent[0], indent - before.extent[0] if before is not built[0] else 0.0
        x, y = whole.anchors.pop(-1)
        far = x_before + before.extent[1] + 8
        whole.line((x, y), (far, y), (far, lane), (edge, lane), (edge, drop), (begin, drop))
        whole.add(piece.shifted(begin, drop))
    whole.anchors.pop(-1, None)
    return whole


def _flag(block: Piece, x: float, text: str) -> float:
    """Draw a flag with a text on a shaft, from (x, 0) to the right, and return the x in points at the flag's tip."""
    shown = text if len(text) <= LONGEST_FLAG else text[: LONGEST_FLAG - 1] + "…"
    end = x + text_width(shown, "what") + 2 * TIP + PAD
    outline = ((x, -HALF), (end - TIP, -HALF), (end, 0.0), (end - TIP, HALF), (x, HALF))
    block.strokes.append(Stroke(outline, "thin", closed=True, fill="#ffffff"))
    block.boxes.append((x, end, -HALF, HALF))
    block.write((x + end - TIP) / 2, -4.4, [(shown, "what")])
    return end


EDGE, BETWEEN, BESIDE = 10.0, 26.0, 40.0  # points: margin, gap between rows of parts, gap between parts
MILLIMETRES_PER_INCH = 25.4
"""Millimetres in an inch."""
PAPER_WIDTH, LEGIBLE = 170.0, 6.0
"""Text width of an A4 page in mm, and size in points of the smallest text when printed at the page's width."""

NARROWEST_PAGE = 100.0
"""Least width of a page in mm; on a narrower one single symbols with their texts would not fit."""


def edges_under_title(whole: Piece, title: str, page: float) -> Box:
    """Edges x0, x1, y0, y1 in points of a drawing under a title, which is written above it and broken to the page."""
    x0, x1, y0, y1 = whole.extent
    for line in reversed(wrap_text(title, "title", page)):
        whole.labels.append(Label(x0, y1 + 16, line, "title", left=True))
        y1 += LEADING * ROLES["title"].size
        x1 = max(x1, x0 + text_width(line, "title"))
    return x0, x1, y0, y1 + (16 if title else 0)


def framed(extent: Box) -> Box:
    """Edges x0, x1, y0, y1 in points of a drawing with a margin around it."""
    x0, x1, y0, y1 = extent
    return x0 - EDGE, x1 + EDGE, y0 - EDGE, y1 + EDGE


def page_width(width: float) -> float:
    """Width in points of a drawing for a page width in mm."""
    if not width >= NARROWEST_PAGE:
        raise UsageError(
            f"a schematic needs a page at least {NARROWEST_PAGE:g} mm wide; got {width:g}", kind="out-of-range"
        )
    smallest = min(role.size for role in ROLES.values())
    return width / MILLIMETRES_PER_INCH * POINTS_PER_INCH * smallest / LEGIBLE - 2 * EDGE


def arranged_drawing(drivetrain: Drivetrain, page: float) -> Piece:
    """Drawing of all connected parts of a drivetrain for a page width in points, with the wires that close loops.

    It is kept for the next drivetrain of which all is drawn alike, as one with another stiffness.
    """
    with _ARRANGING:
        kept = _RECENT.once(
            Piece,
            (page, _drawn_things(drivetrain)),
            lambda: _arranged(drivetrain, page),
            lambda whole: BYTES_OF_STROKE * len(whole.strokes),
        )
    return kept.shifted(0.0, 0.0)  # titles and boxes of parts are added to a copy


def _drawn_things(drivetrain: Drivetrain) -> Hashable:
    """Everything of a drivetrain that its schematic is drawn from: names, symbols, sizes, and texts where shown."""
    values, named = drivetrain.exact_values, len(drivetrain.nodes) <= MOST_NAMED_NODES
    discs = disc_sizes(drivetrain, 1.0)
    elements: list[Hashable] = []
    is_plain = True
    for element in drivetrain.elements.values():
        drawn = discs[element.name] if element.name in discs else inline_glyph(element, values)
        texts = tuple(value_lines(element, values)) if named else ()
        what = (type(element), element.glyph, element.name, element.description)
        elements.append((*what, tuple(element.ports.items()), drawn, texts))
        is_plain &= element.kind in PLAIN
    # Wheels, sets of planets and words on states follow from any of the entries.
    rest = () if is_plain else (tuple(values.items()), tuple(map(_entries, drivetrain.elements.values())))
    channels = (tuple(drivetrain.inputs.items()), tuple(drivetrain.sensors.items()))
    return drivetrain.nodes, tuple(elements), repr(channels), rest


def _entries(element: Element) -> str:
    return repr([(entry.name, getattr(element, entry.name)) for entry in fields(element)])


def _arranged(drivetrain: Drivetrain, page: float) -> Piece:
    parts = []
    for bands in layout_bands(drivetrain, page):
        part = _packed(bands, page)
        draw_loops(part)
        parts.append(part)
    whole = _packed(parts, page)
    if len(drivetrain.nodes) > MOST_NAMED_NODES:
        note = f"{len(drivetrain.nodes)} nodes: elements are drawn without names and values"
        x0, _, y0, _ = whole.extent
        whole.labels.append(Label(x0, y0 - 14, note, "note", left=True))
        whole.boxes.append((x0, x0 + text_width(note, "note"), y0 - 18, y0 - 4))
    return whole


def _packed(given: Sequence[Piece], page: float) -> Piece:
    """Drawing of pieces placed from left to right and top to bottom, like words on a page ``page`` points wide."""
    whole = Piece()
    x = top = bottom = 0.0
    for block in given:
        x0, x1, y0, y1 = block.extent
        if x and x + x1 - x0 > page:
            x, top = 0.0, bottom - BETWEEN
        whole.add(block.shifted(x - x0, top - y1))
        bottom = min(bottom, top + y0 - y1)
        x += x1 - x0 + BESIDE
    return whole
