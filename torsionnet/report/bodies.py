"""What sits on a shaft: discs, what hangs below them down to ground, and what the line ends in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from torsionnet.elements import Element
from torsionnet.report import glyphs
from torsionnet.report.blocks import Stroke, widest

if TYPE_CHECKING:
    from torsionnet.report.lines import Line

GAP, WALL = 10.0, 18.0


def body(line: Line, disc: Element | None, hanging: Element | None) -> None:
    """A disc, an element to ground, or the one below the other."""
    above = line.plan.texts(disc) if disc else []
    below = line.plan.texts(hanging) if hanging else []
    scale = line.plan.scale
    symbols = glyphs.GROUND_WIDTH if hanging else 18.0 * scale
    middle = line.stretch(max(symbols, widest(above), widest(below)) + GAP * scale)
    half = line.plan.discs.get(disc.name, 0.0) if disc else 0.0
    if disc:
        line.block.strokes += glyphs.disc(middle, half, scale * glyphs.DISC_WIDTH)
        line.block.boxes.append((middle - 8 * scale, middle + 8 * scale, -half, half))
        line.block.write(middle, half + 3, above)
    if hanging:
        _hang(line, hanging, middle, -half, below)


def _hang(line: Line, element: Element, x: float, y: float, texts: Sequence[tuple[str, str]]) -> None:
    """An element down to ground, its texts below the hatching."""
    length, reach = 14.0, 8.0
    if element.glyph == "clamp":
        line.block.strokes.append(Stroke(((x, y), (x, y - length))))
    else:
        glyph = glyphs.inline_glyph(element, line.values).scaled(line.plan.scale)
        length, reach = glyph.length, glyph.reach
        line.block.strokes += glyph.hanging(x, y)
    line.block.strokes += glyphs.ground(x, y - length)
    wide = max(reach, glyphs.GROUND_WIDTH / 2 + 1)
    line.block.boxes.append((x - wide, x + wide, y - length - 7, y))
    line.block.write(x, y - length - 9, texts, upward=False)


def ending(line: Line, element: Element) -> float:
    """A wall the shaft ends in, after the element unless that is a clamp; gives where the shaft stops."""
    texts = line.plan.texts(element)
    glyph = None if element.glyph == "clamp" else glyphs.inline_glyph(element, line.values).scaled(line.plan.scale)
    length, reach = (glyph.length, glyph.reach) if glyph else (0.0, 0.0)
    middle = line.stretch(max(length + 24, widest(texts) + GAP))
    start, end = middle - length / 2, middle + length / 2
    line.block.strokes += [*(glyph.along(start, 0) if glyph else []), *glyphs.wall(end, WALL)]
    line.block.boxes.append((start, end + 8, -max(WALL, reach), max(WALL, reach)))
    line.block.write(middle, max(WALL, reach) + 4, texts)
    return start
