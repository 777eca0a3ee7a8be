"""Boxes of a schematic for elements with three and more ports, as planetary sets, with the ports at their edges."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from torsionnet.plot.drawing.pieces import Owner, Piece, Stroke, label_width, text_width
from torsionnet.plot.schematics import box_symbols, outlines
from torsionnet.plot.schematics.branch_lines import BranchStart
from torsionnet.plot.schematics.topology import Link, Vertex

if TYPE_CHECKING:
    from collections.abc import Sequence

    from torsionnet.plot.schematics.epicyclic import BoxElement
    from torsionnet.plot.schematics.planned_row import PlannedRow

HALF_HEIGHT = 35.0
"""Half the height in points of a box of the schematic: room for a symbol and the names of the ports below it."""
BOX_GAP, STUB = 10.0, 12.0  # points: more than the texts in width, piece of shaft below a port


def draw_box(
    line: PlannedRow, vertex: Vertex, before: Link | None, after: Link | None, leaving: Sequence[tuple[Link, Vertex]]
) -> None:
    """Draw an element with three and more ports as a box on a shaft line of the schematic.

    The line enters left and goes on right, other ports below.
    """
    with line.block.owned(*vertex.owner):
        _draw(line, vertex, before, after, leaving)


def _draw(
    line: PlannedRow, vertex: Vertex, before: Link | None, after: Link | None, leaving: Sequence[tuple[Link, Vertex]]
) -> None:
    element = line.plan.found.boxes[vertex.name]
    texts = line.plan.texts(element)
    below = _ports_below(line, vertex, element, leaving)
    side = max((text_width(link.port, "port") + 8 for link in (before, after) if link is not None), default=8.0)
    slots = [max(30.0, text_width(port, "port") + 8) for port in below]
    width = max(2 * (box_symbols.HALF_SIZE + side), label_width(texts) + BOX_GAP, sum(slots) + 8)
    before_x, middle = line.x, line.keep_free(width)
    start, end = middle - width / 2, middle + width / 2
    line.block.line((before_x, 0), (start, 0))
    line.block.strokes.append(outlines.rectangle(start, end, -HALF_HEIGHT, HALF_HEIGHT, outlines.BOX))
    line.block.strokes += box_symbols.box_symbol(element, middle, HALF_HEIGHT - box_symbols.HALF_SIZE - 5)
    line.block.boxes.append((start, end, -HALF_HEIGHT, HALF_HEIGHT))
    line.block.write(middle, HALF_HEIGHT + 3, texts)
    for link, left in ((before, True), (after, False)):
        if link is not None:
            half = text_width(link.port, "port") / 2 + 4
            line.block.write(start + half if left else end - half, -10, [(link.port, "port")])
    x = middle - sum(slots) / 2
    for (port, use), slot in zip(below.items(), slots, strict=True):
        line.block.write(x + slot / 2, -HALF_HEIGHT + 2, [(port, "port")])
        _port(line, x + slot / 2, use, vertex.owner)
        x += slot


def _ports_below(
    line: PlannedRow, vertex: Vertex, element: BoxElement, leaving: Sequence[tuple[Link, Vertex]]
) -> dict[str, Any]:
    """Targets of the ports at the lower edge of a schematic's box by port, a node, box or loop, None for ground."""
    below: dict[str, Any] = {link.port: child for link, child in leaving}
    below |= {link.port: (number, link, end) for number, link, end in line.plan.loops.get(vertex, ())}
    return below | {port: None for port, node in element.ports.items() if node == "ground"}


def _port(line: PlannedRow, x: float, use: Any, owner: Owner) -> None:
    if isinstance(use, Vertex):
        line.exits.append(BranchStart(x, -HALF_HEIGHT, use, owner=owner))
    elif use is None:
        line.block.strokes += [
            Stroke(((x, -HALF_HEIGHT), (x, -HALF_HEIGHT - 10))),
            *outlines.ground(x, -HALF_HEIGHT - 10),
        ]
        line.block.boxes.append((x - 14, x + 14, -HALF_HEIGHT - 17, -HALF_HEIGHT))
    else:
        line.exits.append(BranchStart(x, -HALF_HEIGHT, _loop(line, owner, *use), owner=owner))


def _loop(line: PlannedRow, owner: Owner, number: int, link: Link, end: Vertex) -> Piece:
    """Drawing of a short shaft with a loose end, at a port of a schematic's box whose link closes a loop."""
    piece = type(line)(line.plan, wall=6.0)
    with piece.block.owned(*owner):
        piece.block.line((0, 0), (STUB, 0))
        piece.x = STUB
        piece.draw_marks_on_shaft(piece.link_marks(end.name, link))
    piece.add_loose_end(number, end)
    return piece.block
