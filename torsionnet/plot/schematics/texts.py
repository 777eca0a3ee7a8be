"""Labels of a schematic in several lines, with long names broken, and the gears of planetary sets listed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from torsionnet.model.elements import Element
from torsionnet.plot.drawing.labels import value_lines
from torsionnet.plot.drawing.pieces import Texts, is_math, text_width
from torsionnet.plot.schematics.epicyclic import EpicyclicSet

WIDEST = {"input": 64.0, "sensor": 64.0, "what": 70.0}
"""Greatest width in points of a line of a label, by role of its text, a name in ``ROLES``; marks stand closer to each
other than elements."""

WIDEST_OTHER, WIDEST_SET = 104.0, 150.0  # points, of other roles and of planetary sets


def break_lines(lines: Iterable[tuple[str, str]]) -> Texts:
    """Lines (text, role) of a label, of which wide ones are broken behind underscores, commas and spaces.

    >>> break_lines([("speed", "sensor"), ("angular_velocity_of_the_rotor", "sensor")])
    [('speed', 'sensor'), ('angular_', 'sensor'), ('velocity_of_', 'sensor'), ('the_rotor', 'sensor')]
    """
    return [(piece, role) for text, role in lines for piece in _pieces(text, role, WIDEST.get(role, WIDEST_OTHER))]


def wrap_text(text: str, role: str, limit: float) -> list[str]:
    """List of the lines of a text broken to a width in points at spaces, or at underscores of long words.

    None if it is empty.
    """
    pieces = [""]
    for word in _parts(text, " "):
        for part in _parts(word, "_") if text_width(word, role) > limit else [word]:
            if pieces[-1] and text_width(pieces[-1] + part.rstrip(), role) > limit:
                pieces.append("")
            pieces[-1] += part
    return [piece.strip() for piece in pieces if piece]


def _pieces(text: str, role: str, limit: float) -> list[str]:
    if text_width(text, role) <= limit:
        return [text]
    if is_math(text, role):
        head, equals, tail = text.partition(" = ")
        return [f"{head} =", tail] if equals else [text]
    return wrap_text(text, role, limit)


def _parts(text: str, mark: str) -> list[str]:
    """List of the parts of a text, cut behind each occurrence of ``mark``, but not at the end of the text."""
    *parts, last = text.split(mark)
    whole = [part + mark for part in parts]
    return whole if whole and not last else [*whole, last]


def planetary_set_lines(drawn: EpicyclicSet, values: Mapping[str, Any]) -> Texts:
    """Lines (text, role) of a planetary set's label, names and values of its meshes, and names of its planets.

    Meshes of equal values stand together.
    """
    lines = [*_alike(drawn.sun_meshes, values), *_alike(drawn.ring_meshes, values), *_alike(drawn.bodies, values)]
    planets = f"{'planets' if len(drawn.planets) > 1 else 'planet'}: {', '.join(drawn.planets)}"
    return [(piece, role) for text, role in [*lines, (planets, "node")] for piece in _pieces(text, role, WIDEST_SET)]


def _alike(elements: Sequence[Element], values: Mapping[str, Any]) -> Texts:
    """Lines (text, role) of a label, the names of elements of equal values followed by these values."""
    groups: dict[tuple[str, ...], list[str]] = {}
    for element in elements:
        groups.setdefault(tuple(value_lines(element, values)), []).append(element.name)
    lines: Texts = []
    for shown, names in groups.items():
        lines += [(", ".join(names), "name"), *((text, "value") for text in shown)]
    return lines
