"""Torques and twists in a schematic: which element they belong to, and what the mark on the shaft says.

A mark reads as the torque of what it stands beside. So it goes right to its element, behind whatever else is at the
node: between them nothing may branch off.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from torsionnet.plot.drawing.labels import symbol
from torsionnet.plot.schematic.marks import Mark
from torsionnet.plot.schematic.topology import Link


@dataclass(frozen=True)
class Tap:
    """A sensor of the torque or twist of an element."""

    name: str
    quantity: str
    element: str
    port: str

    def mark(self, *, alone: bool) -> Mark:
        """Its mark; ``alone`` if the shaft where it stands carries this element and nothing else."""
        what = self.quantity if alone else f"{self.quantity} of {self.element}"
        return Mark("torque", symbol(self.name), what)


def belongs(tap: Tap, link: Link) -> bool:
    """Whether a tap is of what a link stands for: one of its elements, or the port of a box."""
    if link.elements:
        return any(element.name == tap.element for element in link.elements)
    boxes = {vertex.name for vertex in (link.first, link.second) if vertex.is_box}
    return tap.element in boxes and tap.port == link.port


def marks_beside(taps: Iterable[Tap], link: Link, *, alone: bool = True) -> list[Mark]:
    """Marks of the taps that belong to a link, to stand right beside it."""
    return [tap.mark(alone=alone and len(link.elements) == 1) for tap in taps if belongs(tap, link)]
