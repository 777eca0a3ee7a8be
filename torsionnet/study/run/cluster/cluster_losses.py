"""Errors and messages where a cluster loses its scheduler or workers while a study is calculated."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from torsionnet.base.errors import TorsionnetError
from torsionnet.study.run.executor import part_name

if TYPE_CHECKING:
    from distributed import Client, Future


class ClusterError(TorsionnetError):
    """Error of a cluster that was lost, or whose workers cannot do the work; finished chunks are kept."""

    exit_code = 3


KEPT = "what was calculated is kept, and the study goes on from there when it is run again"


@contextmanager
def scheduler_errors(client: Client) -> Iterator[None]:
    """Turn errors of a cluster's lost scheduler within ``with`` into ClusterError."""
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
def worker_errors(parts: Sequence[object]) -> Iterator[None]:
    """Turn the deaths of workers on these chunks within ``with`` into ClusterError."""
    from distributed import KilledWorker

    first, last = parts[0], parts[-1]
    chunks = part_name(first) if first == last or not isinstance(first, int) else f"chunks {first} to {last}"
    try:
        yield
    except KilledWorker as error:
        raise ClusterError(
            f"{error.allowed_failures + 1} workers died, one after the other, on {chunks}, the last of them "
            f"{error.last_worker.address}; see in their logs whether memory was short; {KEPT}"
        ) from error
    except MemoryError as error:
        raise ClusterError(f"a worker's memory does not suffice for {chunks}; {KEPT}") from error


def cancel_tasks(client: Client, tasks: Iterable[Future]) -> None:
    """Cancel tasks of the cluster whose results are not needed any more."""
    if client.status == "running":
        with suppress(OSError):
            client.cancel(list(tasks))


LOOK_EVERY, SAID_FIRST = 2.0, 10.0
"""Seconds from one look for workers to the next, and from the first message of their absence to the second.

Later ones take twice as long each.
"""

Notify = Callable[[str], None]


@dataclass
class WorkerAbsence:
    """Messages while a cluster has no workers, at once, and again from time to time with the time waited.

    Attributes
    ----------
    notify : callable
    clock : callable
        In seconds.

    Examples
    --------
    >>> seconds = iter([0.0, 12.0])
    >>> absence = WorkerAbsence(print, clock=lambda: next(seconds))
    >>> for threads in (4, 0, 0, 4):
    ...     absence.update(threads, left=3)
    the scheduler has no workers now, 3 chunks left; waiting for some to join (dask worker ADDRESS)
    no workers now for 12 s, 3 chunks left
    """

    notify: Notify
    clock: Callable[[], float] = time.monotonic
    _began: float | None = None
    _every: float = 0.0

    def update(self, threads: int, left: int | None = None) -> None:
        """Take note of the workers' number of threads now, and of the chunks left where some were calculated before."""
        if threads:
            self._began = None
            return
        when = "yet" if left is None else f"now, {_chunks(left)} left"
        if self._began is None:
            self._began, self._every = self.clock(), SAID_FIRST
            self.notify(f"the scheduler has no workers {when}; waiting for some to join (dask worker ADDRESS)")
        elif (waited := self.clock() - self._began) >= self._every:
            when = f"yet for {waited:.0f} s" if left is None else f"now for {waited:.0f} s, {_chunks(left)} left"
            self.notify(f"no workers {when}")
            self._every *= 2


def _chunks(count: int) -> str:
    return "1 chunk" if count == 1 else f"{count} chunks"


def await_workers(
    threads: Callable[[], int],
    notify: Notify,
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> int:
    """Wait for the first worker of a cluster and return the number of threads of all workers.

    Parameters
    ----------
    threads : callable
        Returns the number of threads now.
    notify : callable
        Called with a message at once where there are none, and again from time to time.
    clock, sleep : callable
        In seconds.

    Examples
    --------
    >>> there = iter([0, 0, 8])
    >>> await_workers(lambda: next(there), print, clock=lambda: 0.0, sleep=lambda _: None)
    the scheduler has no workers yet; waiting for some to join (dask worker ADDRESS)
    8
    """
    absence = WorkerAbsence(notify, clock)
    while not (found := threads()):
        absence.update(found)
        sleep(LOOK_EVERY)
    return found
