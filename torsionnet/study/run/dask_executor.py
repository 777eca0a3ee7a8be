"""Clusters of dask: executor that calculates chunks of a study on their workers, and the connection to them."""

from __future__ import annotations

import asyncio
import json
import logging
import os
import re
import uuid
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from math import ceil
from pathlib import Path
from statistics import median
from time import monotonic
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from torsionnet.base.errors import MissingExtraError, UsageError
from torsionnet.study.run.chunk_task import (
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
from torsionnet.study.run.process_pool import ENVIRONMENT, PackedWork

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
        Client of :func:`torsionnet.study.run.dask_executor.connected`.
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
            raise UsageError(
                "on a cluster a study needs a folder for its results, which all workers share", kind="missing-entry"
            )
        with scheduler_errors(self.client):
            await_workers(lambda: sum(self.client.nthreads().values()), self.notify)
            needed = self._versions
        running: _Running[S] = _Running(self.client, self.folder.name, needed, WorkerAbsence(self.notify))
        yield from running.results(PackedWork.of(work), deque(parts))

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
                    done = self._finished_parts()
                self.size.learn(chunk.seconds for _, chunk in done)
                yield from ((part, chunk.result) for part, chunk in done)
        finally:
            cancel_tasks(self.client, self.tasks)

    def _submit(self, work: Callable[[S], T], left: deque[S]) -> None:
        bound = (1 + TASKS_AHEAD) * max(self._threads(), 1)
        while left and len(self.tasks) < bound:
            parts = tuple(left.popleft() for _ in range(self.size.chunks(len(left), self.threads)))
            key = (self.key, self.submitted)
            self.submitted += 1
            asked = (work, parts, self.needed)
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

    def _finished_parts(self) -> list[tuple[S, DoneChunk[Any]]]:
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
        return list(zip(parts, (chunk for done in results for chunk in done), strict=True))


# Connection to a cluster by its address or a scheduler file, or to workers started on this machine.


def require_scheduler(address: str, patience: float) -> None:
    """Refuse an address at which no scheduler of a cluster answers within ``patience`` seconds."""
    from distributed.utils import LoopRunner

    runner = LoopRunner(asynchronous=False)
    runner.start()
    try:
        answer = runner.run_sync(_identity, address, patience)
    except (OSError, TimeoutError) as error:
        raise UsageError(
            f"no scheduler answers at {address} within {patience:g} s; see that it runs (dask scheduler), that address "
            f"and port are those it prints, and that no firewall is between ({_first_line(error)})",
            kind="failed-program",
        ) from None
    except ValueError as error:
        raise UsageError(
            f"{address} is no address of a scheduler, as tcp://host:8786 is ({_first_line(error)})", kind="wrong-form"
        ) from None
    except (TypeError, ImportError, MemoryError, AttributeError) as error:
        raise UsageError(
            f"what answers at {address} is no scheduler of dask, or one of another version ({_first_line(error)})",
            kind="failed-program",
        ) from None
    finally:
        runner.stop()
    if answer.get("type") != "Scheduler":
        what = str(answer.get("type", "something else")).lower()
        raise UsageError(f"{address} is the address of a {what}; give that of the scheduler", kind="wrong-form")


async def _identity(address: str, patience: float) -> dict[str, Any]:
    from distributed.core import rpc
    from distributed.security import Security

    async with rpc(address, timeout=patience, connection_args=Security().get_connection_args("client")) as scheduler:
        return dict(await asyncio.wait_for(scheduler.identity(), patience + 1))


def _first_line(error: BaseException) -> str:
    return next(iter(str(error).splitlines()), type(error).__name__)


SURROUNDINGS = {
    **ENVIRONMENT,
    "OMP_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
}
"""Environment variables of the workers, by which memory of one chunk is kept for the next, and BLAS has one thread.

By dask's own setting every array above 64 KiB goes back to the system when it is let go, and fetching it again costs
more than what is calculated with it.
"""

SETTINGS = {
    "distributed.nanny.pre-spawn-environ": SURROUNDINGS,
    "distributed.worker.profile.enabled": False,  # it looks at every thread a hundred times a second
}


@contextmanager
def local_workers(count: int | None = None) -> Iterator[str]:
    """Start ``count`` workers of one thread each, by default one for each core, and yield their scheduler's address.

    One for each core) and yield their scheduler's address.

    A worker that dies is replaced. Workers end with this process, however it ends.
    """
    import dask
    from distributed import LocalCluster

    cores = os.cpu_count() or 1
    if count == 0:
        raise UsageError("a cluster of local:0 has no workers; give local:1 or more", kind="out-of-range")
    kept = {name: os.environ.get(name) for name in SURROUNDINGS}
    try:
        with (
            dask.config.set(SETTINGS),
            LocalCluster(
                n_workers=cores if count is None else count,
                threads_per_worker=1,
                processes=True,
                dashboard_address=":0",
                silence_logs=logging.ERROR,
            ) as cluster,
        ):
            yield str(cluster.scheduler_address)
    finally:
        for name, value in kept.items():  # dask sets them in this process too
            os.environ.pop(name, None) if value is None else os.environ.update({name: value})


ADDRESS_FORMS = (
    "tcp://host:port (the address a scheduler prints), the path of a scheduler file ending in .json, or local:N for N "
    "processes of this machine"
)
LOCAL = re.compile(r"local(?::(\d+))?")
ANSWER_SECONDS = 10.0
"""Longest time in seconds for the answer of a cluster's scheduler, as one on a busy network takes a few."""


@contextmanager
def connected(where: str, patience: float = ANSWER_SECONDS) -> Iterator[Client]:
    """Connect to a cluster and yield its client.

    Parameters
    ----------
    where : str
        ``tcp://host:port``, a scheduler file (``.json``), or ``local:N``.
    patience : float
        Seconds to wait for an answer.

    Raises
    ------
    UsageError
        There is no such cluster.

    Examples
    --------
    >>> with connected("cluster.yaml"):  # doctest: +ELLIPSIS
    ...     pass
    Traceback (most recent call last):
    ...
    torsionnet.base.errors.UsageError: "cluster.yaml" is no cluster; give tcp://host:port ...
    """
    local = LOCAL.fullmatch(where)
    if local is None and "://" not in where and not where.endswith(".json"):
        raise UsageError(f'"{where}" is no cluster; give {ADDRESS_FORMS}', kind="wrong-form")
    _needs_distributed()
    if local is not None:
        with (
            local_workers(None if local[1] is None else int(local[1])) as address,
            _client(address, patience) as client,
        ):
            yield client
    else:
        address = where if "://" in where else _address_in(Path(where))
        with _client(address, patience) as client:
            yield client


def _needs_distributed() -> None:
    try:
        import distributed  # noqa: F401
    except ImportError as error:
        raise MissingExtraError('a cluster needs dask.distributed: pip install "torsionnet[cluster]"') from error


def _address_in(file: Path) -> str:
    """Address of the scheduler in a scheduler file, which ``dask scheduler --scheduler-file`` writes."""
    try:
        address = json.loads(file.read_text(encoding="utf-8"))["address"]
    except FileNotFoundError:
        raise UsageError(
            f"there is no scheduler file {file}; the scheduler writes it when it starts (dask scheduler "
            f"--scheduler-file {file}), into a folder that this machine sees too",
            kind="missing-file",
        ) from None
    except OSError as error:
        raise UsageError(
            f"the scheduler file {file} cannot be read: {error.strerror}", kind="unreadable-file"
        ) from None
    except (ValueError, KeyError, TypeError):
        raise UsageError(
            f"{file} is no scheduler file; it has no address of a scheduler in it", kind="wrong-file"
        ) from None
    return str(address)


@contextmanager
def _client(address: str, patience: float) -> Iterator[Client]:
    from distributed import Client

    require_scheduler(address, patience)
    with _quiet():
        client = Client(address, timeout=patience, set_as_default=False)
    try:
        yield client
    finally:
        with _quiet():
            client.close()


@contextmanager
def _quiet() -> Iterator[None]:
    """Silence messages of dask on versions and lost connections, which a study reports as errors itself."""
    from distributed.versions import VersionMismatchWarning

    logger = logging.getLogger("distributed.client")
    level = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", VersionMismatchWarning)
            yield
    finally:
        logger.setLevel(level)
