"""Operating point with the mean speeds and torques about which a linear model holds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Self

from torsionnet.core.entries.composite import Named, Nested
from torsionnet.core.entries.declared import Declared
from torsionnet.core.entries.scalars import PhysicalQuantity
from torsionnet.core.entries.spec import entry
from torsionnet.core.errors import Fault
from torsionnet.core.expressions import Expression
from torsionnet.model.element_base.nodes import NodeName
from torsionnet.model.torque_places import TorquePlace, place_fault, torque_place

FORM = "{node: value}"
_SPEED = Named(
    "mean speed by node, as 1500 rpm",
    PhysicalQuantity("mean speed", "speed", lower=None),
    form=FORM,
    keys=NodeName("a node"),
)
_TORQUE = Named(
    "mean external torque by node, as 80 N*m, or between two as pulley-block",
    PhysicalQuantity("mean torque", "torque", lower=None),
    refused=place_fault,
    form=FORM,
    keys=TorquePlace("a node, or two"),
)


@dataclass(frozen=True)
class OperatingPoint(Declared):
    """Mean speeds (rad/s) and mean external torques (N m) by node, as given in the model.

    A torque between two nodes, ``pulley-block``, acts on the first and as much the other way on the second.
    """

    kind: ClassVar[str] = "operating point"
    article: ClassVar[str] = "an operating point"
    form: ClassVar[str] = "{speed: {node: 1500 rpm}}"

    speed: Mapping[str, Expression] = entry(_SPEED, None)
    torque: Mapping[str, Expression] = entry(_TORQUE, None)

    @property
    def loaded_nodes(self) -> tuple[str, ...]:
        """Names of the nodes on which mean torques of the operating point act."""
        return tuple(dict.fromkeys(node for place in self.torque for node in torque_place(place).nodes))

    def __bool__(self) -> bool:
        return bool(self.speed or self.torque)

    @classmethod
    def read(cls, raw: object) -> tuple[Self | None, list[Fault]]:
        """Operating point from the entries that can be read, and the faults of the others."""
        found, faults = super().read(raw)
        if found is None and isinstance(raw, Mapping):
            found = cls(**cls.read_entries(raw)[0])
        return found, faults

    def with_overlay(self, other: OperatingPoint | None) -> OperatingPoint:
        """Operating point with the entries of ``other`` replacing its own."""
        if other is None:
            return self
        return OperatingPoint({**self.speed, **other.speed}, {**self.torque, **other.torque})


OPERATING_POINT = Nested(
    "mean speeds and torques the model is linear about", lambda: OperatingPoint, "operating_point", optional=True
)
