"""Sensors of torque and twist in a schematic, with the element they are on and their mark on the shaft.

A mark reads as the torque of the element it stands beside. So it stands right at its element, and nothing may branch
off between them.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from torsionnet.plot.drawing.labels import symbol
from torsionnet.plot.schematics.marks import Mark
from torsionnet.plot.schematics.topology import Link


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
