"""Symbols of elements with laws of motion in a schematic: clearances and dry friction."""

from __future__ import annotations

from torsionnet.model.elements import Element
from torsionnet.plot.drawing.pieces import Stroke
from torsionnet.plot.schematics.outlines import BODY, Glyph, rectangle, zigzag

_HALF = 10.0  # points, half height of both symbols


def clearance_symbol() -> Glyph:
    """Symbol of a clearance in a schematic, a tooth that stands free between the two jaws of a fork."""
    back, first, jaw, second, tip = 12.0, 16.0, 4.0, 36.0, 40.0
    fork = [
        Stroke(((0, 0), (back, 0)), "shaft"),
        Stroke(((back, 0), (back, _HALF), (tip, _HALF), (tip, _HALF - jaw))),
        Stroke(((first, _HALF), (first, _HALF - jaw))),
    ]
    tooth = rectangle((first + second) / 2 - 3, (first + second) / 2 + 3, -_HALF, _HALF - 2, BODY)
    lead = Stroke((((first + second) / 2, -_HALF), (second + 16, -_HALF), (second + 16, 0)), "shaft")
    return Glyph((*fork, lead, tooth), second + 16, _HALF + 1)


def friction_symbol(element: Element) -> Glyph:
    """Symbol of dry friction in a schematic, two plates pressed together, behind a spring if the element has one."""
    start = 36.0 if element.internal_nodes else 0.0
    middle = start + 18.0
    inner, outer = 3.0, 8.0  # points from the middle to both faces of a plate
    leads = [
        Stroke(((start, 0), (middle - outer, 0)), "shaft"),
        Stroke(((middle + outer, 0), (middle + 18, 0)), "shaft"),
    ]
    plates = [
        rectangle(middle - outer, middle - inner, -_HALF, _HALF, BODY),
        rectangle(middle + inner, middle + outer, -_HALF, _HALF, BODY),
    ]
    hatches = [
        Stroke(((middle - 3, y), (middle + 3, y + 5)), "thin") for y in (-_HALF, -_HALF + 5, -_HALF + 10, -_HALF + 15)
    ]
    spring = [zigzag(0.0, start, 0.0)] if start else []
    return Glyph((*spring, *leads, *plates, *hatches), middle + 18, _HALF + 1)
