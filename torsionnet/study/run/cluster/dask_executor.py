"""Executor that calculates chunks of a study on the workers of a cluster."""

from __future__ import annotations

import uuid
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from math import ceil
from pathlib import Path
from statistics import median
from time import monotonic
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from torsionnet.base.errors import UsageError
from torsionnet.study.run.cluster.chunk_task import (
    DoneChunk,
    Notify,
    Versions,
    WorkerAbsence,
    await_workers,
    cancel_tasks,
    check_versions,
    done_chunks,
    refuse_faults,
    scheduler_errors,
    worker_errors,
)

if TYPE_CHECKING:
    from distributed import Client, Future


def check_folder(client: Client, folder: Path) -> None:
    """Refuse a cluster with a worker that cannot read and write in ``folder``."""
    word = uuid.uuid4().hex
    token = folder.resolve() / f".seen_by_workers_{word}"
    token.write_text(word)
    try:
        said = client.run(folder_fault, str(token), word, on_error="return")
    finally:
        token.unlink()
    refuse_faults(
        [f"worker {address}: {trouble}" for address, trouble in said.items() if trouble],
        f"All workers need {token.parent} under this path, as a folder of a file system that they share",
    )


def folder_fault(token: str, word: str) -> str:
    """Message of why this worker cannot use the folder in which another process wrote ``word``, empty if it can."""
    file = Path(token)
    try:
        if file.read_text(encoding="utf-8") != word:
            return f"{file.parent} is another folder there"
        beside = file.with_name(f"{file.name}_{uuid.uuid4().hex}")
        beside.touch()
        beside.unlink()
    except FileNotFoundError:
        return f"{file.parent} is not there, or is another folder"
    except OSError as error:
        return f"{file.parent} cannot be used: {error.strerror}"
    return ""


TASK_SECONDS = 2.0
"""Shortest time of a worker's task in seconds, as the overhead of each task is some milliseconds."""

TASKS_A_SECOND = 50.0
"""Most tasks in a second of all workers together, as a scheduler and a client manage some hundred."""


@dataclass
class TaskSize:
    """Number of chunks of variants in a worker's task, by the time that the last chunks took.

    Examples
    --------
    >>> size = TaskSize()
    >>> size.chunks(left=1000, workers=2)
    1
    >>> size.learn([0.5, 0.5, 0.5])
    >>> size.chunks(left=1000, workers=2), size.chunks(left=4, workers=2)
    (4, 2)
    >>> size.chunks(left=10**6, workers=1000)
    40
    """

    seconds: deque[float] = field(default_factory=lambda: deque(maxlen=50))

    def learn(self, seconds: Iterable[float]) -> None:
        """Take note of the wall-clock times in seconds of finished chunks of variants."""
        self.seconds.extend(seconds)

    def chunks(self, left: int, workers: int) -> int:
        """Number of chunks in a worker's next task.

        Fewer towards the end, so that no worker idles while another has many.
        """
        if not self.seconds:
            return 1
        wanted = ceil(max(TASK_SECONDS, workers / TASKS_A_SECOND) / max(median(self.seconds), 1e-6))
        return max(1, min(wanted, ceil(left / max(workers, 1))))


S = TypeVar("S")
T = TypeVar("T")

TASKS_AHEAD = 2
"""Tasks queued for each thread of a worker beside the one it calculates, so that it never waits for this process."""

TASK_RETRIES = 2
"""Times that a failed task of a worker is tried again, as a shared file system may fail for a moment."""

LOOK_EVERY, PAUSE = 2.0, 0.1
"""Seconds from one look for workers to the next, and from one look for finished tasks to the next."""


