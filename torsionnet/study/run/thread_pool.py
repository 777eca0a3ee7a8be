"""Chunks on threads: the compiled solver lets other threads run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from itertools import islice
from typing import TypeVar

S = TypeVar("S")
T = TypeVar("T")

AHEAD = 2
"""Chunks that wait for each worker: enough that none is idle, few enough to be ended soon."""


@dataclass(frozen=True)
class ThreadExecutor:
    """Chunks on ``workers`` threads of this process.

    Examples
    --------
    >>> sorted(ThreadExecutor(2).map(abs, [-1, 2]))
    [(-1, 1), (2, 2)]
    """

    workers: int

    def map(self, work: Callable[[S], T], parts: Iterable[S]) -> Iterator[tuple[S, T]]:
        """Part and result, as they are done."""
        left = iter(parts)
        with ThreadPoolExecutor(self.workers) as pool:
            waiting: dict[Future[T], S] = {}
            try:
                while True:
                    for part in islice(left, AHEAD * self.workers - len(waiting)):
                        waiting[pool.submit(work, part)] = part
                    if not waiting:
                        return
                    for done in wait(waiting, return_when=FIRST_COMPLETED).done:
                        yield waiting.pop(done), done.result()
            finally:
                pool.shutdown(wait=True, cancel_futures=True)
