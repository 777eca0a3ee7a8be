"""Executors, which call a function for the chunks of a study or the blocks of its answers, here or elsewhere."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Protocol, TypeVar

from torsionnet.base.errors import UsageError

S = TypeVar("S")
T = TypeVar("T")


class Executor(Protocol):
    """Executor that calls a function for every part of a study, the number of a chunk, or a block of variants."""

    def map(self, work: Callable[[S], T], parts: Iterable[S]) -> Iterator[tuple[S, T]]:
        """Yield each part of a study with its result, in the order in which they are done.

        Function and parts can be pickled.
        """
        ...


@dataclass(frozen=True)
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


@dataclass(frozen=True)
class PackedWork:
    """Function of an executor as bytes for other processes, each of which unpacks it once and keeps its plans.

    Examples
    --------
    >>> PackedWork.of(abs)(-2)
    2
    """

    data: bytes

    @classmethod
    def of(cls, work: Callable[[Any], Any]) -> PackedWork:
        """Pack a function, or raise UsageError where it contains what other processes cannot receive."""
        try:
            return cls(pickle.dumps(work))
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            text = "define functions of quantities at the top level of a module, or run it in one process"
            raise UsageError(f"the study cannot be handed to other processes ({error}); {text}") from None

    def __call__(self, part: Any) -> Any:
        return _unpacked(self.data)(part)


@lru_cache(maxsize=16)
def _unpacked(data: bytes) -> Callable[[Any], Any]:
    work: Callable[[Any], Any] = pickle.loads(data)  # noqa: S301  (packed by the process that asks)
    return work
