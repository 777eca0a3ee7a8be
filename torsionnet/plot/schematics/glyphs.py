"""Symbols of elements between two ends in a schematic, drawn along a line from (0, 0)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from torsionnet.model.elements import Element, Law, Values
from torsionnet.plot.drawing.pieces import Point, Stroke, arc
from torsionnet.plot.schematics.outlines import BODY, BOX, Glyph, rectangle, wheel
from torsionnet.plot.schematics.symbols import box_symbol, chain_symbol, clearance_symbol, friction_symbol

_LENGTH, _HALF = 52.0, 14.0


def _spring(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Symbol of an element with stiffness in a schematic, springs and dashpots, with discs if both ends are heavy."""
    between = chain_symbol(element, values, "spring")
    ends = [*element.ports.values()]
    heavy = {
        node
        for part in element.parts(Values(values))
        if isinstance(part, Law) and part.inertia != 0 and len(part.row) == 1
        for node in part.row
    }
    return _between_discs(between) if len(ends) == 2 and heavy.issuperset(ends) else between


def _between_discs(inner: Glyph) -> Glyph:
    """Copy of a symbol of the schematic with a disc added at either end."""
    first, width, half = 4.0, 8.0, max(16.0, inner.half_width)
    start = first + width
    end = start + inner.length
    leads = (Stroke(((0, 0), (first, 0)), "shaft"), Stroke(((end + width, 0), (end + start, 0)), "shaft"))
    discs = (rectangle(first, start, -half, half, BODY), rectangle(end, end + width, -half, half, BODY))
    return Glyph((*leads, *inner.along(start, 0), *discs), end + start, half + 1)


def _damper(element: Element, values: Mapping[str, Any]) -> Glyph:
    return chain_symbol(element, values, "damper")


