"""Excitation by the non-uniform rotation of a universal joint at an angle."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, entry
from torsionnet.base.errors import Fault, ModelName, Worded, named_list
from torsionnet.machinery.excitations.order_excitation import FloatArray, OrderTorques, register_excitation
from torsionnet.machinery.excitations.twist_excitation import TwistExcitation, shafts_of
from torsionnet.model.element_base.element_entries import ElementName
from torsionnet.model.elements import Element

LARGEST_JOINT_ANGLE = math.radians(45)
"""Largest angle in rad for which cross joints are built, as one in degrees without its unit is far above."""


@register_excitation
@dataclass(frozen=True, kw_only=True)
class UniversalJoint(TwistExcitation):
    """A cross joint at the angle beta: tan(out) = tan(in)/cos(beta), in = phi + phase of its input yoke.

    Its output runs ahead by out - in = sum_n tan(beta/2)^(2n)/n sin(2 n in), which is imposed as a twist in the element
    ``joint``: the spring between input and output, as the shaft beside the joint. The yoke's angle is 0 where its arms
    lie in the plane of both shafts. What the joint does by the torque it carries (bending, and a part of that
    torque at twice the speed) is not included.

    Examples
    --------
    >>> cross = UniversalJoint(joint="shaft", speed_of="gearbox", angle="10 deg")
    >>> found = cross.torques(np.array([100.0]))
    >>> found.orders.tolist(), abs(found.amplitudes[0, :, 0]).round(8).tolist()
    ([2.0, 4.0], [0.00765427, 2.929e-05])
    """

    kind: ClassVar[str] = "universal_joint"
    element_field: ClassVar[str] = "joint"

    joint: str = entry(ElementName("the element between its input and its output, a spring or a compliant gear"))
    angle: float = entry(Value("angle between input and output shaft", "angle"))
    phase: float = entry(
        Value("angle of the input yoke where phi is 0; 90 deg if in line with that of the last joint", "angle", None), 0
    )
    multiples: int = entry(Count("how many multiples of twice the speed act", 1, 10), 2)

    def contradictions(self) -> list[Fault]:
        if self.angle < LARGEST_JOINT_ANGLE:
            return []
        text = f"a universal joint works at less than {math.degrees(LARGEST_JOINT_ANGLE):g} deg"
        return [Fault(f"{text}; a bare number is in radians, write 10 deg", ("angle",))]

    def element_faults(self, elements: Mapping[str, Element]) -> list[Fault]:
        element = elements[self.joint]
        if element.glyph not in ("spring", "shaft"):
            said = "{} is a {}; a joint is in a spring between its two shafts"
            return [Fault(Worded(said, ModelName(self.joint), element.kind), ("joint",))]
        shafts = shafts_of(element)
        if self.speed_of in shafts:
            return []
        said = "the input of a joint is an end of its element; {} connects {}"
        text = Worded(said, ModelName(self.joint), named_list(shafts, between=" and "))
        return [Fault(text, ("speed_of",))]

    def torques(self, speeds: FloatArray) -> OrderTorques:
        count = np.arange(1, self.multiples + 1)
        sizes = math.tan(self.angle / 2) ** (2 * count) / count
        # cos(x - pi/2) is sin x; what counts is how far the input is ahead of the output.
        lag = -sizes * -1j * np.exp(2j * count * self.phase)
        amplitudes = np.broadcast_to(lag[None, :, None], (len(speeds), len(count), 1)).copy()
        return OrderTorques(np.asarray(2.0 * count, dtype=float), (self.joint,), amplitudes)
