"""Chunks on processes of this machine, of which one may die."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from multiprocessing import resource_tracker
from typing import Any, TypeVar

from torsionnet.core.errors import SolveError
from torsionnet.core.threads import one_thread
from torsionnet.study.run.thread_pool import AHEAD

T = TypeVar("T")

DEATHS = 3
"""Of processes that had a chunk in hand, after which it is not tried again."""
ENVIRONMENT = {"MALLOC_TRIM_THRESHOLD_": str(2**30), "MALLOC_MMAP_THRESHOLD_": str(2**25)}
"""The C library keeps the memory of one chunk for the next."""

_work: Callable[[int], Any] | None = None


def _begin(work: Callable[[int], Any]) -> None:
    global _work  # noqa: PLW0603  (a process of a pool has what it is started with and nothing else)
    _work = work
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the process that started this one ends it
    threading.Thread(target=_end_with_parent, daemon=True).start()


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Ctrl-C waits; a process that is started meanwhile never hears of it, not even while it still imports."""
    if os.name == "nt":
        yield
        return
    resource_tracker.ensure_running()  # its own start lets interrupts through
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _end_with_parent() -> None:
    """A process that was killed ends none of those it has started."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _call(number: int) -> Any:
    if _work is None:
        raise RuntimeError("the process was not prepared")
    with one_thread():
        return _work(number)


@dataclass(frozen=True)
class ProcessExecutor:
    """Chunks on ``workers`` processes; those that a dying process had in hand are done again."""

    workers: int

    def map(self, work: Callable[[int], T], numbers: Iterable[int]) -> Iterator[tuple[int, T]]:
        """Number and result, as they are done.

        Raises
        ------
        SolveError
            Processes die of a chunk again and again.
        """
        left, again, deaths = iter(numbers), list[int](), Counter[int]()
        while True:
            with self._pool(work) as pool:
                waiting: dict[Future[T], int] = {}
                try:
                    while True:
                        room = AHEAD * self.workers - len(waiting)
                        for number in [*again[:room], *islice(left, max(0, room - len(again)))]:
                            with _uninterrupted():  # a process may be started here
                                waiting[pool.submit(_call, number)] = number
                        again = again[room:]
                        if not waiting:
                            return
                        for done in wait(waiting, return_when=FIRST_COMPLETED).done:
                            result = done.result()
                            yield waiting.pop(done), result
                except BrokenProcessPool:
                    again += waiting.values()
                    deaths.update(waiting.values())
                    self._give_up(deaths)

    def _give_up(self, deaths: Counter[int]) -> None:
        number, count = deaths.most_common(1)[0] if deaths else (0, 0)
        if count >= DEATHS:
            raise SolveError(
                f"{count} processes died while chunk {number} was in hand; see whether memory was short, and try with "
                "fewer workers; a script starts a study under if __name__ == '__main__':, as its processes read it "
                "too. What was calculated is kept: the study goes on from there when it is run again"
            )

    @contextmanager
    def _pool(self, work: Callable[[int], Any]) -> Iterator[ProcessPoolExecutor]:
        """Processes that are started afresh, on every system alike."""
        kept = {name: os.environ.get(name) for name in ENVIRONMENT}
        os.environ.update(ENVIRONMENT)
        context = multiprocessing.get_context("spawn")
        pool = ProcessPoolExecutor(self.workers, mp_context=context, initializer=_begin, initargs=(work,))
        try:
            yield pool
        finally:
            pool.shutdown(wait=True, cancel_futures=True)
            for name, value in kept.items():
                os.environ.pop(name, None) if value is None else os.environ.update({name: value})
