"""Entry for the place of a mean torque, a node or two nodes written as ``pulley-block``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from torsionnet.core.entries.renaming import Renaming
from torsionnet.core.entries.spec import EntryError
from torsionnet.core.entries.words import Text
from torsionnet.model.channels import Input, pair_fault, parse_pair
from torsionnet.model.element_base.nodes import NodeName


def torque_place(text: str) -> Input:
    """Torque input on a node, or on the first of two nodes with its reaction on the second.

    >>> torque_place("pulley-block").row, torque_place("pulley").row
    ({'pulley': 1, 'block': -1}, {'pulley': 1})
    """
    return Input("torque", *(parse_pair(text) or (text,)))


def place_fault(text: str) -> str | None:
    """Message if a text names no place for a mean torque, else None; nodes need not exist."""
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
