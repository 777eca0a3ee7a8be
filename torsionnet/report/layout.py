"""Where everything in a schematic goes: shaft lines from left to right, branches and gear stages on lines of their own.

A line is built from its head onwards, every piece in a stretch of its own that is as wide as its symbol and texts; the
lines that leave it are then moved down (or up) to the nearest free place. A line that would leave the page is cut, and
goes on below; a branch for which no room is left begins a band of its own, with flags at both ends. All in points.
"""

from __future__ import annotations

from collections import deque
from itertools import zip_longest
from typing import TYPE_CHECKING

from torsionnet.report.blocks import Block
from torsionnet.report.courses import Course, Leaving, Step, courses, cuts, needed
from torsionnet.report.drops import Drop, Exit
from torsionnet.report.flags import flag
from torsionnet.report.lines import Line
from torsionnet.report.plan import Plan, make_plan
from torsionnet.report.topology import Link, Tree, Vertex

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain

PAGE = 545.0
"""Width of a drawing unless another is asked for."""

MARGIN = 24.0
"""Room for the lines that lead from one piece of a cut line to the next."""

WIRES = 30.0
"""Room at the sides for wires that close loops."""

NARROWEST = 0.45
"""Part of the page that a branch gets before it begins a band of its own."""

INDENT = 26.0
"""Pieces of a line that comes from gears stay clear of the wheels."""


def blocks(drivetrain: Drivetrain, page: float = PAGE) -> list[list[Block]]:
    """For each connected part its bands, from top to bottom."""
    plan, grown = make_plan(drivetrain, page)
    if plan.loops:
        plan.page -= WIRES
    return [Sheet(tree, plan).bands() for tree in grown]


class Sheet:
    """One connected part: its lines, how wide they are, and those that wait for a band of their own."""

    def __init__(self, tree: Tree, plan: Plan) -> None:
        self.tree, self.plan = tree, plan
        self.courses = courses(tree)
        self.starts: dict[Vertex, float] = {}
        self.steps: dict[Vertex, list[Step]] = {}
        self.needs: dict[Vertex, float] = {}
        self.waiting: deque[Vertex] = deque([tree.root])
        for head in reversed(self.courses):
            self._measure(head)

    def _measure(self, head: Vertex) -> None:
        """Widths of a line whose branches have been measured before."""
        course = self.courses[head]
        line = Line(self.plan)
        if course.incoming is not None:
            line.begin(course.incoming)
        self.starts[head] = line.x
        self.steps[head] = [self._step(course, place) for place in range(len(course.vertices))]
        self.needs[head] = needed(self.starts[head], self.steps[head])

    def _step(self, course: Course, place: int) -> Step:
        line = Line(self.plan)
        self._fill(line, course.cut(place, place + 1))
        heads = ((each, each.what) for each in line.exits)
        leaving = [Leaving(each.x, self.needs[what]) for each, what in heads if isinstance(what, Vertex)]
        return Step(line.x, tuple(leaving))

    def bands(self) -> list[Block]:
        """The main line first, then those for which it had no room."""
        found = []
        while self.waiting:
            head = self.waiting.popleft()
            found.append(self._band(head))
        return found

    def _band(self, head: Vertex) -> Block:
        course = self.courses[head]
        if course.incoming is None:
            return self._course(head, self.plan.page, top=True)
        came = course.incoming
        # Gears are drawn where the line leaves; a shaft belongs to the band itself.
        source = came.elements[0].name if came.is_gear else course.parent.name if course.parent else ""
        line = Line(self.plan)
        line.x = flag(line.block, 0.0, f"from {source}") + 6
        line.block.line((line.x - 6, 0), (line.x, 0))
        if came.elements and not came.is_gear:
            line.gap(came)
        return self._course(head, self.plan.page, top=True, begun=line)

    def _course(self, head: Vertex, room: float, *, top: bool = False, begun: Line | None = None) -> Block:
        """A line with everything that leaves it, cut into pieces if it is wider than the room."""
        course = self.courses[head]
        start = begun.x if begun is not None else self.starts[head]
        indent = INDENT if begun is None and course.incoming is not None and course.incoming.is_gear else 0.0
        begins = cuts(start, self.steps[head], room, MARGIN + indent)
        narrow = room if len(begins) == 1 else room - MARGIN - indent
        built = []
        for first, last in zip_longest(begins, begins[1:], fillvalue=len(course.vertices)):
            piece = course.cut(first, last)
            line = Line(self.plan)
            if first == 0 and begun is not None:
                line = begun
            elif piece.incoming is not None:
                line.begin(piece.incoming)
            self._fill(line, piece)
            built.append(self._finished(line, narrow, may_rise=top and first == 0))
        return _stacked(built, indent)

    def _fill(self, line: Line, course: Course) -> None:
        before = course.incoming or course.before
        for vertex, onward in zip_longest(course.vertices, course.links):
            leaving = [pair for pair in self.tree.children[vertex] if self._leaves(pair)]
            line.vertex(vertex, before, onward, leaving)
            if onward is not None:
                line.gap(onward)
            before = onward

    def _leaves(self, pair: tuple[Link, Vertex]) -> bool:
        return pair[1] in self.courses and self.courses[pair[1]].incoming is pair[0]

    def _finished(self, line: Line, room: float, *, may_rise: bool) -> Block:
        return line.finish(lambda each: self._settled(each, room - each.x), may_rise=may_rise)

    def _settled(self, leaving: Exit, room: float) -> Drop:
        """What leaves with its block: the line itself, or a flag where there is no room for it."""
        x, y, what, stages = leaving.x, leaving.y, leaving.what, leaving.stages
        if isinstance(what, Block):
            return Drop(x, y, what, stages)
        if self.needs[what] <= room or self._may_be_cut(what, room):
            return Drop(x, y, self._course(what, room), stages, may_rise=self.needs[what] <= room)
        self.waiting.append(what)
        block = Block()
        begin = stages[-1].offset + 18 if stages else 12.0
        block.line((0, 0), (begin, 0))
        flag(block, begin, f"to {what.name}")
        return Drop(x, y, block, stages)

    def _may_be_cut(self, head: Vertex, room: float) -> bool:
        widest = max(step.width for step in self.steps[head])
        return room >= max(NARROWEST * self.plan.page, widest + MARGIN + INDENT, self.starts[head])


def _stacked(built: list[Block], indent: float) -> Block:
    """Pieces of a line below each other, each led on to the next."""
    whole = built[0]
    far = max(piece.extent[1] for piece in built) + 8
    for piece in built[1:]:
        bottom = whole.extent[2]
        left, _, _, top = piece.extent
        drop, lane, edge = bottom - 30 - top, bottom - 14, indent + left - 14
        x, y = whole.anchors.pop(-1)
        whole.line((x, y), (far, y), (far, lane), (edge, lane), (edge, drop), (indent, drop))
        whole.add(piece.shifted(indent, drop))
    whole.anchors.pop(-1, None)
    return whole
