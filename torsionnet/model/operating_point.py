"""Operating point with the mean speeds and torques about which a linear model holds.

Here as well: entry for the place of a mean torque, a node or two nodes written as ``pulley-block``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from torsionnet.base.entries.composite import Named, Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import EntryError, Renaming, Text, entry
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Expression
from torsionnet.model.channels import Input, pair_fault, parse_pair
from torsionnet.model.element_base.element_entries import NodeName


def torque_place(text: str) -> Input:
    """Torque input on a node, or on the first of two nodes with its reaction on the second.

    >>> torque_place("pulley-block").row, torque_place("pulley").row
    ({'pulley': 1, 'block': -1}, {'pulley': 1})
    """
    return Input("torque", *(parse_pair(text) or (text,)))


def place_fault(text: str) -> Fault | None:
    """Fault if a text names no place for a mean torque, else None; nodes need not exist."""
    pair = parse_pair(text)
    return None if pair is None else pair_fault(*pair, "torque")


def renamed_place(text: str, names: Renaming) -> str:
    """Place of a torque in a part, with the names of its nodes in the whole model."""
    return "-".join(names.node(node) for node in torque_place(text).nodes)


@dataclass(frozen=True, eq=False, repr=False)
class TorquePlace(NodeName):
    """Entry for the place of a torque, a node or two nodes as ``pulley-block``."""

    allow_ground: bool = False

    def coerce(self, raw: object) -> str:
        if not isinstance(raw, str) or parse_pair(raw) is None:
            return super().coerce(raw)
        fault = place_fault(raw)
        if fault:
            raise EntryError(fault)
        return raw

    def renamed(self, value: Any, names: Renaming) -> Any:
        return renamed_place(value, names)


class TorqueInput(TorquePlace):
    """Entry for the place of a torque, or an input of the model."""

    def renamed(self, value: Any, names: Renaming) -> Any:
        return names.channel(value) if value in names.channels else super().renamed(value, names)


class DriverName(TorquePlace):
    """Entry for the place of a torque, or an excitation that drives there."""

    def renamed(self, value: Any, names: Renaming) -> Any:
        return names.excitation(value) if value in names.excitations else super().renamed(value, names)


class MachineName(Text):
    """Entry for a machine, an element or an excitation of the model."""

    def renamed(self, value: Any, names: Renaming) -> Any:
        is_excitation = value in names.excitations and value not in (names.ports or {})
        return names.excitation(value) if is_excitation else names.element(value)


class ExcitationName(Text):
    """Entry for the name of an excitation of the model."""

    def renamed(self, value: Any, names: Renaming) -> Any:
        return names.excitation(value)


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
        point, faults = super().read(raw)
        if point is None and isinstance(raw, Mapping):
            point = cls(**cls.read_entries(raw)[0])
        return point, faults

    def with_overlay(self, other: OperatingPoint | None) -> OperatingPoint:
        """Operating point with the entries of ``other`` replacing its own."""
        if other is None:
            return self
        return OperatingPoint({**self.speed, **other.speed}, {**self.torque, **other.torque})


OPERATING_POINT = Nested(
    "mean speeds and torques the model is linear about", lambda: OperatingPoint, "operating_point", optional=True
)
