"""Executor that calculates a study on several processes of this machine, any of which may die."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice
from multiprocessing import resource_tracker
from typing import Any, TypeVar

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.base.threads import one_thread
from torsionnet.study.run.run_chunks import part_name

S = TypeVar("S")
T = TypeVar("T")


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
            raise UsageError(
                f"the study cannot be handed to other processes ({error}); {text}", kind="wrong-form"
            ) from None

    def __call__(self, part: Any) -> Any:
        return _unpacked(self.data)(part)


@lru_cache(maxsize=16)
def _unpacked(data: bytes) -> Callable[[Any], Any]:
    work: Callable[[Any], Any] = pickle.loads(data)  # noqa: S301  (packed by the process that asks)
    return work


QUEUED_PER_WORKER = 2
"""Chunks of variants that wait for each worker, enough that none is idle, few enough to be ended soon."""
MOST_DEATHS = 3
"""Number of processes that died on the same chunk after which the study stops, as a single death may be chance."""
ENVIRONMENT = {"MALLOC_TRIM_THRESHOLD_": str(2**30), "MALLOC_MMAP_THRESHOLD_": str(2**25)}
"""Environment variables of the workers with which the C library keeps the memory of one chunk for the next."""


def _begin() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the process that started this one ends it
    threading.Thread(target=_end_with_parent, daemon=True).start()


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Block Ctrl-C within ``with``, so that a process started meanwhile never receives it."""
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
    """End this process when its parent has ended, as a killed parent ends none of its processes."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _call(work: PackedWork, part: Any) -> Any:
    with one_thread():
        return work(part)


@dataclass(eq=False)
class ProcessExecutor:
    """Executor of a study on ``workers`` processes of this machine; parts of a process that died are done again.

    Within ``with`` the processes stay from one call of :meth:`map` to the next.
    """

    workers: int
    _pool: ProcessPoolExecutor | None = None
    _stays: bool = False

    def __enter__(self) -> ProcessExecutor:
        self._stays = True
        return self

    def __exit__(self, *_: object) -> None:
        self._stays = False
        self._end()

    def map(self, work: Callable[[S], T], parts: Iterable[S]) -> Iterator[tuple[S, T]]:
        """Yield each part of a study with its result, in the order in which they are done.

        Raises
        ------
        SolveError
            Processes die of a part again and again.
        """
        packed = PackedWork.of(work)
        left, again, deaths = iter(parts), list[S](), Counter[S]()
        try:
            while True:
                waiting: dict[Future[T], S] = {}
                try:
                    while True:
                        room = QUEUED_PER_WORKER * self.workers - len(waiting)
                        again += islice(left, max(0, room - len(again)))
                        for part in again[:room]:
                            waiting[self._submitted(packed, part)] = part
                            del again[0]
                        if not waiting:
                            return
                        for done in wait(waiting, return_when=FIRST_COMPLETED).done:
                            result = done.result()
                            yield waiting.pop(done), result
                except BrokenProcessPool:
                    # A worker that dies, as for want of memory, ends the pool: its parts are tried again in a new one.
                    again += waiting.values()
                    deaths.update(waiting.values())
                    self._end()
                    self._give_up(deaths)
                finally:
                    for future in waiting:
                        future.cancel()
        finally:
            if not self._stays:
                self._end()

    def _give_up(self, deaths: Counter[S]) -> None:
        part, count = deaths.most_common(1)[0] if deaths else (0, 0)
        if count >= MOST_DEATHS:
            raise SolveError(
                f"{count} processes died while {part_name(part)} was in hand; see whether memory was short, and try "
                "with fewer workers; a script starts a study under if __name__ == '__main__':, as its processes read "
                "it too. What was calculated is kept: the study goes on from there when it is run again",
                kind="failed-program",
            )

    def _submitted(self, packed: PackedWork, part: S) -> Future[Any]:
        """Submit a part of a study to the pool, which starts its processes by spawning on every system alike."""
        if self._pool is None:
            context = multiprocessing.get_context("spawn")
            self._pool = ProcessPoolExecutor(self.workers, mp_context=context, initializer=_begin)
        with _surroundings(), _uninterrupted():
            return self._pool.submit(_call, packed, part)

    def _end(self) -> None:
        if self._pool is not None:
            self._pool.shutdown(wait=True, cancel_futures=True)
            self._pool = None


@contextmanager
def _surroundings() -> Iterator[None]:
    """Set the environment variables of the workers within ``with``, while processes are started."""
    kept = {name: os.environ.get(name) for name in ENVIRONMENT}
    os.environ.update(ENVIRONMENT)
    try:
        yield
    finally:
        for name, value in kept.items():
            os.environ.pop(name, None) if value is None else os.environ.update({name: value})
