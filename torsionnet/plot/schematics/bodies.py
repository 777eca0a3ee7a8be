"""Symbols at a node of a schematic, as discs, elements to ground or a mass, and the element at a shaft line's end."""

from __future__ import annotations

from typing import TYPE_CHECKING

from torsionnet.model.elements import GROUND, Element
from torsionnet.plot.drawing.pieces import LEADING, ROLES, Piece, Stroke, Texts, label_width
from torsionnet.plot.schematics import outlines
from torsionnet.plot.schematics.spring_chains import far_end

if TYPE_CHECKING:
    from torsionnet.plot.schematics.planned_row import PlannedRow

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
