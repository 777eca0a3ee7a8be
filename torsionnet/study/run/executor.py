"""Who calculates the chunks of a study, and the blocks of its answers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Protocol, TypeVar

S = TypeVar("S")
T = TypeVar("T")


class Executor(Protocol):
    """Does work on parts: numbers of chunks, or whatever else says what is to be done."""

    def map(self, work: Callable[[S], T], parts: Iterable[S]) -> Iterator[tuple[S, T]]:
        """Every part with its result, in the order in which they are done; all of it can be pickled."""
        ...


@dataclass(frozen=True)
class SerialExecutor:
    """One part after the other, in this process.

    Examples
    --------
    >>> list(SerialExecutor().map(abs, [-1, 2]))
    [(-1, 1), (2, 2)]
    """

    def map(self, work: Callable[[S], T], parts: Iterable[S]) -> Iterator[tuple[S, T]]:
        """Part and result, in the order of the parts."""
        for part in parts:
            yield part, work(part)


def named(part: object) -> str:
    """A part as messages call it.

    >>> named(7)
    'chunk 7'
    """
    return f"chunk {part}" if isinstance(part, int) else str(part)
