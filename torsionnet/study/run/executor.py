"""Who calculates the chunks of a study."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Protocol, TypeVar

T = TypeVar("T")


class Executor(Protocol):
    """Does work on numbered chunks."""

    def map(self, work: Callable[[int], T], numbers: Iterable[int]) -> Iterator[tuple[int, T]]:
        """Number and result of every chunk, in the order in which they are done; ``work`` can be pickled."""
        ...


@dataclass(frozen=True)
class SerialExecutor:
    """One chunk after the other, in this process.

    Examples
    --------
    >>> list(SerialExecutor().map(abs, [-1, 2]))
    [(-1, 1), (2, 2)]
    """

    def map(self, work: Callable[[int], T], numbers: Iterable[int]) -> Iterator[tuple[int, T]]:
        """Number and result, in the order of the numbers."""
        for number in numbers:
            yield number, work(number)
