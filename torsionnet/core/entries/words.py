"""Entries that hold words, whole numbers, yes or no."""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Integral

from torsionnet.core.entries.spec import EntryError, Schema, Spec
from torsionnet.core.errors import did_you_mean

MODEL_NAME = "the name of a library model or the path of a model file"
"""Description of the name of a model, for entries and messages."""
NAME_SCHEMA: Schema = {"pattern": r"^[A-Za-z][A-Za-z0-9_]*(\.[A-Za-z][A-Za-z0-9_]*)*$"}
"""JSON Schema of the name of a node, an element, an input or a sensor."""


def name_fault(name: str) -> str | None:
    """Message that ``name`` cannot name a node, an element, an input or a sensor, or None if it can.

    What belongs to a part that is used in a model has the name of the use before a dot.

    >>> name_fault("hub"), name_fault("left.hub")
    (None, None)
    """
    if name.isascii() and all(is_single_word(piece) for piece in name.split(".")):
        return None
    return f'"{name}" is not a valid name; use letters, digits and _, beginning with a letter'


def is_single_word(name: str) -> bool:
    """Whether a name is one word, without a dot."""
    return name.isidentifier() and not name.startswith("_")


@dataclass(frozen=True, eq=False, repr=False)
class Text(Spec[str]):
    """Entry of free text, or of the name of something."""

    what: str = "text"

    def coerce(self, raw: object) -> str:
        if not isinstance(raw, str):
            raise EntryError(f"expected {self.what}, got {raw!r}")
        return raw

    def schema(self) -> Schema:
        return {"type": "string", "description": self.description}

    @property
    def accepted(self) -> str:
        return "str"


@dataclass(frozen=True, eq=False, repr=False)
class OneOf(Spec[str]):
    """Entry of one word out of a fixed list."""

    options: tuple[str, ...]

    def coerce(self, raw: object) -> str:
        if raw not in self.options:
            hint = did_you_mean(raw, self.options) if isinstance(raw, str) else ""
            raise EntryError(f"expected {' or '.join(self.options)}, got {raw!r}{hint}")
        return str(raw)

    def schema(self) -> Schema:
        return {"enum": list(self.options), "description": self.description}

    @property
    def accepted(self) -> str:
        return f"typing.Literal[{', '.join(map(repr, self.options))}]"


@dataclass(frozen=True, eq=False, repr=False)
class Count(Spec[int]):
    """Entry of a whole number in a range."""

    lower: int = 1
    upper: int = 1000

    def coerce(self, raw: object) -> int:
        if isinstance(raw, bool) or not isinstance(raw, Integral) or not self.lower <= int(raw) <= self.upper:
            raise EntryError(f"expected a whole number from {self.lower} to {self.upper}, got {raw!r}")
        return int(raw)

    def schema(self) -> Schema:
        return {"type": "integer", "minimum": self.lower, "maximum": self.upper, "description": self.description}

    @property
    def accepted(self) -> str:
        return "WholeNumber"


class Flag(Spec[bool]):
    """Entry of true or false."""

    def coerce(self, raw: object) -> bool:
        if not isinstance(raw, bool):
            raise EntryError(f"expected true or false, got {raw!r}")
        return raw

    def schema(self) -> Schema:
        return {"type": "boolean", "description": self.description}

    @property
    def accepted(self) -> str:
        return "bool"
