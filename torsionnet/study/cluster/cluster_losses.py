"""What can be lost while a cluster calculates, in words of a study."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

from torsionnet.core.errors import TorsionnetError
from torsionnet.study.cluster.cluster_error import ClusterError
from torsionnet.study.run.executor import named

if TYPE_CHECKING:
    from distributed import Client, Future

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
