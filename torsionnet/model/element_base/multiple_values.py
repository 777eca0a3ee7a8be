"""Base class of entries with several values of one kind."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

from torsionnet.core.entries.spec import EntryError, Plural, Spec, Stored_co

One_co = TypeVar("One_co", covariant=True)
"""Type variable of the form in which a single value is stored."""


@dataclass(frozen=True, eq=False, repr=False)
class MultipleValues(Plural[tuple[Stored_co, ...]], Generic[Stored_co, One_co]):
    """Base class of entries with several values, each of the kind of the specification ``of``."""

    of: Spec[One_co]
    example_text: str
    """Example of the entry for messages that it is missing or wrong."""
    fewest: int = 2

    @property
    def absent(self) -> tuple[Stored_co, ...]:
        return ()

    @property
    def example(self) -> str:
        return self.example_text

    def refusal(self, raw: object) -> EntryError:
        return EntryError(f"expected {self.example_text}, got {'nothing' if raw is None else repr(raw)}")
