"""Row of symbols of a schematic from left to right, with the marks on it and the branches that leave it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from torsionnet.plot.drawing.pieces import Box, LooseEnd, Piece, Stroke, Texts, label_width, shifted_box, text_width
from torsionnet.plot.schematics.branch_lines import BranchStart
from torsionnet.plot.schematics.marks import Mark
from torsionnet.plot.schematics.taps import marks_beside
from torsionnet.plot.schematics.topology import Link, Vertex

if TYPE_CHECKING:
    from torsionnet.plot.schematics.drawing_plan import DrawingPlan


MANY_MARKS, MARK_LIFT = 4, 22.0
"""Number of marks in a row from which on every other one is raised, and the points by which it is raised."""


FAR_OUT = 1e5
"""Coordinate in points beyond any drawing."""
SIDE_GAP, VERTICAL_GAP = 7.0, 3.0
"""Least distances in points between neighbouring pieces of a schematic, sideways and up or down."""

NEGLIGIBLE = 1e-6
"""Distance in points far above rounding errors and far below a pixel."""
RECENT_BOXES = 120
"""Number of rectangles drawn last in a row against which a new piece of the schematic is checked for overlap: more take
time, fewer may let pieces overlap."""


class Row:
    """Row of pieces of a schematic, placed along y = 0 from left to right; ``x`` is where the last symbol ends."""

    def __init__(self, wall: float = -FAR_OUT, *, measures: bool = False) -> None:
        self.block = Piece()
        self.measures = measures
        """Whether only the room that the row takes is asked for, so that placed pieces need no strokes."""
        self.x = 0.0
        self.columns: list[Box] = []
        """Rectangles (x0, x1, y0, y1) in points above and below the row that are kept free for branches: wires and
        wheels."""
        self.wall = wall
        self.named_until = -FAR_OUT

    def put(self, piece: Piece, left: float, right: float, columns: Sequence[Box] = ()) -> float:
        """Place a piece drawn around x = 0 behind the others of the row, and return the x in points of its middle.

        ``left`` and ``right`` are the extents of its symbol, ``columns`` areas to be kept free around it.
        """
        own = [*piece.boxes, *columns]
        x = max(self.x + left, *(self.wall - box[0] for box in own), -FAR_OUT)
        near = min((box[0] for box in own), default=0.0) - SIDE_GAP - NEGLIGIBLE
        for there in [*self.block.boxes[-RECENT_BOXES:], *self.columns[-RECENT_BOXES:]]:
            for box in own if there[1] > x + near else ():
                if box[2] < there[3] + VERTICAL_GAP and there[2] < box[3] + VERTICAL_GAP:
                    x = max(x, there[1] + SIDE_GAP - box[0])
        self.block.add(piece.room_shifted(x, 0) if self.measures else piece.shifted(x, 0))
        self.columns += [shifted_box(box, x, 0) for box in columns]
        self.x = x + right
        return x

    def keep_free(self, width: float) -> float:
        """Keep a column of a width in points free above and below the row, and return the x in points of its middle."""
        return self.put(Piece(), width / 2, width / 2, [(-width / 2, width / 2, -FAR_OUT, FAR_OUT)])

    def name(self, start: float, texts: Texts) -> float:
        """Keep room above the row for a name over the symbols from ``start``, and return the x in points behind it."""
        half = label_width(texts) / 2
        end = max(self.x, start + 14, 2 * (self.named_until + SIDE_GAP + half) - start, 2 * (self.wall + half) - start)
        middle = (start + end) / 2
        self.named_until = middle + half
        self.x = end
        return end

    def draw_bracket(self, x0: float, x1: float, y: float) -> None:
        """Draw a bracket at height y over the symbols of the row from x0 to x1, in points."""
        self.block.strokes.append(Stroke(((x0, y - 3), (x0, y), (x1, y), (x1, y - 3)), "faint"))
        self.block.boxes.append((x0, x1, y - 2, y + 1))


class PlannedRow(Row):
    """Row of a schematic with its plan, the branches that leave the row, and brackets for the names of its nodes."""

    def __init__(self, plan: DrawingPlan, wall: float = -FAR_OUT, *, measures: bool = False) -> None:
        super().__init__(wall, measures=measures)
        self.plan = plan
        self.exits: list[BranchStart] = []
        self.brackets: list[tuple[float, float, str]] = []

    @property
    def values(self) -> Any:
        """Values of the drivetrain's parameters, by name of the parameter."""
        return self.plan.drivetrain.exact_values

    def link_marks(self, node: str, link: Link | None, *, alone: bool = True) -> list[Mark]:
        """List of the marks of the torque and twist sensors, at one node, on the elements of a schematic's link."""
        return marks_beside(self.plan.taps.get(node, ()), link, alone=alone) if link is not None else []

    def draw_marks_on_shaft(self, marks: Sequence[Mark]) -> None:
        """Draw marks of inputs and sensors on the row, with the piece of shaft on which they stand."""
        start = self.x
        self.draw_marks(marks)
        if marks:
            self.block.line((start, 0), (self.x, 0))

    def draw_marks(self, marks: Iterable[Mark]) -> None:
        """Draw marks of inputs and sensors on the shaft of the row, with their names above.

        Of many, every other name stands higher.
        """
        ordered = list(marks)
        for place, mark in enumerate(ordered):
            lift = MARK_LIFT if len(ordered) >= MANY_MARKS and place % 2 else 0.0
            piece = mark.piece(lift)
            self.put(piece, 9, 9)

    def add_loose_end(self, number: int, end: Vertex) -> None:
        """Add to the row a loose end that closes loop ``number`` at a node or box, with room for a tag with a name."""
        width = text_width(end.name, "node") + 10
        tag = (self.x, self.x + width, -8.0, 8.0)
        self.block.ends.append(LooseEnd(number, end.name, self.x, 0, tag))
        self.block.boxes.append(tag)
        self.x += width
