"""What stands along a shaft, packed as closely as the texts above and below it allow."""

from __future__ import annotations

from collections.abc import Sequence

from torsionnet.plot.drawing.pieces import Box, Piece, Stroke, Texts, moved, widest

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
