"""Where a mean torque acts: on a node, or between two nodes written as ``pulley-block``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from torsionnet.core.entries.renaming import Renaming
from torsionnet.core.entries.spec import EntryError
from torsionnet.model.channels import Input, pair_fault, parse_pair
from torsionnet.model.element_base.nodes import NodeName


def torque_place(text: str) -> Input:
    """The torque on a node, or on the first of two nodes and its reaction on the second.

    >>> torque_place("pulley-block").row, torque_place("pulley").row
    ({'pulley': 1, 'block': -1}, {'pulley': 1})
    """
    return Input("torque", *(parse_pair(text) or (text,)))


def place_fault(text: str) -> str | None:
    """Why a mean torque cannot act there, or None; whether the nodes exist is another question."""
    pair = parse_pair(text)
    return None if pair is None else pair_fault(*pair, "torque")


def renamed_place(text: str, names: Renaming) -> str:
    """The place in a part, with the names that its nodes have in the whole."""
    return "-".join(names.node(node) for node in torque_place(text).nodes)


@dataclass(frozen=True, eq=False, repr=False)
class TorquePlace(NodeName):
    """A node, or two as ``pulley-block``."""

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
