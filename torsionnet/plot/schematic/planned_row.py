"""A row of symbols that knows the plan it is part of, and what leaves it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from torsionnet.plot.drawing.pieces import LooseEnd, text_width
from torsionnet.plot.schematic.branch_lines import Exit
from torsionnet.plot.schematic.marks import Mark
from torsionnet.plot.schematic.row import FAR, Row
from torsionnet.plot.schematic.taps import marks_beside
from torsionnet.plot.schematic.topology import Link, Vertex

if TYPE_CHECKING:
    from torsionnet.plot.schematic.drawing_plan import DrawingPlan


MANY, HIGHER = 4, 22.0
"""Marks in a row of which every other one is lifted, by so many points."""


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
