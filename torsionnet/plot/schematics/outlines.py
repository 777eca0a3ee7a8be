"""Basic shapes of a schematic's symbols as strokes, from rectangles, wheels and springs to ground and marks."""

from __future__ import annotations

from dataclasses import dataclass

from torsionnet.plot.drawing.pieces import INK, MUTED, PALETTE, PAPER, Stroke, arc

DISC_WIDTH, WHEEL_WIDTH = 13.0, 12.0  # points
GROUND_WIDTH = 26.0  # points
DRAGS = ("damper", "friction")
"""Symbols of elements that resist a rotation and hold no shaft: those to ground hang below it."""
BODY, WHEEL, BOX = "#dbe5ee", "#efe6d8", "#fbf9f5"


@dataclass(frozen=True)
class Glyph:
    """Symbol of a schematic as strokes from (0, 0) to (length, 0), within ``half_width`` points above and below."""

    strokes: tuple[Stroke, ...]
    length: float
    half_width: float

    def along(self, x: float, y: float) -> list[Stroke]:
        """Strokes of the symbol, moved to begin at (x, y) in points and lead to the right."""
        return [stroke.shifted(x, y) for stroke in self.strokes]

    def scaled(self, factor: float) -> Glyph:
        """Copy of the symbol with all its coordinates multiplied by a factor."""
        if factor == 1:
            return self
        strokes = (
            Stroke(tuple((factor * u, factor * v) for u, v in stroke.points), stroke.look, stroke.closed, stroke.fill)
            for stroke in self.strokes
        )
        return Glyph(tuple(strokes), factor * self.length, factor * self.half_width)

    def hanging(self, x: float, y: float) -> list[Stroke]:
        """Strokes of the symbol, turned to begin at (x, y) in points and lead downwards."""
        return [
            Stroke(tuple((x + v, y - u) for u, v in stroke.points), stroke.look, stroke.closed, stroke.fill)
            for stroke in self.strokes
        ]


def rectangle(x0: float, x1: float, y0: float, y1: float, fill: str = "", look: str = "part") -> Stroke:
    """Stroke of a rectangle between x0 and x1, y0 and y1, in points of 1/72 inch."""
    return Stroke(((x0, y0), (x1, y0), (x1, y1), (x0, y1)), look, closed=True, fill=fill)


def disc(x: float, half: float, width: float = DISC_WIDTH) -> list[Stroke]:
    """Strokes of a disc (an inertia seen from the side) with its centre at (x, 0) in points."""
    return [rectangle(x - width / 2, x + width / 2, -half, half, BODY)]


def wheel(x: float, y: float, radius: float) -> list[Stroke]:
    """Strokes of a gear wheel seen from the side about (x, y) in points, with short lines at the rims as teeth."""
    half = WHEEL_WIDTH / 2
    teeth = [
        Stroke(((x - half, y + side * (radius - 3.5)), (x + half, y + side * (radius - 3.5))), "thin")
        for side in (-1, 1)
    ]
    return [rectangle(x - half, x + half, y - radius, y + radius, WHEEL), *teeth]


def ground(x: float, y: float) -> list[Stroke]:
    """Strokes of the symbol of ground at (x, y) in points, a level line with hatching below."""
    half = GROUND_WIDTH / 2
    hatches = [Stroke(((x + u + 4, y), (x + u - 1, y - 6)), "thin") for u in (-10.0, -4.0, 2.0, 8.0)]
    return [Stroke(((x - half, y), (x + half, y))), *hatches]


def mass(x: float, y: float) -> list[Stroke]:
    """Strokes of an inertia that hangs below (x, y) in points, a flat rectangle."""
    return [rectangle(x - GROUND_WIDTH / 2, x + GROUND_WIDTH / 2, y - DISC_WIDTH, y, BODY)]


def wall(x: float, half: float = 18.0) -> list[Stroke]:
    """Strokes of a wall at the end of a shaft, a vertical line at x in points with hatching to the right."""
    count = int(2 * half / 6)
    hatches = [Stroke(((x, -half + 6 * i + 6), (x + 6, -half + 6 * i + 1)), "thin") for i in range(count)]
    return [Stroke(((x, -half), (x, half))), *hatches]


def torque_arrow(x: float, *, opposite: bool = False) -> list[Stroke]:
    """Strokes of an arrow around the shaft at x in points, the sign of a torque, or of the opposite arrow."""
    way = -1 if opposite else 1
    path = arc(x, 0, 6.5, 17, way * 150, way * -150)
    x1, y1 = path[-1]
    head = ((x1 - 1.6, y1 + way * 6.5), (x1 - 3.2, y1 - way * 2.5), (x1 + 4.8, y1 - way * 0.5))
    return [Stroke(path, "input"), Stroke(head, "input", closed=True, fill="input")]


def sensor_mark(x: float, *, torque: bool, leader: float = 20.0) -> list[Stroke]:
    """Strokes of a sensor's mark on the shaft, a dot for motion, a diamond for torque, with a leader to its name."""
    dot = ((x - 4.5, 0.0), (x, 4.5), (x + 4.5, 0.0), (x, -4.5)) if torque else arc(x, 0, 3.8, 3.8, 0, 360)
    return [Stroke(((x, 4), (x, leader)), "sensor"), Stroke(dot, "sensor", closed=True, fill="#ffffff")]


def side_mark(x: float, y: float, leader: float) -> list[Stroke]:
    """Strokes of a torque sensor's mark on an element below a shaft, a diamond with a leader to the name beside it."""
    diamond = ((x - 4.5, y), (x, y + 4.5), (x + 4.5, y), (x, y - 4.5))
    return [Stroke(((x + 4, y), (x + leader, y)), "sensor"), Stroke(diamond, "sensor", closed=True, fill="#ffffff")]


def zigzag(start: float, end: float, y: float, amplitude: float = 6.0, teeth: int = 4) -> Stroke:
    """Stroke of the zigzag of a spring from (start, y) to (end, y) in points."""
    lead = 0.12 * (end - start)
    step = (end - start - 2 * lead) / (2 * teeth)
    middle = [(start + lead + (i + 0.5) * step, y + amplitude * (-1) ** i) for i in range(2 * teeth)]
    return Stroke(((start, y), (start + lead, y), *middle, (end - lead, y), (end, y)))


def dashpot(start: float, end: float, y: float, half: float = 6.0) -> list[Stroke]:
    """Strokes of a dashpot from (start, y) to (end, y) in points, ``half`` its half height."""
    a, b = start + 0.36 * (end - start), start + 0.66 * (end - start)
    piston = start + 0.5 * (end - start)
    return [
        Stroke(((start, y), (piston, y))),
        Stroke(((piston, y - half + 1.5), (piston, y + half - 1.5))),
        Stroke(((a, y + half), (b, y + half), (b, y - half), (a, y - half))),
        Stroke(((b, y), (end, y))),
    ]


# Pens of a schematic with their colours and widths, and the strokes that lie behind all others.

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
