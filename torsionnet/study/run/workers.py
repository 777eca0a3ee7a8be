"""Who calculates a study, as it is asked for."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from torsionnet.core.errors import UsageError
from torsionnet.study.run.executor import Executor, SerialExecutor
from torsionnet.study.run.process_pool import ProcessExecutor
from torsionnet.study.run.thread_pool import ThreadExecutor

MOST_ON_WINDOWS = 61


@dataclass(frozen=True)
class Workers:
    """So many processes or threads of this machine, or a cluster.

    Attributes
    ----------
    processes, threads : int
        One of them; 1 and 0 for neither.
    cluster : str
        Instead: ``tcp://host:port``, a scheduler file, or ``local:N``.
    announce : callable or None
        Is told where the dashboard of a cluster is.
    waiting : callable
        Is told that a cluster has no workers yet, or none any more, and for how long.
    """

    processes: int = 1
    threads: int = 0
    cluster: str = ""
    announce: Callable[[str], None] | None = None
    waiting: Callable[[str], None] = lambda _text: None

    def __post_init__(self) -> None:
        if self.processes < 1 or self.threads < 0:
            raise UsageError("a study needs one worker at least")
        if os.name == "nt" and self.processes > MOST_ON_WINDOWS:
            raise UsageError(f"Windows lets a program wait for {MOST_ON_WINDOWS} processes at most; give fewer workers")
        if sum([self.processes > 1, self.threads > 1, bool(self.cluster)]) > 1:
            raise UsageError("workers are processes, threads, or those of a cluster: give one of them")

    @property
    def count(self) -> int:
        """Of this machine."""
        return max(self.processes, self.threads)

    @contextmanager
    def executor(self, folder: Path | None) -> Iterator[Executor]:
        """What does the work as long as it is needed."""
        if self.cluster:
            with self._of_cluster(folder) as found:
                yield found
        elif self.processes > 1:
            with ProcessExecutor(self.processes) as pool:
                yield pool
        else:
            yield ThreadExecutor(self.threads) if self.threads > 1 else SerialExecutor()

    @contextmanager
    def _of_cluster(self, folder: Path | None) -> Iterator[Executor]:
        from torsionnet.study.cluster.connecting import connected
        from torsionnet.study.cluster.dask_executor import DaskExecutor

        if folder is None:
            raise UsageError("a study on a cluster needs a folder that all its workers see: -o FOLDER")
        with connected(self.cluster) as client:
            if self.announce is not None:
                self.announce(str(client.dashboard_link))
            yield DaskExecutor(client, folder, self.waiting)
