"""Schedulers, workers and clients of dask as processes of their own, which a test may kill."""

import os
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager, suppress
from pathlib import Path

from support.patience import wait_for

TESTS = Path(__file__).parents[1]
CLIENT = """
import sys
from pathlib import Path
from support.cluster_work import NoiseWork
from torsionnet.study.run.dask_executor import connected
from torsionnet.study.run.dask_executor import DaskExecutor

if __name__ == "__main__":
    where, folder, count = sys.argv[1], sys.argv[2], int(sys.argv[3])
    work = NoiseWork(folder)
    with connected(where) as client:
        for _ in DaskExecutor(client, Path(folder)).map(work, work.missing(count)):
            pass
"""
STUDY_CLIENT = """
import sys
from pathlib import Path
from torsionnet.study.study import load_study
from torsionnet.study.run.run_chunks import run_study
from torsionnet.study.run.answering import Workers

if __name__ == "__main__":
    file, where, folder = sys.argv[1:]
    with Workers(cluster=where).executor(Path(folder)) as executor:
        print(run_study(load_study(file), folder, executor=executor).table().to_text())
"""


@contextmanager
def process(*arguments, before=()):
    """A Python process in a session of its own, which ends with the block, its children too.

    Folders ``before`` come first on its path.
    """
    path = os.pathsep.join(map(str, [*before, TESTS.parent, TESTS]))
    environment = {**os.environ, "PYTHONPATH": path, "PYTHONWARNINGS": ""}
    command = [sys.executable, *map(str, arguments)]
    with tempfile.TemporaryFile("w+", encoding="utf-8") as log:
        started = subprocess.Popen(command, env=environment, start_new_session=True, stdout=log, stderr=log)
        started.said = lambda: (log.seek(0), log.read())[1]
        try:
            yield started
        finally:
            kill_all_of(started)


def kill_all_of(started):
    """A process and its children, at once."""
    with suppress(ProcessLookupError):
        os.killpg(started.pid, signal.SIGKILL)
    started.wait()


@contextmanager
def scheduler(folder):
    """Of two cores' worth of nothing yet: its file, and the process."""
    file = Path(folder) / f"scheduler_{time.monotonic_ns()}.json"
    arguments = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--idle-timeout", "120 s")
    with process("-m", "distributed.cli.dask_scheduler", *arguments, "--scheduler-file", file) as started:
        wait_for(lambda: file.exists() and file.stat().st_size > 0)
        yield file, started


@contextmanager
def workers(file, count=1, before=()):
    """Worker processes of one thread each, with a nanny."""
    arguments = ("--nthreads", "1", "--nworkers", count, "--death-timeout", "20", "--no-dashboard")
    command = ("-m", "distributed.cli.dask_worker", "--scheduler-file", file, *arguments)
    with process(*command, "--local-directory", file.parent, before=before) as started:
        yield started


@contextmanager
def client(where, folder, count):
    """A program that runs the chunks that are missing."""
    with process("-c", CLIENT, where, folder, count) as started:
        yield started
