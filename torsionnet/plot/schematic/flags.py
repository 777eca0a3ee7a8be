"""Flags that say where a line goes on: where no way is free for a wire, and where the page ends."""

from __future__ import annotations

from torsionnet.plot.drawing.pieces import Piece, Stroke, text_width

TIP, HALF, PAD = 5.0, 7.0, 10.0
LONGEST = 24
"""Letters of a name on a flag."""


def flag(block: Piece, x: float, text: str) -> float:
    """A flag on the shaft at (x, 0), pointing to the right; gives where it ends."""
    shown = text if len(text) <= LONGEST else text[: LONGEST - 1] + "…"
    end = x + text_width(shown, "what") + 2 * TIP + PAD
    outline = ((x, -HALF), (end - TIP, -HALF), (end, 0.0), (end - TIP, HALF), (x, HALF))
    block.strokes.append(Stroke(outline, "thin", closed=True, fill="#ffffff"))
    block.boxes.append((x, end, -HALF, HALF))
    block.write((x + end - TIP) / 2, -4.4, [(shown, "what")])
    return end
