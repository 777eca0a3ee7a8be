"""Choice of the processes or the cluster that calculate a study."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from torsionnet.base.errors import UsageError
from torsionnet.study.run.executor import Executor, SerialExecutor
from torsionnet.study.run.process_pool import ProcessExecutor

MOST_ON_WINDOWS = 61
"""Most worker processes on Windows, where a program can wait for 64 handles, some of which Python needs."""


@dataclass(frozen=True)
class Workers:
    """Number of processes of this machine, or address of a cluster, that calculate a study.

    Attributes
    ----------
    processes : int
        Number of processes of this machine; with 1 this process calculates.
    cluster : str
        Address of a cluster instead: ``tcp://host:port``, a scheduler file, or ``local:N``.
    announce : callable or None
        Called with the address of the dashboard of a cluster.
    waiting : callable
        Called with a sentence when a cluster has no workers yet, or none any more, and for how long.
    """

    processes: int = 1
    cluster: str = ""
    announce: Callable[[str], None] | None = None
    waiting: Callable[[str], None] = lambda _text: None

    def __post_init__(self) -> None:
        if self.processes < 1:
            raise UsageError("a study needs one worker at least")
        if os.name == "nt" and self.processes > MOST_ON_WINDOWS:
            raise UsageError(f"Windows lets a program wait for {MOST_ON_WINDOWS} processes at most; give fewer workers")
        if self.processes > 1 and self.cluster:
            raise UsageError("workers are processes or those of a cluster: give one of them")

    @contextmanager
    def executor(self, folder: Path | None) -> Iterator[Executor]:
        """Yield an executor on these workers, which ends with the ``with`` block."""
        if self.cluster:
            with self._of_cluster(folder) as found:
                yield found
        elif self.processes > 1:
            with ProcessExecutor(self.processes) as pool:
                yield pool
        else:
            yield SerialExecutor()

    @contextmanager
    def _of_cluster(self, folder: Path | None) -> Iterator[Executor]:
        from torsionnet.study.run.cluster.connecting import connected
        from torsionnet.study.run.cluster.dask_executor import DaskExecutor

        if folder is None:
            raise UsageError("a study on a cluster needs a folder that all its workers see: -o FOLDER")
        with connected(self.cluster) as client:
            if self.announce is not None:
                self.announce(str(client.dashboard_link))
            yield DaskExecutor(client, folder, self.waiting)
