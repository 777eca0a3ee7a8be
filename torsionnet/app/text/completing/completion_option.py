"""Options of a completion before it is known which stretch of the text they replace."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

from torsionnet.app.text.completing.completion_names import ModelNames
from torsionnet.app.text.completing.completion_places import EntryPlace
from torsionnet.app.text.cursor_context import CursorContext
from torsionnet.base.entries.scalars import QuantityKind, Value
from torsionnet.base.entries.spec import Spec
from torsionnet.base.units import expected_unit


class CompletionOption(NamedTuple):
    """Option of a completion; ``begin`` is the number of characters of the word begun that stay before it."""

    label: str
    kind: str
    insert: str
    detail: str = ""
    documentation: str = ""
    begin: int = 0


@dataclass(frozen=True)
class Writing:
    """Text that is being written: its data without the word begun, where the cursor is, and which names there are.

    The word goes on behind the cursor up to ``end``.
    """

    text: str
    offset: int
    end: int
    context: CursorContext
    place: EntryPlace
    names: ModelNames
    folder: Path | None = None

    @cached_property
    def word(self) -> str:
        """Key or value begun, up to the cursor."""
        return self.text[self.context.word.start : self.offset]

    @cached_property
    def after(self) -> str:
        """Rest of the line behind the word at the cursor."""
        end = self.text.find("\n", self.end)
        return self.text[self.end : end if end >= 0 else None]

    @property
    def is_flow(self) -> bool:
        return self.context.is_flow

    def entries_around(self, levels: int = 1) -> Mapping[str, Any]:
        """Data of the table in which the entry stands, or of one further out."""
        found = self.place.around[-levels] if len(self.place.around) >= levels else None
        return found if isinstance(found, Mapping) else {}


def unit_text(spec: Spec[Any]) -> str:
    """SI unit of an entry that holds a physical quantity, else an empty text."""
    if isinstance(spec, QuantityKind | Value) and spec.dimension != "1":
        return expected_unit(spec.dimension)
    return ""


def summary(cls: type) -> str:
    """First line of the documentation of a class."""
    return (cls.__doc__ or "").strip().partition("\n")[0]
