"""Task of a cluster's worker, which calculates some chunks of a study, one after the other."""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from time import perf_counter
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from torsionnet.base.errors import TorsionnetError
from torsionnet.base.threads import one_thread
from torsionnet.study.run.run_chunks import part_name

if TYPE_CHECKING:
    from distributed import Client, Future


# Errors and messages where a cluster loses its scheduler or workers while a study is calculated.


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
        raise ClusterError(f"the connection to the scheduler is lost; {KEPT}", kind="failed-program") from error


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
            f"{error.last_worker.address}; see in their logs whether memory was short; {KEPT}",
            kind="failed-program",
        ) from error
    except MemoryError as error:
        raise ClusterError(f"a worker's memory does not suffice for {chunks}; {KEPT}", kind="failed-program") from error


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
    while not (count := threads()):
        absence.update(count)
        sleep(LOOK_EVERY)
    return count


PACKAGES = ("torsionnet", "numpy", "scipy", "numba")
"""Packages of a worker whose version may change a number, as without numba another solver is used."""

MOST_LISTED_FAULTS = 10
"""Most faults of workers that a message lists, as of a thousand workers with the same fault a few suffice."""

Versions = Mapping[str, str]


def check_versions(client: Client) -> Versions:
    """Versions of Python and packages in this process, after all workers were found to have the same.

    ClusterError where one has others.
    """
    versions = client.get_versions(packages=list(PACKAGES))
    needed = _of_process(versions["client"])
    workers = {address: _of_process(reported) for address, reported in versions["workers"].items()}
    faults = [line for address, has in workers.items() for line in differences(address, has, needed)]
    machines = {has["machine"]: address for address, has in workers.items()}
    if len(machines) > 1:
        reported = ", ".join(f"{address} is {machine}" for machine, address in machines.items())
        faults.append(f"workers are of different kinds of machines, whose last digits differ: {reported}")
    refuse_faults(faults, "Install the same on all workers, start them anew and run the study again")
    return needed


def own_versions() -> Versions:
    """Versions of Python and of the packages in this process, by name."""
    from distributed.versions import get_versions

    return _of_process(get_versions(packages=PACKAGES))


def differences(worker: str, has: Versions, needed: Versions) -> Iterator[str]:
    """Yield sentences on the versions in which a worker differs from those needed.

    >>> list(differences("tcp://n7:9", {"numpy": "2.1"}, {"numpy": "2.2"}))
    ['worker tcp://n7:9 has numpy 2.1, this process has numpy 2.2']
    """
    for name in ("Python", *PACKAGES):
        if has.get(name) != needed.get(name):
            theirs, ours = (f"{name} {side[name]}" if side.get(name) else f"no {name}" for side in (has, needed))
            yield f"worker {worker} has {theirs}, this process has {ours}"


def refuse_faults(faults: list[str], remedy: str) -> None:
    """Raise ClusterError with the faults of workers and the remedy, if there is a fault."""
    if faults:
        shown = "\n".join(faults[:MOST_LISTED_FAULTS])
        if len(faults) > MOST_LISTED_FAULTS:
            shown += f"\n... and {len(faults) - MOST_LISTED_FAULTS} more"
        raise ClusterError(f"{shown}\n{remedy}; what was calculated before is kept.", kind="failed-program")


def _of_process(reported: Mapping[str, Any]) -> Versions:
    packages, host = reported["packages"], reported["host"]
    python = ".".join(str(host["python"]).split(".")[:2])
    return {"Python": python, "machine": str(host["machine"]), **{name: packages[name] or "" for name in PACKAGES}}


S = TypeVar("S")
T = TypeVar("T")


@dataclass(frozen=True)
class DoneChunk(Generic[T]):
    """Report of a worker on a chunk of variants that is done; the values of the chunk are in the shared folder.

    Attributes
    ----------
    result : object
        Return value of the work, small.
    seconds : float
        Wall-clock time.
    """

    result: T
    seconds: float


def done_chunks(work: Callable[[S], T], parts: Sequence[S], needed: Versions) -> list[DoneChunk[T]]:
    """Reports on some chunks of variants, calculated in this worker, which must have the versions ``needed``."""
    _check(tuple(sorted(needed.items())))
    done: list[DoneChunk[T]] = []
    with one_thread():
        for part in parts:
            began = perf_counter()
            result = work(part)
            done.append(DoneChunk(result, perf_counter() - began))
    return done


@cache
def _check(needed: tuple[tuple[str, str], ...]) -> None:
    """Refuse versions other than those needed in this worker, which may have joined while the study runs."""
    has = own_versions()
    faults = list(differences(f"process {os.getpid()} of {platform.node()}", has, dict(needed)))
    refuse_faults(faults, "Install the same on all workers, start them anew and run the study again")
