"""Pens of a schematic with their colours and widths, and the strokes that lie behind all others."""

from __future__ import annotations

from torsionnet.plot.drawing.palette import INK, MUTED, PALETTE, PAPER
from torsionnet.plot.drawing.pieces import Stroke

PENS: dict[str, tuple[str, float]] = {
    "part": (INK, 1.2),
    "thin": (INK, 0.7),
    "shaft": (INK, 1.8),
    "wire": (MUTED, 1.2),
    "faint": ("#b5b5b5", 0.7),
    "carrier": (MUTED, 2.0),
    "housing": (MUTED, 0.9),
    "input": (PALETTE[1], 1.6),
    "leader": (PALETTE[1], 1.0),
    "blank": (PAPER, 1.2),
    "sensor": (PALETTE[2], 1.2),
}
DASHES = {"housing": (4.0, 2.5)}
"""Lengths of dashes and gaps of pens as multiples of the width of the line, by name of the pen."""
POINTS_PER_INCH = 72


def is_behind(stroke: Stroke) -> bool:
    """Whether a stroke lies behind the symbols: shafts run through discs; everything else lies as it was drawn."""
    return stroke.look in ("shaft", "wire", "faint") and not stroke.closed
