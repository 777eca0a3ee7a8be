"""A row of symbols that knows the plan it is part of, and what leaves it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from torsionnet.plot.drawing.pieces import Box, LooseEnd, Piece, Stroke, Texts, moved, text_width, widest
from torsionnet.plot.schematic.branch_lines import Exit
from torsionnet.plot.schematic.marks import Mark
from torsionnet.plot.schematic.taps import marks_beside
from torsionnet.plot.schematic.topology import Link, Vertex

if TYPE_CHECKING:
    from torsionnet.plot.schematic.drawing_plan import DrawingPlan


MANY, HIGHER = 4, 22.0
"""Marks in a row of which every other one is lifted, by so many points."""


FAR = 1e5
APART, CLOSE = 7.0, 3.0
"""Points between neighbours, sideways and up or down."""

RECENT = 120
"""Boxes that can be in the way of the next piece."""


class Row:
    """Pieces along y = 0 from left to right; ``x`` is how far their symbols have come."""

    def __init__(self, wall: float = -FAR) -> None:
        self.block = Piece()
        self.x = 0.0
        self.columns: list[Box] = []
        """Room kept free for what comes later: wires, wheels."""
        self.wall = wall
        self.named_until = -FAR

    def put(self, piece: Piece, left: float, right: float, columns: Sequence[Box] = ()) -> float:
        """Place a piece drawn around x = 0 whose symbol reaches so far to both sides; gives where its middle is."""
        own = [*piece.boxes, *columns]
        x = max(self.x + left, *(self.wall - box[0] for box in own), -FAR)
        for there in [*self.block.boxes[-RECENT:], *self.columns[-RECENT:]]:
            for box in own:
                if box[2] < there[3] + CLOSE and there[2] < box[3] + CLOSE:
                    x = max(x, there[1] + APART - box[0])
        self.block.add(piece.shifted(x, 0))
        self.columns += [moved(box, x, 0) for box in columns]
        self.x = x + right
        return x

    def keep(self, width: float) -> float:
        """Room of this width that nothing else may use, above and below; gives its middle."""
        return self.put(Piece(), width / 2, width / 2, [(-width / 2, width / 2, -FAR, FAR)])

    def name(self, start: float, texts: Texts) -> float:
        """Keep room for the name of what stands since the start, above everything; gives where it ends."""
        half = widest(texts) / 2
        end = max(self.x, start + 14, 2 * (self.named_until + APART + half) - start, 2 * (self.wall + half) - start)
        middle = (start + end) / 2
        self.named_until = middle + half
        self.x = end
        return end

    def bracket(self, x0: float, x1: float, y: float) -> None:
        self.block.strokes.append(Stroke(((x0, y - 3), (x0, y), (x1, y), (x1, y - 3)), "faint"))
        self.block.boxes.append((x0, x1, y - 2, y + 1))


class PlannedRow(Row):
    """A row, the lines that leave it and the brackets of what is named below it."""

    def __init__(self, plan: DrawingPlan, wall: float = -FAR) -> None:
        super().__init__(wall)
        self.plan = plan
        self.exits: list[Exit] = []
        self.brackets: list[tuple[float, float, str]] = []

    @property
    def values(self) -> Any:
        return self.plan.drivetrain.exact_values

    def beside(self, node: str, link: Link | None, *, alone: bool = True) -> list[Mark]:
        """Marks of torques and twists that are taken from a link at a node."""
        return marks_beside(self.plan.taps.get(node, ()), link, alone=alone) if link is not None else []

    def marks_on_shaft(self, marks: Sequence[Mark]) -> None:
        """Marks with the piece of shaft they stand on."""
        start = self.x
        self.marks(marks)
        if marks:
            self.block.line((start, 0), (self.x, 0))

    def marks(self, marks: Iterable[Mark]) -> None:
        """Marks on the shaft with their names above it; of many, every other one stands higher."""
        ordered = list(marks)
        for place, mark in enumerate(ordered):
            lift = HIGHER if len(ordered) >= MANY and place % 2 else 0.0
            piece = mark.drawn(lift)
            self.put(piece, 9, 9)

    def loose(self, number: int, end: Vertex) -> None:
        """Lead to the node, or name it where no way is free: room for the name is kept either way."""
        width = text_width(end.name, "node") + 10
        tag = (self.x, self.x + width, -8.0, 8.0)
        self.block.ends.append(LooseEnd(number, end.name, self.x, 0, tag))
        self.block.boxes.append(tag)
        self.x += width
