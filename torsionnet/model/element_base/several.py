"""The base of entries that are several values of one kind."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

from torsionnet.core.entries.spec import EntryError, Plural, Spec, Stored_co

One_co = TypeVar("One_co", covariant=True)
"""What each of the values is stored as."""


@dataclass(frozen=True, eq=False, repr=False)
class Several(Plural[tuple[Stored_co, ...]], Generic[Stored_co, One_co]):
    """Base of entries that hold several values; what ``of`` is decides what each is."""

    of: Spec[One_co]
    shown: str
    """What to write, for messages."""
    fewest: int = 2

    @property
    def absent(self) -> tuple[Stored_co, ...]:
        return ()

    @property
    def example(self) -> str:
        return self.shown

    def refusal(self, raw: object) -> EntryError:
        return EntryError(f"expected {self.shown}, got {'nothing' if raw is None else repr(raw)}")
