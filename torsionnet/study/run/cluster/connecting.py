"""Connection to a cluster by its address or a scheduler file, or to workers started on this machine."""

from __future__ import annotations

import asyncio
import json
import logging
import os
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsionnet.base.errors import MissingExtraError, UsageError
from torsionnet.study.run.process_pool import ENVIRONMENT

if TYPE_CHECKING:
    from distributed import Client


def require_scheduler(address: str, patience: float) -> None:
    """Refuse an address at which no scheduler of a cluster answers within ``patience`` seconds."""
    from distributed.utils import LoopRunner

    runner = LoopRunner(asynchronous=False)
    runner.start()
    try:
        found = runner.run_sync(_identity, address, patience)
    except (OSError, TimeoutError) as error:
        raise UsageError(
            f"no scheduler answers at {address} within {patience:g} s; see that it runs (dask scheduler), that address "
            f"and port are those it prints, and that no firewall is between ({_first_line(error)})"
        ) from None
    except ValueError as error:
        raise UsageError(
            f"{address} is no address of a scheduler, as tcp://host:8786 is ({_first_line(error)})"
        ) from None
    except (TypeError, ImportError, MemoryError, AttributeError) as error:
        raise UsageError(
            f"what answers at {address} is no scheduler of dask, or one of another version ({_first_line(error)})"
        ) from None
    finally:
        runner.stop()
    if found.get("type") != "Scheduler":
        what = str(found.get("type", "something else")).lower()
        raise UsageError(f"{address} is the address of a {what}; give that of the scheduler")


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
        raise UsageError("a cluster of local:0 has no workers; give local:1 or more")
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
        raise UsageError(f'"{where}" is no cluster; give {ADDRESS_FORMS}')
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
            f"--scheduler-file {file}), into a folder that this machine sees too"
        ) from None
    except OSError as error:
        raise UsageError(f"the scheduler file {file} cannot be read: {error.strerror}") from None
    except (ValueError, KeyError, TypeError):
        raise UsageError(f"{file} is no scheduler file; it has no address of a scheduler in it") from None
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
