"""To the workers of a cluster, by its address, a scheduler file, or made on this machine."""

from __future__ import annotations

import json
import logging
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from torsionnet.core.errors import MissingExtraError, UsageError
from torsionnet.study.cluster.local_workers import local_workers
from torsionnet.study.cluster.scheduler_answer import must_answer

if TYPE_CHECKING:
    from distributed import Client

FORMS = (
    "tcp://host:port (the address a scheduler prints), the path of a scheduler file ending in .json, or local:N for N "
    "processes of this machine"
)
LOCAL = re.compile(r"local(?::(\d+))?")
PATIENCE = 10.0
"""Seconds that a scheduler may take to answer."""


@contextmanager
def connected(where: str, patience: float = PATIENCE) -> Iterator[Client]:
    """A client of the cluster; its ``dashboard_link`` shows what the workers do.

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
    torsionnet.core.errors.UsageError: "cluster.yaml" is no cluster; give tcp://host:port ...
    """
    local = LOCAL.fullmatch(where)
    if local is None and "://" not in where and not where.endswith(".json"):
        raise UsageError(f'"{where}" is no cluster; give {FORMS}')
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
    """Of a scheduler file, which ``dask scheduler --scheduler-file`` writes."""
    try:
        address = json.loads(file.read_text())["address"]
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

    must_answer(address, patience)
    with _quiet():
        client = Client(address, timeout=patience, set_as_default=False)
    try:
        yield client
    finally:
        with _quiet():
            client.close()


@contextmanager
def _quiet() -> Iterator[None]:
    """Without what dask says of versions and of lost connections, which is said here in words of a study."""
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
