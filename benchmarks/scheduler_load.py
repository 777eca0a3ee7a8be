"""Load of tasks on the scheduler and the client of a cluster, for the plan of a study on many workers.

python -m benchmarks.scheduler_load [WORKERS]

The workers are many in one process and only wait in their tasks, so that even a small machine can be a large cluster.
"""

from __future__ import annotations

import asyncio
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

import psutil

from benchmarks._sizes import ARGUMENTS, sized
from torsionnet.study.run.dask_executor import DaskExecutor, TaskSize, connected

SECONDS = sized(20.0, 1.0)


@dataclass(frozen=True)
class Waiting:
    """Task that takes time but no work."""

    folder: Path
    seconds: float

    def __call__(self, number: int) -> None:
        del number
        time.sleep(self.seconds)


async def be_workers(address: str, count: int) -> None:
    from distributed import Worker

    workers = [Worker(address, nthreads=1, memory_limit=0, dashboard=False) for _ in range(count)]
    await asyncio.gather(*workers)
    await asyncio.gather(*(worker.finished() for worker in workers))


@contextmanager
def process(*arguments: str) -> Iterator[psutil.Process]:
    with subprocess.Popen([sys.executable, *arguments], stderr=subprocess.DEVNULL) as started:
        try:
            yield psutil.Process(started.pid)
        finally:
            started.kill()


def cpu(of: psutil.Process) -> float:
    times = of.cpu_times()
    return float(times.user + times.system)


def own_cpu() -> float:
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def through_loopback() -> int:
    """Bytes through the loopback device, of all programs of this machine; 0 where the system does not report them."""
    counters = psutil.net_io_counters(pernic=True).get("lo")
    return counters.bytes_sent if counters else 0


def spent(scheduler: psutil.Process, work: Callable[[], int]) -> tuple[int, float, float, float, float]:
    """Tasks done, seconds, CPU seconds of the scheduler and of this process, and bytes sent, of a run."""
    before = time.perf_counter(), cpu(scheduler), own_cpu(), through_loopback()
    count = work()
    after = time.perf_counter(), cpu(scheduler), own_cpu(), through_loopback()
    return (count, *(later - sooner for sooner, later in zip(before, after, strict=True)))  # type: ignore[return-value]


def measure(count: int, seconds: float, folder: str) -> None:
    """Print the load of idle workers, and then that of a task."""
    file = Path(folder) / f"scheduler_{count}_{seconds}.json"
    where = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(file))
    with process("-m", "distributed.cli.dask_scheduler", *where) as scheduler:
        while not file.exists() or not file.stat().st_size:
            time.sleep(0.05)
        with connected(str(file)) as client, process("-m", "benchmarks.scheduler_load", "be", str(count), str(file)):
            client.wait_for_workers(count)
            time.sleep(SECONDS / 10)
            _, wall, busy, _, sent = spent(scheduler, lambda: time.sleep(SECONDS / 2) or 0)
            print(f"{count} idle workers: {100 * busy / wall:.1f} % of a core, {sent / wall / 1e3:.0f} kB/s")
            total = int(min(SECONDS * count / max(seconds, 0.01), SECONDS * 100))
            work = Waiting(Path(folder), seconds)
            with mock.patch.object(TaskSize, "chunks", return_value=1):
                done = spent(
                    scheduler, lambda: sum(1 for _ in DaskExecutor(client, Path(folder)).map(work, deque(range(total))))
                )
            tasks, wall, busy, own, sent = done
            memory = scheduler.memory_info().rss / 2**20
            print(
                f"{tasks} tasks of {seconds:g} s on {count} workers: {tasks / wall:.0f} tasks/s; each "
                f"{1e3 * busy / tasks:.2f} ms of the scheduler, {1e3 * own / tasks:.2f} ms of the client, "
                f"{sent / tasks / 1e3:.1f} kB; "
                f"scheduler {memory:.0f} MiB"
            )


if __name__ == "__main__":
    os.environ.setdefault("DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED", "False")
    if ARGUMENTS[:1] == ["be"]:
        import json

        asyncio.run(
            be_workers(json.loads(Path(ARGUMENTS[2]).read_text(encoding="utf-8"))["address"], int(ARGUMENTS[1]))
        )
    else:
        with tempfile.TemporaryDirectory() as place:
            for workers in [int(ARGUMENTS[0])] if ARGUMENTS else sized([20, 100, 200], [2]):
                for length in sized((0.0, 2.0), (0.0,)):
                    measure(workers, length, place)
