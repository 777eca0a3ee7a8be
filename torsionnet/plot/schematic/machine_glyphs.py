"""Symbols of machines and of what acts on them, each along a line from (0, 0): cranks, rotors, controllers, sheets."""

from __future__ import annotations

import math

from torsionnet.plot.drawing.pieces import Stroke, arc
from torsionnet.plot.schematic.outlines import BODY, BOX, Glyph, rectangle

_LENGTH, _HALF = 52.0, 14.0


def crank() -> Glyph:
    """A throw seen from the side: journal, web, pin, web, journal."""
    webs = [rectangle(x, x + 6, -7, 21, BODY) for x in (14, 32)]
    pin = rectangle(20, 32, 12, 20, BODY)
    leads = [Stroke(((0, 0), (14, 0)), "shaft"), Stroke(((38, 0), (_LENGTH, 0)), "shaft")]
    return Glyph((*leads, pin, *webs), _LENGTH, 22)


def machine() -> Glyph:
    """An electric machine: a circle with one period of an alternating voltage."""
    middle = _LENGTH / 2
    circle = Stroke(arc(middle, 0, _HALF, _HALF, 0, 360, 40), "part", closed=True, fill=BOX)
    wave = tuple((middle - 9 + 18 * i / 24, 5 * math.sin(2 * math.pi * i / 24)) for i in range(25))
    return Glyph((*_leads(), circle, Stroke(wave)), _LENGTH, _HALF + 1)


def load() -> Glyph:
    """A torque that falls with speed, over its axes."""
    axes = ((15.0, 11.0), (15.0, -9.0), (39.0, -9.0))
    falling = tuple((17.0 + u, 60 / (5.0 + u) - 9) for u in range(17))
    box = rectangle(12, 40, -_HALF, _HALF, BOX)
    return Glyph((*_leads(), box, Stroke(axes, "thin"), Stroke(falling)), _LENGTH, _HALF + 1)


def controller() -> Glyph:
    """A closed loop: an arrow that comes back to where it starts."""
    middle = _LENGTH / 2
    path = arc(middle, 0, 8.5, 8.5, 160, -140, 30)
    x, y = path[-1]
    head = ((x + 1.5, y + 4.5), (x - 4.5, y - 0.5), (x + 3.0, y - 4.0))
    box = rectangle(12, 40, -_HALF, _HALF, BOX)
    return Glyph((*_leads(), box, Stroke(path), Stroke(head, closed=True, fill="#222222")), _LENGTH, _HALF + 1)


def sheet() -> Glyph:
    """Rows and columns."""
    lines = [Stroke(((12, y), (40, y)), "thin") for y in (-7, 0, 7)]
    columns = [Stroke(((x, -_HALF), (x, _HALF)), "thin") for x in (21, 30.5)]
    return Glyph((*_leads(), rectangle(12, 40, -_HALF, _HALF, BOX), *lines, *columns), _LENGTH, _HALF + 1)


def _leads() -> tuple[Stroke, Stroke]:
    return Stroke(((0, 0), (12, 0)), "shaft"), Stroke(((40, 0), (_LENGTH, 0)), "shaft")
