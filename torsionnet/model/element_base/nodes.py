"""Entries that name nodes and elements of a model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from torsionnet.core.entries.renaming import Renaming
from torsionnet.core.entries.spec import EntryError, Json, Schema, Spec
from torsionnet.core.entries.words import Text, name_fault
from torsionnet.model.element_base.laws import GROUND


@dataclass(frozen=True, eq=False, repr=False)
class NodeName(Spec[str]):
    """Entry for the node to which a port of an element is attached."""

    allow_ground: bool = True

    def coerce(self, raw: object) -> str:
        return read_node(raw, allow_ground=self.allow_ground)

    def renamed(self, value: Any, names: Renaming) -> Any:
        return names.node(value)

    def schema(self) -> Schema:
        return {"type": "string", "description": self.description}

    @property
    def accepted(self) -> str:
        return "str"


def read_node(raw: object, *, allow_ground: bool = True) -> str:
    """Node name that an entry gives; EntryError if it is no valid name, or ground where that is not allowed."""
    if not isinstance(raw, str) or not raw:
        raise EntryError(f"expected the name of a node, got {raw!r}")
    fault = name_fault(raw)
    if fault:
        raise EntryError(fault)
    if raw == GROUND and not allow_ground:
        raise EntryError("ground does not move; attach this to a node")
    return raw


@dataclass(frozen=True, eq=False, repr=False)
class ElementName(Text):
    """Entry for the name of an element of the model."""

    what: str = "the name of an element"

    def renamed(self, value: Any, names: Renaming) -> Any:
        return names.element(value)


class NodeText(Text):
    """Entry for the name of a node, or nothing."""

    def renamed(self, value: Any, names: Renaming) -> Any:
        return names.node(value) if value else value


@dataclass(frozen=True, eq=False, repr=False)
class PlaceOnElement(Text):
    """Entry for a port of an element, or the node there."""

    element: str = ""

    def renamed(self, value: Any, names: Renaming) -> Any:
        return names.at(self.element, value)


@dataclass(frozen=True, eq=False, repr=False)
class ReferenceNode(NodeName):
    """Entry for a node of the shaft at whose speed values are quoted, which is no port of the element."""

    allow_ground: bool = False


class NodePair(Spec[tuple[str, str]]):
    """Entry for two nodes, of which the first defines the sign of twist and torque."""

    def coerce(self, raw: object) -> tuple[str, str]:
        if isinstance(raw, str) or not isinstance(raw, Sequence) or len(raw) != 2:
            shown = "nothing" if raw is None else repr(raw)
            raise EntryError(f"expected two nodes [first, second], got {shown}")
        names = tuple(self._one(entry, index) for index, entry in enumerate(raw))
        if names[0] == names[1]:
            raise EntryError(f'both ends are on node "{names[0]}"; the element would do nothing', (1,))
        return (names[0], names[1])

    @staticmethod
    def _one(entry: Any, index: int) -> str:
        try:
            return read_node(entry)
        except EntryError as error:
            raise EntryError(error.fault.under(index)) from None

    def renamed(self, value: Any, names: Renaming) -> Any:
        return (names.node(value[0]), names.node(value[1]))

    def plain(self, value: Any) -> Json:
        return list(value)

    def schema(self) -> Schema:
        return {
            "type": "array",
            "items": {"type": "string"},
            "minItems": 2,
            "maxItems": 2,
            "description": self.description,
        }

    @property
    def accepted(self) -> str:
        return "TwoNames"
