"""The base of entries that are several values of one kind."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from torsionnet.core.entries.spec import EntryError, Spec


@dataclass(frozen=True, eq=False, repr=False)
class Several(Spec):
    """Base of entries that hold several values; what ``of`` is decides what each is."""

    of: Spec
    shown: str
    """What to write, for messages."""
    fewest: int = 2

    @property
    def absent(self) -> tuple[Any, ...]:
        return ()

    @property
    def example(self) -> str:
        return self.shown

    def refusal(self, raw: Any) -> EntryError:
        return EntryError(f"expected {self.shown}, got {'nothing' if raw is None else repr(raw)}")
