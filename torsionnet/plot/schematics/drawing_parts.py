"""Parts of a drawing that is too tall for a page, cut where no symbol and no text stands."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from torsionnet.plot.drawing.pieces import Box, Piece

LEAST_SHARE = 0.5
"""Least height of a part as a share of that of even parts: a lower one would be a strip without sense of its own."""
STEP = 2.0
"""Distance in points between the heights that are tried for a cut, less than the gap between two symbols."""
EDGE = 4.0
"""Room in points between a cut and what stands beside it."""
OVERSIZE = 1.5
"""Height of a part, as a multiple of the tallest one wanted, up to which fewer cut lines count more than the height."""
LINE_THICKNESS = 6.0
"""Height in points that a level line occupies among the wires of a drawing."""


def cut_heights(block: Piece, extent: Box, tallest: float) -> list[float]:
    """List of the y in points, from the top, at which a drawing is cut into parts of at most ``tallest`` points.

    A cut meets upright lines only, as few as can be; for that a part may be half as tall again, or more where there is
    no place for a cut.

    Parameters
    ----------
    block : Piece
    extent : tuple of float
        Edges x0, x1, y0, y1 of the drawing.
    tallest : float

    Examples
    --------
    >>> discs = Piece(boxes=[(0, 10, 0, 80), (0, 10, 120, 200)])
    >>> cut_heights(discs, (0, 10, 0, 200), 150)
    [100.0]
    """
    _, _, bottom, top = extent
    level = [one for one in block.wires if one[3] - one[2] <= LINE_THICKNESS + STEP]
    upright = [one for one in block.wires if one[3] - one[2] > LINE_THICKNESS + STEP]
    found: list[float] = []
    while top - bottom > tallest:
        even = (top - bottom) / math.ceil((top - bottom) / tallest)
        solid, least = [*block.boxes, *level], top - LEAST_SHARE * even
        cut = _best_cut(solid, upright, (top - OVERSIZE * tallest, least), top - even)
        if cut is None:
            cut = _best_cut(solid, [], (bottom + LEAST_SHARE * even, least), top - tallest)
        if cut is None:
            break
        found.append(cut)
        top = cut
    return found


def _best_cut(solid: Sequence[Box], upright: Sequence[Box], span: tuple[float, float], wanted: float) -> float | None:
    """Height in a span where nothing solid stands, with the fewest lines across and nearest to the one wanted."""
    low, high = span
    count = int((high - low) / STEP) + 1
    tried = sorted((low + number * STEP for number in range(count)), key=lambda y: abs(y - wanted))
    free = [y for y in [wanted, *tried] if not _crossed(solid, y, EDGE)]
    return min(free, key=lambda y: max(len(_crossed(upright, y, 0.0)), 1), default=None)  # one: the line goes on below


def _crossed(boxes: Iterable[Box], y: float, room: float) -> list[Box]:
    return [one for one in boxes if one[2] - room < y < one[3] + room]


def part_between(block: Piece, low: float, high: float) -> Piece:
    """Part of a drawing between two heights in points: the strokes that reach into it, and the labels inside of it."""
    strokes = [
        one for one in block.strokes if max(y for _, y in one.points) > low and min(y for _, y in one.points) < high
    ]
    return Piece(strokes, [one for one in block.labels if low <= one.y <= high])
