"""Arrangement of a schematic on a page, with the connected parts of a drivetrain beside each other and a title."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from torsionnet.base.errors import UsageError
from torsionnet.plot.drawing.pieces import LEADING, ROLES, Box, Label, Piece, text_width
from torsionnet.plot.schematics.drawing_plan import MOST_NAMED_NODES
from torsionnet.plot.schematics.layout import layout_bands
from torsionnet.plot.schematics.pens import POINTS_PER_INCH
from torsionnet.plot.schematics.texts import wrap_text
from torsionnet.plot.schematics.wiring import draw_loops

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain

EDGE, BETWEEN, BESIDE = 10.0, 26.0, 40.0  # points: margin, gap between rows of parts, gap between parts
MILLIMETRES_PER_INCH = 25.4
"""Millimetres in an inch."""
PAPER_WIDTH, LEGIBLE = 170.0, 6.0
"""Text width of an A4 page in mm, and size in points of the smallest text when printed at the page's width."""

NARROWEST_PAGE = 100.0
"""Least width of a page in mm; on a narrower one single symbols with their texts would not fit."""


def titled(whole: Piece, title: str, page: float) -> Box:
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
        raise UsageError(f"a schematic needs a page at least {NARROWEST_PAGE:g} mm wide; got {width:g}")
    smallest = min(role.size for role in ROLES.values())
    return width / MILLIMETRES_PER_INCH * POINTS_PER_INCH * smallest / LEGIBLE - 2 * EDGE


def arranged(drivetrain: Drivetrain, page: float) -> Piece:
    """Drawing of all connected parts of a drivetrain for a page width in points, with the wires that close loops."""
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
