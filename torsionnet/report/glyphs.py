"""The symbols of a schematic, each drawn along a line from (0, 0); the drawing's place turns and moves them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from torsionnet.elements import Element
from torsionnet.report.blocks import Point, Stroke, arc
from torsionnet.report.labels import is_zero

DISC_WIDTH, WHEEL_WIDTH = 13.0, 12.0
GROUND_WIDTH = 26.0
BODY, WHEEL, BOX = "#dbe5ee", "#efe6d8", "#fbf9f5"


@dataclass(frozen=True)
class Glyph:
    """Strokes from (0, 0) to (length, 0), staying within ``reach`` of that line."""

    strokes: tuple[Stroke, ...]
    length: float
    reach: float

    def along(self, x: float, y: float) -> list[Stroke]:
        """To the right from a point."""
        return [stroke.shifted(x, y) for stroke in self.strokes]

    def scaled(self, factor: float) -> Glyph:
        strokes = (
            Stroke(tuple((factor * u, factor * v) for u, v in stroke.points), stroke.look, stroke.closed, stroke.fill)
            for stroke in self.strokes
        )
        return Glyph(tuple(strokes), factor * self.length, factor * self.reach)

    def hanging(self, x: float, y: float) -> list[Stroke]:
        """Down from a point."""
        return [
            Stroke(tuple((x + v, y - u) for u, v in stroke.points), stroke.look, stroke.closed, stroke.fill)
            for stroke in self.strokes
        ]


def rectangle(x0: float, x1: float, y0: float, y1: float, fill: str = "", look: str = "part") -> Stroke:
    return Stroke(((x0, y0), (x1, y0), (x1, y1), (x0, y1)), look, closed=True, fill=fill)


def disc(x: float, half: float, width: float = DISC_WIDTH) -> list[Stroke]:
    """An inertia seen from the side."""
    return [rectangle(x - width / 2, x + width / 2, -half, half, BODY)]


def wheel(x: float, y: float, radius: float) -> list[Stroke]:
    """A gear wheel seen from the side: its teeth are the short lines at the rims."""
    half = WHEEL_WIDTH / 2
    teeth = [
        Stroke(((x - half, y + side * (radius - 3.5)), (x + half, y + side * (radius - 3.5))), "thin")
        for side in (-1, 1)
    ]
    return [rectangle(x - half, x + half, y - radius, y + radius, WHEEL), *teeth]


def ground(x: float, y: float) -> list[Stroke]:
    """A line with hatching below."""
    half = GROUND_WIDTH / 2
    hatches = [Stroke(((x + u + 4, y), (x + u - 1, y - 6)), "thin") for u in (-10.0, -4.0, 2.0, 8.0)]
    return [Stroke(((x - half, y), (x + half, y))), *hatches]


def wall(x: float, half: float = 18.0) -> list[Stroke]:
    """A line with hatching to the right."""
    count = int(2 * half / 6)
    hatches = [Stroke(((x, -half + 6 * i + 6), (x + 6, -half + 6 * i + 1)), "thin") for i in range(count)]
    return [Stroke(((x, -half), (x, half))), *hatches]


def torque_arrow(x: float) -> list[Stroke]:
    """An arrow around the shaft."""
    path = arc(x, 0, 6.5, 17, 150, -150)
    x1, y1 = path[-1]
    head = ((x1 - 1.6, y1 + 6.5), (x1 - 3.2, y1 - 2.5), (x1 + 4.8, y1 - 0.5))
    return [Stroke(path, "input"), Stroke(head, "input", closed=True, fill="input")]


def sensor_mark(x: float, *, torque: bool, leader: float = 20.0) -> list[Stroke]:
    """A dot for motion, a diamond for torque, with a leader to the name above."""
    dot = ((x - 4.5, 0.0), (x, 4.5), (x + 4.5, 0.0), (x, -4.5)) if torque else arc(x, 0, 3.8, 3.8, 0, 360)
    return [Stroke(((x, 4), (x, leader)), "sensor"), Stroke(dot, "sensor", closed=True, fill="#ffffff")]


def zigzag(start: float, end: float, y: float, amplitude: float = 6.0, teeth: int = 4) -> Stroke:
    lead = 0.12 * (end - start)
    step = (end - start - 2 * lead) / (2 * teeth)
    middle = [(start + lead + (i + 0.5) * step, y + amplitude * (-1) ** i) for i in range(2 * teeth)]
    return Stroke(((start, y), (start + lead, y), *middle, (end - lead, y), (end, y)))


def dashpot(start: float, end: float, y: float, half: float = 6.0) -> list[Stroke]:
    a, b = start + 0.36 * (end - start), start + 0.66 * (end - start)
    piston = start + 0.5 * (end - start)
    return [
        Stroke(((start, y), (piston, y))),
        Stroke(((piston, y - half + 1.5), (piston, y + half - 1.5))),
        Stroke(((a, y + half), (b, y + half), (b, y - half), (a, y - half))),
        Stroke(((b, y), (end, y))),
    ]


def _spring(element: Element, values: Mapping[str, Any]) -> Glyph:
    length = 48.0
    if element.kind == "hysteretic_spring":
        pad = rectangle(8, length - 8, -9, 9, "#d9d9d9", "thin")
        core = [pad, zigzag(0, length, 0)]
    elif element.kind == "tabulated_spring":
        arrow = [Stroke(((9, -12), (38, 12)), "thin"), Stroke(((32.5, 11), (39, 12.8), (36.6, 6.6)), "thin")]
        core = [zigzag(0, length, 0), *arrow]
    else:
        core = [zigzag(0, length, 0)]
    if is_zero(element, "damping", values):
        return Glyph(tuple(core), length, 13)
    return _beside(core, length)


def _beside(core: list[Stroke], length: float) -> Glyph:
    """The spring above the line and a dashpot below it, joined at both ends."""
    up, down = 10.0, -10.0
    rails = [Stroke(((x, down), (x, up))) for x in (6.0, length - 6)]
    leads = [Stroke(((0, 0), (6, 0))), Stroke(((length - 6, 0), (length, 0)))]
    squeezed = [
        Stroke(tuple((6 + u * (length - 12) / length, up + v) for u, v in s.points), s.look, s.closed, s.fill)
        for s in core
    ]
    return Glyph((*leads, *rails, *squeezed, *dashpot(6, length - 6, down)), length, 22)


def _damper(element: Element, values: Mapping[str, Any]) -> Glyph:
    del element, values
    return Glyph(tuple(dashpot(0, 40, 0, 8)), 40, 9)


def _coupling(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Two flanges face to face."""
    del element, values
    flanges = (rectangle(10, 15, -13, 13, BODY), rectangle(15, 20, -13, 13, BODY))
    return Glyph((Stroke(((0, 0), (10, 0)), "shaft"), *flanges, Stroke(((20, 0), (30, 0)), "shaft")), 30, 14)


