"""Sensors of torque and twist in a schematic, with the element they are on and their mark on the shaft.

A mark reads as the torque of the element it stands beside. So it stands right at its element, and nothing may branch
off between them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from torsionnet.model.elements import Element
from torsionnet.plot.drawing.labels import symbol, value_lines
from torsionnet.plot.drawing.pieces import Piece, Stroke, Texts, is_math, text_width
from torsionnet.plot.schematics import outlines
from torsionnet.plot.schematics.topology import EpicyclicSet, Link

# Labels of a schematic in several lines, with long names broken, and the gears of planetary sets listed.

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


# Marks of inputs and sensors on a shaft line, with their names above the shaft.

TOPS = {"input": 19.0, "reaction": 19.0, "motion": 20.0, "torque": 20.0}
"""Heights in points above the shaft at which the name of a mark begins, by kind of mark."""

ARROW = 17.0
"""Half the height of a torque arrow in points."""


@dataclass(frozen=True)
class Mark:
    """Mark in a schematic of an input, of its reaction on a second node, or of a sensor of motion or torque."""

    kind: str
    name: str
    """Text of the name, set as a symbol if it is one."""
    what: str
    channel: str
    """Name of the input or sensor in the model."""

    def piece(self, lift: float = 0.0) -> Piece:
        """Drawing of the mark around x = 0, with its name raised by ``lift`` points above the usual height."""
        top = TOPS[self.kind] + lift
        piece = Piece()
        with piece.owned("input" if self._is_arrow else "sensor", self.channel):
            self._draw(piece, top, lift)
        return piece

    def _draw(self, piece: Piece, top: float, lift: float) -> None:
        if self._is_arrow:
            piece.strokes += outlines.torque_arrow(0.0, opposite=self.kind == "reaction")
            piece.boxes.append((-8, 8, -ARROW - 2, TOPS["input"]))
        else:
            piece.strokes += outlines.sensor_mark(0.0, torque=self.kind == "torque", leader=top)
            piece.boxes.append((-5, 5, -5, TOPS["torque"]))
        if lift:
            leader = Stroke(((0, ARROW), (0, top)), "leader")
            piece.strokes += [leader] if self._is_arrow else []
            piece.boxes.append((-1.5, 1.5, 0, top))
        piece.write(0, top, self.texts)

    @property
    def _is_arrow(self) -> bool:
        return self.kind in ("input", "reaction")

    @property
    def texts(self) -> Texts:
        """Lines (text, role) of the label of the mark, its name and its description."""
        return break_lines([(self.name, "input" if self._is_arrow else "sensor"), (self.what, "what")])


@dataclass(frozen=True)
class Tap:
    """Sensor of the torque or twist of an element at one of the ports of that element."""

    name: str
    quantity: str
    element: str
    port: str

    def mark(self, *, alone: bool) -> Mark:
        """Mark of the sensor of torque or twist in a schematic, with name and description.

        ``alone`` if the shaft there carries this element only, so that its name is left out.
        """
        what = self.quantity if alone else f"{self.quantity} of {self.element}"
        return Mark("torque", symbol(self.name), what, self.name)


def is_on_link(tap: Tap, link: Link) -> bool:
    """Whether a sensor is on an element of a schematic's link, or at the port of a box for which the link stands."""
    if link.elements:
        return any(element.name == tap.element for element in link.elements)
    boxes = {vertex.name for vertex in (link.first, link.second) if vertex.is_box}
    return tap.element in boxes and tap.port == link.port


def marks_beside(taps: Iterable[Tap], link: Link, *, alone: bool = True) -> list[Mark]:
    """List of the marks of the sensors that belong to a link of the schematic, to stand right beside the link."""
    return [tap.mark(alone=alone and len(link.elements) == 1) for tap in taps if is_on_link(tap, link)]
