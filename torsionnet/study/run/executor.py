"""Protocol of executors, which call a function for the chunks of a study or the blocks of its answers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Protocol, TypeVar

S = TypeVar("S")
T = TypeVar("T")


class Executor(Protocol):
    """Executor that calls a function for every part of a study, the number of a chunk, or a block of variants."""

    def map(self, work: Callable[[S], T], parts: Iterable[S]) -> Iterator[tuple[S, T]]:
        """Yield each part of a study with its result, in the order in which they are done.

        Function and parts can be pickled.
        """
        ...


class SerialExecutor:
    """Executor that does one part of a study after the other in this process.

    Examples
    --------
    >>> list(SerialExecutor().map(abs, [-1, 2]))
    [(-1, 1), (2, 2)]
    """

    def map(self, work: Callable[[S], T], parts: Iterable[S]) -> Iterator[tuple[S, T]]:
        """Yield each part of a study with its result, in the order of the parts."""
        for part in parts:
            yield part, work(part)


def part_name(part: object) -> str:
    """Words for a part of a study in messages.

    >>> part_name(7)
    'chunk 7'
    """
    return f"chunk {part}" if isinstance(part, int) else str(part)