def _shaft(element: Element, values: Mapping[str, Any]) -> Glyph:
    """A thin cylinder, with a line between its segments."""
    del values
    start, end, half = 5.0, 55.0, 6.0
    outline = (*arc(start, 0, 2.5, half, 90, 270, 8), *arc(end, 0, 2.5, half, -90, 90, 8))
    count = min(int(getattr(element, "segments", 1)), 6)
    cuts = [start + (end - start) * i / count for i in range(1, count)]
    body = Stroke(outline, "part", closed=True, fill=BODY)
    rings = [Stroke(arc(x, 0, 2.5, half, -90, 90, 8), "thin") for x in (*cuts, end - 0.01)]
    leads = [Stroke(((0, 0), (start - 2.5, 0)), "shaft"), Stroke(((end + 2.5, 0), (60, 0)), "shaft")]
    return Glyph((*leads, body, *rings[:-1]), 60, 8)


def _gear(element: Element, values: Mapping[str, Any]) -> Glyph:
    """A stage in line, where there is no room for two shafts."""
    del element, values
    out: tuple[Point, ...] = ((15, -16), (30, -16), (30, 0), (42, 0))
    return Glyph(
        (Stroke(((0, 0), (15, 0)), "shaft"), Stroke(out, "shaft"), *wheel(15, 0, 8), *wheel(15, -16, 8)), 42, 26
    )


def _other(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Any element without a symbol of its own."""
    del element, values
    leads = (Stroke(((0, 0), (8, 0)), "shaft"), Stroke(((40, 0), (48, 0)), "shaft"))
    return Glyph((*leads, rectangle(8, 40, -10, 10, "#ffffff")), 48, 11)


_INLINE: dict[str, Callable[[Element, Mapping[str, Any]], Glyph]] = {
    "spring": _spring,
    "damper": _damper,
    "coupling": _coupling,
    "shaft": _shaft,
    "gear": _gear,
}


def inline_glyph(element: Element, values: Mapping[str, Any]) -> Glyph:
    """The symbol of an element between two ends."""
    return _INLINE.get(element.glyph, _other)(element, values)
