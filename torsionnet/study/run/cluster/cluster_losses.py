"""What can be lost while a cluster calculates, in words of a study."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from torsionnet.core.errors import TorsionnetError
from torsionnet.study.run.executor import named

if TYPE_CHECKING:
    from distributed import Client, Future


class ClusterError(TorsionnetError):
    """The cluster is lost, or its workers cannot do the work; what they had finished is kept."""

    exit_code = 3


KEPT = "what was calculated is kept, and the study goes on from there when it is run again"


@contextmanager
def scheduler_expected(client: Client) -> Iterator[None]:
    """Say it if the scheduler is lost."""
    from distributed import CancelledError
    from distributed.comm import CommClosedError

    try:
        yield
    except TorsionnetError:
        raise
    except Exception as error:
        if client.status == "running" and not isinstance(error, CancelledError | CommClosedError | TimeoutError):
            raise
        raise ClusterError(f"the connection to the scheduler is lost; {KEPT}") from error


@contextmanager
def workers_expected(parts: Sequence[object]) -> Iterator[None]:
    """Say it if workers die of these chunks."""
    from distributed import KilledWorker

    first, last = parts[0], parts[-1]
    chunks = named(first) if first == last or not isinstance(first, int) else f"chunks {first} to {last}"
    try:
        yield
    except KilledWorker as error:
        raise ClusterError(
            f"{error.allowed_failures + 1} workers died, one after the other, on {chunks}, the last of them "
            f"{error.last_worker.address}; see in their logs whether memory was short; {KEPT}"
        ) from error
    except MemoryError as error:
        raise ClusterError(f"a worker's memory does not suffice for {chunks}; {KEPT}") from error


def let_go(client: Client, tasks: Iterable[Future]) -> None:
    """Tasks that nobody waits for any more."""
    if client.status == "running":
        with suppress(OSError):
            client.cancel(list(tasks))


LOOK_EVERY, SAID_FIRST = 2.0, 10.0
"""Seconds after which it is asked again, and from one word to the next: twice as long each time."""

Told = Callable[[str], None]


@dataclass
class Absence:
    """Tells that a cluster has no workers: at once, and again from time to time for how long.

    Attributes
    ----------
    told : callable
    clock : callable
        In seconds.

    Examples
    --------
    >>> seconds = iter([0.0, 12.0])
    >>> absence = Absence(print, clock=lambda: next(seconds))
    >>> for threads in (4, 0, 0, 4):
    ...     absence.seen(threads, left=3)
    the scheduler has no workers now, 3 chunks left; waiting for some to join (dask worker ADDRESS)
    no workers now for 12 s, 3 chunks left
    """

    told: Told
    clock: Callable[[], float] = time.monotonic
    _began: float | None = None
    _every: float = 0.0

    def seen(self, threads: int, left: int | None = None) -> None:
        """How many threads there are now, and chunks left to calculate where some were calculated before."""
        if threads:
            self._began = None
            return
        when = "yet" if left is None else f"now, {_chunks(left)} left"
        if self._began is None:
            self._began, self._every = self.clock(), SAID_FIRST
            self.told(f"the scheduler has no workers {when}; waiting for some to join (dask worker ADDRESS)")
        elif (waited := self.clock() - self._began) >= self._every:
            when = f"yet for {waited:.0f} s" if left is None else f"now for {waited:.0f} s, {_chunks(left)} left"
            self.told(f"no workers {when}")
            self._every *= 2


def _chunks(count: int) -> str:
    return "1 chunk" if count == 1 else f"{count} chunks"


def await_workers(
    threads: Callable[[], int],
    told: Told,
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> int:
    """Threads of all workers, as soon as there are some.

    Parameters
    ----------
    threads : callable
        Those there are now.
    told : callable
        Is told at once that there are none yet, and again from time to time for how long.
    clock, sleep : callable
        In seconds.

    Examples
    --------
    >>> there = iter([0, 0, 8])
    >>> await_workers(lambda: next(there), print, clock=lambda: 0.0, sleep=lambda _: None)
    the scheduler has no workers yet; waiting for some to join (dask worker ADDRESS)
    8
    """
    absence = Absence(told, clock)
    while not (found := threads()):
        absence.seen(found)
        sleep(LOOK_EVERY)
    return found
