"""Chunks of a study on the workers of a cluster."""

from __future__ import annotations

import uuid
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any, TypeVar

from torsionnet.core.errors import UsageError
from torsionnet.study.cluster.chunk_task import DoneChunk, done_chunks
from torsionnet.study.cluster.cluster_losses import let_go, scheduler_expected, workers_expected
from torsionnet.study.cluster.shared_folder import check_folder
from torsionnet.study.cluster.task_size import TaskSize
from torsionnet.study.cluster.worker_versions import Versions, check_versions

if TYPE_CHECKING:
    from distributed import Client, Future

T = TypeVar("T")

TASKS_AHEAD = 2
"""Tasks that wait for each thread of a worker beside the one it calculates, so that it never waits for this process."""

TRIES = 2
"""Of a task again, whose file system failed for a moment."""

LOOK_EVERY = 2.0
"""Seconds after which it is asked which workers there are."""


@dataclass(frozen=True, eq=False)
class DaskExecutor:
    """Work on numbered chunks by the workers of ``client``, which leave the values in a folder that all see.

    A bounded number of tasks is with the scheduler at a time; a worker that is lost has its tasks done by others, and
    workers that join are used. ``work`` keeps what it calculates in the ``folder`` and returns next to nothing.

    Attributes
    ----------
    client : Client
        Of :func:`torsionnet.study.cluster.connecting.connected`.
    folder : Path
        Of the study.
    """

    client: Client
    folder: Path

    def map(self, work: Callable[[int], T], numbers: Iterable[int]) -> Iterator[tuple[int, T]]:
        """Number and result of every chunk, in the order in which they are done.

        Raises
        ------
        UsageError
            The work has no folder: its results would pass through the scheduler, and end with it.
        ClusterError
            The scheduler is lost, or workers cannot do the work.
        """
        if getattr(work, "folder", self.folder) is None:
            raise UsageError("on a cluster a study needs a folder for its results, which all workers share")
        with scheduler_expected(self.client):
            needed = check_versions(self.client)
            check_folder(self.client, self.folder)
        yield from _Running(self.client, self.folder.name, needed).results(work, deque(numbers))


class _Running:
    """The tasks that are with the scheduler."""

    def __init__(self, client: Client, name: str, needed: Versions) -> None:
        from distributed import as_completed

        self.client, self.needed = client, needed
        self.key = f"{name}-{uuid.uuid4().hex}"
        self.tasks: dict[Future, tuple[int, ...]] = {}
        self.finished = as_completed(loop=client.loop)
        self.size = TaskSize()
        self.threads, self.looked = 0, -1e9

    def results(self, work: Callable[[int], T], left: deque[int]) -> Iterator[tuple[int, T]]:
        try:
            while left or self.tasks:
                with scheduler_expected(self.client):
                    self._submit(work, left)
                    done = self._next()
                self.size.learn(one.seconds for one in done)
                yield from ((one.number, one.result) for one in done)
        finally:
            let_go(self.client, self.tasks)

    def _submit(self, work: Callable[[int], T], left: deque[int]) -> None:
        bound = (1 + TASKS_AHEAD) * max(self._threads(), 1)
        while left and len(self.tasks) < bound:
            numbers = tuple(left.popleft() for _ in range(self.size.chunks(len(left), self.threads)))
            key = (self.key, numbers[0])
            asked = (work, self.key, numbers, self.needed)
            task = self.client.submit(done_chunks, *asked, key=key, pure=False, retries=TRIES)
            self.tasks[task] = numbers
            self.finished.add(task)

    def _threads(self) -> int:
        """Of all workers there are now."""
        if monotonic() > self.looked + LOOK_EVERY:
            self.threads, self.looked = sum(self.client.nthreads().values()), monotonic()
        return self.threads

    def _next(self) -> list[DoneChunk[Any]]:
        """What has been done since this was asked before, waiting until something is."""
        ended = self.finished.next_batch(block=True)
        for task in ended:
            if task.status != "finished":
                with workers_expected(self.tasks[task]):
                    task.result()
        # All together: one by one each would take the time of a round to its worker.
        results: list[list[DoneChunk[Any]]] = self.client.gather(ended)
        for task in ended:
            del self.tasks[task]
        return [one for done in results for one in done]
