"""Symbols inside boxes of a schematic, as a planetary set seen along its axis or a differential."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from torsionnet.plot.drawing.pieces import Stroke, arc
from torsionnet.plot.schematics.outlines import BODY, WHEEL, rectangle

if TYPE_CHECKING:
    from torsionnet.plot.schematics.epicyclic import BoxElement

HALF_SIZE = 24.0
"""Half the width and height in points of a symbol inside a box of the schematic."""

RING, ROOT, SUN, MOST_PLANETS = 23.5, 20.5, 8.0, 6  # radii in points: rim and teeth of the ring, sun
PLANET = (ROOT - SUN) / 2  # radius in points that fills the gap between sun and ring


def box_symbol(element: BoxElement, x: float, y: float) -> list[Stroke]:
    """Strokes of the symbol of an element inside a box of the schematic, around (x, y) in points.

    There are none for elements without a symbol.
    """
    if element.glyph == "planetary":
        given: Any = getattr(element, "planets", 3)
        return planetary_symbol(
            x, y, len(given) if isinstance(given, tuple) else given if isinstance(given, int) else 3
        )
    if element.glyph == "differential":
        locked = bool(getattr(element, "locked", False)) or getattr(element, "differential", "") == "locked"
        return differential_symbol(x, y, locked=locked)
    drawn = SHARED_SYMBOLS.get(element.glyph)
    return [stroke.shifted(x, y) for stroke in drawn()] if drawn else []


def gearbox_symbol() -> list[Stroke]:
    """Strokes of the symbol of a gearbox around (0, 0) in points, two shafts with three pairs of wheels."""
    shafts = [Stroke(((-22, y), (22, y)), "part") for y in (9, -9)]
    pairs = ((-13, 6.5), (0, 9.0), (13, 11.5))
    wheels = []
    for x, upper in pairs:
        wheels += [
            rectangle(x - 3, x + 3, 9 - upper, 9 + upper, WHEEL),
            rectangle(x - 3, x + 3, upper - 27, 9 - upper, WHEEL),
        ]
    return [*shafts, *wheels]


def belt_symbol() -> list[Stroke]:
    """Strokes of the symbol of a belt around (0, 0) in points, two pulleys with the belt, seen along their axes."""
    (left, big), (right, small) = (-11.0, 11.0), (14.0, 7.0)
    tilt = math.degrees(math.asin((big - small) / (right - left)))
    around = (
        *arc(left, 0, big, big, 90 - tilt, 270 + tilt, 24),
        *arc(right, 0, small, small, tilt - 90, 90 - tilt, 24),
    )
    hubs = [_circle(x, 0, 1.5, "part") for x in (left, right)]
    wheels = [_circle(left, 0, big - 2, WHEEL), _circle(right, 0, small - 2, WHEEL)]
    return [Stroke(around, "part", closed=True, fill="#ffffff"), *wheels, *hubs]


def hydrodynamic_symbol() -> list[Stroke]:
    """Strokes of the symbol of a fluid coupling or converter around (0, 0) in points, two half shells with blades."""
    found: list[Stroke] = []
    for sign in (-1, 1):
        shell = tuple((sign * (x + 2), y) for x, y in arc(0, 0, 14, 18, -90, 90, 20))
        found.append(Stroke(shell, "part", closed=True, fill=WHEEL))
        found += [Stroke(((sign * 2, y), (sign * 13, y)), "thin") for y in (-9, 0, 9)]
    return found


SHARED_SYMBOLS: dict[str, Callable[[], list[Stroke]]] = {
    "gearbox": gearbox_symbol,
    "belt": belt_symbol,
    "hydrodynamic": hydrodynamic_symbol,
}
"""Functions that return the strokes of symbols used in boxes and between two ends, by the element's ``glyph``."""


def planetary_symbol(x: float, y: float, planets: int = 3) -> list[Stroke]:
    """Strokes of the symbol of a planetary set seen along the axis, around (x, y) in points.

    The carrier is the star that joins the planets' axles.
    """
    count = max(1, min(planets, MOST_PLANETS))
    orbit = (ROOT + SUN) / 2
    angles = [math.pi / 2 + 2 * math.pi * i / count for i in range(count)]
    axles = [(x + orbit * math.cos(angle), y + orbit * math.sin(angle)) for angle in angles]
    # Many planets get smaller, so that they do not touch each other.
    radius = min(PLANET, orbit * math.sin(math.pi / count) - 0.8) if count > 1 else PLANET
    wheels = [_circle(u, v, radius, WHEEL) for u, v in axles]
    carrier = [Stroke(((x, y), axle), "carrier") for axle in axles]
    hubs = [_circle(u, v, 1.5, "part") for u, v in (*axles, (x, y))]
    outer = [_circle(x, y, RING, BODY), _circle(x, y, ROOT, "#ffffff")]
    return [*outer, *wheels, _circle(x, y, SUN, WHEEL), *carrier, *hubs]


def differential_symbol(x: float, y: float, *, locked: bool = False) -> list[Stroke]:
    """Strokes of the symbol of a differential, around (x, y) in points.

    Side gears and pinions in a cage, with a bar between the side gears if locked.
    """
    cage = Stroke(_rectangle(x, y, 23, 21), "part", closed=True, fill="#ffffff")
    sides = [_bevel(x, y, sign, level=True) for sign in (-1, 1)]
    pinions = [_bevel(x, y, sign, level=False) for sign in (-1, 1)]
    shafts = [Stroke(((x + sign * 16, y), (x + sign * 23, y)), "shaft") for sign in (-1, 1)]
    pin = Stroke(((x, y - 21), (x, y + 21)), "thin")
    lock = [rectangle(x - 10, x + 10, y - 2.5, y + 2.5, "part")] if locked else []
    return [cage, pin, *shafts, *sides, *pinions, *lock]


def _bevel(x: float, y: float, sign: int, *, level: bool) -> Stroke:
    """Stroke of a bevel gear in the symbol of a differential about (x, y) in points, its small end inwards."""
    corners = ((7.0, -5.5), (16.0, -12.0), (16.0, 12.0), (7.0, 5.5))
    points = ((x + sign * u, y + v) if level else (x + v, y + sign * u) for u, v in corners)
    return Stroke(tuple(points), "part", closed=True, fill=WHEEL)


def _rectangle(x: float, y: float, width: float, height: float) -> tuple[tuple[float, float], ...]:
    return ((x - width, y - height), (x + width, y - height), (x + width, y + height), (x - width, y + height))


def _circle(x: float, y: float, radius: float, fill: str) -> Stroke:
    return Stroke(arc(x, y, radius, radius, 0, 360, 36), "thin", closed=True, fill=fill)
