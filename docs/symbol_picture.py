"""Pictures of the element reference: the symbol of each element as a schematic draws it, with its ports named."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from sign_picture import EDGE, save

from torsionnet.model.elements import GROUND, Element
from torsionnet.plot.drawing.pieces import Piece, Stroke
from torsionnet.plot.schematics import outlines
from torsionnet.plot.schematics import symbols as box_symbols
from torsionnet.plot.schematics import symbols as glyphs
from torsionnet.plot.schematics import symbols as spring_chains
from torsionnet.plot.schematics.schematic import figure_of_drawing
from torsionnet.plot.schematics.wires import Branch, GearPair

BETWEEN = 60.0


def write(folder: Path, kind: str, samples: Sequence[Element]) -> None:
    """Write the pictures of an element type: its plainest element, and one with everything given if that differs."""
    whole = Piece()
    drawn: list[tuple[Stroke, ...]] = []
    for element in samples:
        block = picture(element)
        if tuple(block.strokes) in drawn:
            continue
        drawn.append(tuple(block.strokes))
        whole.add(block.shifted(whole.extent[1] + BETWEEN - block.extent[0] if whole.strokes else 0.0, 0.0))
    x0, x1, y0, y1 = whole.extent
    save(figure_of_drawing(whole, (x0 - EDGE, x1 + EDGE, y0 - EDGE, y1 + EDGE)), folder / f"symbol_{kind}.svg")


def picture(element: Element) -> Piece:
    """Drawing of an element by the kind of its symbol."""
    if element.glyph == "disc":
        return _disc(element)
    if element.glyph == "clamp":
        return _clamp(element)
    if element.glyph == "gear":
        return _gear(element)
    return {1: _hanging, 2: _inline}.get(len(element.ports), _box)(element)


def _disc(element: Element) -> Piece:
    block = Piece()
    block.line((0, 0), (60, 0))
    block.strokes += outlines.disc(30, 26)
    block.boxes.append((23, 37, -26, 26))
    _port(block, 8, element, 0)
    return block


def _clamp(element: Element) -> Piece:
    block = Piece()
    block.line((0, 0), (50, 0))
    block.strokes += [stroke.shifted(50, 0) for stroke in outlines.wall(0)]
    block.boxes.append((50, 58, -18, 18))
    _port(block, 14, element, 0)
    return block


def _hanging(element: Element) -> Piece:
    """Drawing of an element below a shaft, with the ground or the mass at its far end."""
    glyph, end, top = glyphs.inline_glyph(element, {}), spring_chains.far_end(element, {}), -14.0
    block = Piece(glyph.hanging(44, top))
    block.line((0, 0), (88, 0))
    block.strokes.append(Stroke(((44, 0), (44, top))))
    foot = top - glyph.length
    block.strokes += outlines.ground(44, foot) if end == GROUND else outlines.mass(44, foot) if end else []
    below = outlines.DISC_WIDTH if end else 0.0
    block.boxes.append((44 - glyph.half_width, 44 + glyph.half_width, foot - below, 0))
    _port(block, 16, element, 0)
    return block


def _inline(element: Element) -> Piece:
    """Drawing of an element between two ends."""
    glyph = glyphs.inline_glyph(element, {})
    block = Piece(glyph.along(44, 0))
    block.boxes.append((44, 44 + glyph.length, -glyph.half_width, glyph.half_width))
    block.line((0, 0), (44, 0))
    block.line((44 + glyph.length, 0), (88 + glyph.length, 0))
    _port(block, 16, element, 0)
    _port(block, 72 + glyph.length, element, 1)
    return block


def _gear(element: Element) -> Piece:
    """Drawing of two gear wheels, with a moving housing as a dashed frame."""
    block, distance = Piece(), 70.0
    block.line((0, 0), (70, 0))
    block.line((70, -distance), (150, -distance))
    block.add(Branch(70, 0, Piece(), (GearPair(element, 0.0, (), 1.6),)).connector(distance))
    _port(block, 20, element, 0)
    _port(block, 126, element, 1, y=-distance)
    if "housing" in element.ports:
        block.write(112, 6, [("housing", "port")])
    return block


def _box(element: Element) -> Piece:
    """Drawing of a box with three ports at its edges, and further ports beside the third."""
    block, half = Piece(), 35.0
    block.line((-110, 0), (-60, 0))
    block.line((60, 0), (110, 0))
    block.line((0, -half), (0, -half - 22))
    block.strokes += [outlines.rectangle(-60, 60, -half, half, outlines.BOX), *box_symbols.box_symbol(element, 0, 6)]
    block.boxes.append((-60, 60, -half, half))
    first, second, *others = element.ports
    left, right = (min(44.0, 57 - 2.2 * len(name)) for name in (first, second))
    for x, y, name in ((-left, -10, first), (right, -10, second), (0, -half + 2, ", ".join(others))):
        block.write(x, y, [(name, "port")])
    return block


def _port(block: Piece, x: float, element: Element, place: int, *, y: float = 0.0) -> None:
    block.write(x, y + 4, [(list(element.ports)[place], "port")])