def _disc(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Symbol of an inertia between two ends of a schematic, a disc on a shaft."""
    del element, values
    return Glyph((Stroke(((0, 0), (30, 0)), "shaft"), rectangle(8.5, 21.5, -15, 15, BODY)), 30, 16)


def _clearance(element: Element, values: Mapping[str, Any]) -> Glyph:
    del element, values
    return clearance_symbol()


def _friction(element: Element, values: Mapping[str, Any]) -> Glyph:
    del values
    return friction_symbol(element)


def _coupling(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Symbol of a coupling in a schematic, two flanges face to face."""
    del element, values
    flanges = (rectangle(10, 15, -13, 13, BODY), rectangle(15, 20, -13, 13, BODY))
    return Glyph((Stroke(((0, 0), (10, 0)), "shaft"), *flanges, Stroke(((20, 0), (30, 0)), "shaft")), 30, 14)


def _shaft(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Symbol of a shaft in a schematic, a thin cylinder with lines between its segments."""
    del values
    start, end, half = 5.0, 55.0, 6.0
    outline = (*arc(start, 0, 2.5, half, 90, 270, 8), *arc(end, 0, 2.5, half, -90, 90, 8))
    given = getattr(element, "segments", 1)
    count = min(given, 6) if isinstance(given, int) else 1
    cuts = [start + (end - start) * i / count for i in range(1, count)]
    body = Stroke(outline, "part", closed=True, fill=BODY)
    rings = [Stroke(arc(x, 0, 2.5, half, -90, 90, 8), "thin") for x in (*cuts, end - 0.01)]
    leads = [Stroke(((0, 0), (start - 2.5, 0)), "shaft"), Stroke(((end + 2.5, 0), (60, 0)), "shaft")]
    return Glyph((*leads, body, *rings[:-1]), 60, 8)


def _gear(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Symbol of a gear stage in a schematic, drawn in line for places without room for two shafts."""
    del element, values
    out: tuple[Point, ...] = ((15, -16), (30, -16), (30, 0), (42, 0))
    return Glyph(
        (Stroke(((0, 0), (15, 0)), "shaft"), Stroke(out, "shaft"), *wheel(15, 0, 8), *wheel(15, -16, 8)), 42, 26
    )


def _pendulum(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Symbol of a pendulum absorber in a schematic, a rod on a pin, and the path of its end."""
    del element, values
    pin = Stroke(arc(13, 0, 3, 3, 0, 360), "part", closed=True, fill="#ffffff")
    path = Stroke(arc(13, 0, 28, 28, -32, 32), "thin")
    return Glyph((Stroke(((0, 0), (10, 0))), pin, Stroke(((16, 0), (48, 0))), path), 48, 15)


def _boxed(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Symbol of an element whose own sign, as of a gearbox, stands in a box between its two ends in the schematic."""
    del values
    leads = (Stroke(((0, 0), (8, 0)), "shaft"), Stroke(((64, 0), (72, 0)), "shaft"))
    return Glyph((*leads, rectangle(8, 64, -24, 24, BOX), *box_symbol(element, 36, 0)), 72, 25)


def _other(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Symbol of elements without a symbol of their own in a schematic, an empty box."""
    del element, values
    leads = (Stroke(((0, 0), (8, 0)), "shaft"), Stroke(((40, 0), (48, 0)), "shaft"))
    return Glyph((*leads, rectangle(8, 40, -10, 10, "#ffffff")), 48, 11)


def _crank() -> Glyph:
    """Symbol of a crank throw in a schematic, its webs, pin and journals seen from the side."""
    webs = [rectangle(x, x + 6, -7, 21, BODY) for x in (14, 32)]
    pin = rectangle(20, 32, 12, 20, BODY)
    leads = [Stroke(((0, 0), (14, 0)), "shaft"), Stroke(((38, 0), (_LENGTH, 0)), "shaft")]
    return Glyph((*leads, pin, *webs), _LENGTH, 22)


def _machine() -> Glyph:
    """Symbol of an electric machine in a schematic, a circle with one period of an alternating voltage."""
    middle = _LENGTH / 2
    circle = Stroke(arc(middle, 0, _HALF, _HALF, 0, 360, 40), "part", closed=True, fill=BOX)
    wave = tuple((middle - 9 + 18 * i / 24, 5 * math.sin(2 * math.pi * i / 24)) for i in range(25))
    return Glyph((*_leads(), circle, Stroke(wave)), _LENGTH, _HALF + 1)


def _load() -> Glyph:
    """Symbol of a load in a schematic, a curve of torque that falls with speed over its axes."""
    axes = ((15.0, 11.0), (15.0, -9.0), (39.0, -9.0))
    falling = tuple((17.0 + u, 60 / (5.0 + u) - 9) for u in range(17))
    box = rectangle(12, 40, -_HALF, _HALF, BOX)
    return Glyph((*_leads(), box, Stroke(axes, "thin"), Stroke(falling)), _LENGTH, _HALF + 1)


def _controller() -> Glyph:
    """Symbol of a controller in a schematic, an arrow that comes back to where it starts, as a closed loop."""
    middle = _LENGTH / 2
    path = arc(middle, 0, 8.5, 8.5, 160, -140, 30)
    x, y = path[-1]
    head = ((x + 1.5, y + 4.5), (x - 4.5, y - 0.5), (x + 3.0, y - 4.0))
    box = rectangle(12, 40, -_HALF, _HALF, BOX)
    return Glyph((*_leads(), box, Stroke(path), Stroke(head, closed=True, fill="#222222")), _LENGTH, _HALF + 1)


def _sheet() -> Glyph:
    """Symbol of elements given by matrices or tables in a schematic, a box with rows and columns."""
    lines = [Stroke(((12, y), (40, y)), "thin") for y in (-7, 0, 7)]
    columns = [Stroke(((x, -_HALF), (x, _HALF)), "thin") for x in (21, 30.5)]
    return Glyph((*_leads(), rectangle(12, 40, -_HALF, _HALF, BOX), *lines, *columns), _LENGTH, _HALF + 1)


def _leads() -> tuple[Stroke, Stroke]:
    return Stroke(((0, 0), (12, 0)), "shaft"), Stroke(((40, 0), (_LENGTH, 0)), "shaft")


_MACHINES: dict[str, Callable[[], Glyph]] = {
    "crank": _crank,
    "machine": _machine,
    "load": _load,
    "controller": _controller,
    "sheet": _sheet,
}
"""Functions that return the symbols of elements drawn alike whatever their values, by the element's ``glyph``."""
_INLINE: dict[str, Callable[[Element, Mapping[str, Any]], Glyph]] = {
    "disc": _disc,
    "spring": _spring,
    "damper": _damper,
    "clearance": _clearance,
    "friction": _friction,
    "coupling": _coupling,
    "shaft": _shaft,
    "gear": _gear,
    "pendulum": _pendulum,
    "gearbox": _boxed,
    "belt": _boxed,
    "hydrodynamic": _boxed,
}


def inline_glyph(element: Element, values: Mapping[str, Any]) -> Glyph:
    """Symbol of an element between two ends in a schematic, as strokes with length and half width in points."""
    if element.glyph in _MACHINES:
        return _MACHINES[element.glyph]()
    return _INLINE.get(element.glyph, _other)(element, values)
