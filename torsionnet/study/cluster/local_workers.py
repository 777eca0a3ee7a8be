"""A cluster made of processes of this machine."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterator
from contextlib import contextmanager

from torsionnet.core.errors import UsageError
from torsionnet.study.run.process_pool import ENVIRONMENT

SURROUNDINGS = {
    **ENVIRONMENT,
    "OMP_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
}
"""Of the workers: the C library keeps the memory of one chunk for the next, and BLAS uses one thread.

By dask's own setting every array above 64 KiB goes back to the system when it is let go, and fetching it again costs
more than what is calculated with it.
"""

SETTINGS = {
    "distributed.nanny.pre-spawn-environ": SURROUNDINGS,
    "distributed.worker.profile.enabled": False,  # it looks at every thread a hundred times a second
}


@contextmanager
def local_workers(count: int | None = None) -> Iterator[str]:
    """The address of a scheduler with ``count`` workers of one thread each; by default one for each core.

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
