"""What stands between two nodes of a line: one element, or several in parallel between rails."""

from __future__ import annotations

from typing import TYPE_CHECKING

from torsionnet.plot.drawing.pieces import LEADING, ROLES, Box, Piece, Texts, widest
from torsionnet.plot.schematic.glyphs import inline_glyph
from torsionnet.plot.schematic.outlines import Glyph
from torsionnet.plot.schematic.topology import Link

if TYPE_CHECKING:
    from torsionnet.plot.schematic.drawing_plan import DrawingPlan


def between(plan: DrawingPlan, link: Link) -> tuple[Piece, float, list[Box]]:
    """The elements of a link around x = 0, how wide they are, and the room in which nothing else can stand."""
    drawn = [inline_glyph(element, plan.drivetrain.exact_values).scaled(plan.scale) for element in link.elements]
    texts = [plan.texts(element) for element in link.elements]
    rails = 12.0 if len(drawn) > 1 else 0.0
    # The texts of all but the first strand stand between the rails.
    span = max(*(glyph.length for glyph in drawn), *(widest(lines) for lines in texts[1:]), 0.0) + rails
    piece = Piece()
    left, right, y = -span / 2, span / 2, 0.0
    for place, (glyph, lines) in enumerate(zip(drawn, texts, strict=True)):
        if place:
            y -= drawn[place - 1].reach + 8 + sum(LEADING * ROLES[role].size for _, role in lines) + glyph.reach
        _strand(piece, glyph, lines, (left, right), y, below=not rails)
    for x in (left, right) if rails else ():
        piece.line((x, 0), (x, y))
    return piece, span, [(left, right, y, 0)] if rails else []


def _strand(block: Piece, glyph: Glyph, texts: Texts, ends: tuple[float, float], y: float, *, below: bool) -> None:
    """An element between two ends; alone on its shaft it has its texts below, out of the way of inputs and discs."""
    middle = (ends[0] + ends[1]) / 2
    begin = middle - glyph.length / 2
    block.strokes += glyph.along(begin, y)
    block.boxes.append((*ends, y - glyph.reach, y + glyph.reach))
    block.write(middle, y - glyph.reach - 2 if below else y + glyph.reach + 2, texts, upward=not below)
    if begin > ends[0]:
        block.line((ends[0], y), (begin, y))
        block.line((begin + glyph.length, y), (ends[1], y))