@dataclass(frozen=True, eq=False)
class DaskExecutor:
    """Executor on the workers of a cluster, which write the values into a folder that all of them share.

    A bounded number of tasks is with the scheduler at a time; a worker that is lost has its tasks done by others, and
    workers that join are used. ``work`` keeps what it calculates in the ``folder`` and returns next to nothing.

    Attributes
    ----------
    client : Client
        Client of :func:`torsionnet.study.run.cluster.connecting.connected`.
    folder : Path
        Folder of the study.
    notify : callable
        Called with a message when there are no workers yet, or none any more.
    """

    client: Client
    folder: Path
    notify: Notify = lambda _text: None

    def map(self, work: Callable[[S], T], parts: Iterable[S]) -> Iterator[tuple[S, T]]:
        """Yield each part of a study with its result, in the order in which they are done.

        Raises
        ------
        UsageError
            The work has no folder: its results would pass through the scheduler, and end with it.
        ClusterError
            The scheduler is lost, or workers cannot do the work.
        """
        if getattr(work, "folder", self.folder) is None:
            raise UsageError("on a cluster a study needs a folder for its results, which all workers share")
        with scheduler_errors(self.client):
            await_workers(lambda: sum(self.client.nthreads().values()), self.notify)
            needed = self._versions
        running: _Running[S] = _Running(self.client, self.folder.name, needed, WorkerAbsence(self.notify))
        yield from running.results(work, deque(parts))

    @cached_property
    def _versions(self) -> Versions:
        """Versions of Python and packages that all workers have, checked once together with access to the folder."""
        needed = check_versions(self.client)
        check_folder(self.client, self.folder)
        return needed


class _Running(Generic[S]):
    """Tasks submitted to the cluster's scheduler and not finished yet."""

    def __init__(self, client: Client, name: str, needed: Versions, absence: WorkerAbsence) -> None:
        from distributed import as_completed

        self.client, self.needed, self.absence = client, needed, absence
        self.key = f"{name}-{uuid.uuid4().hex}"
        self.tasks: dict[Future, tuple[S, ...]] = {}
        self.finished = as_completed(loop=client.loop)
        self.size = TaskSize()
        self.threads, self.looked, self.submitted = 0, -1e9, 0

    def results(self, work: Callable[[S], T], left: deque[S]) -> Iterator[tuple[S, T]]:
        try:
            while left or self.tasks:
                with scheduler_errors(self.client):
                    self._submit(work, left)
                    self._await(len(left))
                    done = self._next()
                self.size.learn(one.seconds for _, one in done)
                yield from ((part, one.result) for part, one in done)
        finally:
            cancel_tasks(self.client, self.tasks)

    def _submit(self, work: Callable[[S], T], left: deque[S]) -> None:
        bound = (1 + TASKS_AHEAD) * max(self._threads(), 1)
        while left and len(self.tasks) < bound:
            parts = tuple(left.popleft() for _ in range(self.size.chunks(len(left), self.threads)))
            key = (self.key, self.submitted)
            self.submitted += 1
            asked = (work, self.key, parts, self.needed)
            task = self.client.submit(done_chunks, *asked, key=key, pure=False, retries=TASK_RETRIES)
            self.tasks[task] = parts
            self.finished.add(task)

    def _threads(self) -> int:
        """Number of threads of all workers of the cluster, asked for every few seconds."""
        if monotonic() > self.looked + LOOK_EVERY:
            self.threads, self.looked = sum(self.client.nthreads().values()), monotonic()
        return self.threads

    def _await(self, later: int) -> None:
        """Wait until a task of the cluster is finished, with messages where no worker is left."""
        while not self.finished.has_ready():
            with self.finished.thread_condition:
                self.finished.thread_condition.wait(PAUSE)
            if not self.finished.has_ready():
                self.absence.update(self._threads(), later + sum(map(len, self.tasks.values())))

    def _next(self) -> list[tuple[S, DoneChunk[Any]]]:
        """Parts of the study and the workers' reports on them, of the tasks that finished since the last call."""
        ended = self.finished.next_batch(block=True)
        # What was not fetched is lost with its worker, and is waited for like what was in hand there.
        for task in [task for task in ended if task.status == "lost"]:
            self.finished.add(task)
            ended.remove(task)
        for task in ended:
            if task.status != "finished":
                with worker_errors(self.tasks[task]):
                    task.result()
        # All together: one by one each would take the time of a round to its worker.
        results: list[list[DoneChunk[Any]]] = self.client.gather(ended)
        parts = [part for task in ended for part in self.tasks.pop(task)]
        return list(zip(parts, (one for done in results for one in done), strict=True))
