"""A study for tests that kill what calculates it: many small chunks, and a program that runs it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import torsionnet as tn
from torsionnet.study.run import workload
from torsionnet.study.run.run_chunks import run_study
from torsionnet.study.run.workers import Workers
from torsionnet.study.study import Study, define

VARIANTS, CHUNK = 600, 20


def small_study(count: int = VARIANTS, **changes: object) -> Study:
    """Two configurations of the AMT rig."""
    rig = tn.load("amt_rig")
    vary = {"k_2": {"type": "normal", "deviation": "5 %"}, "c_1": {"type": "uniform", "low": "-20 %", "high": "+20 %"}}
    quantities = {
        "f_1": {"type": "natural_frequency", "mode": 1},
        "H": {"type": "response", "output": "theta_1", "input": "T_M", "band": "1..20 Hz", "points": 5},
    }
    given = {"configurations": ["II", "V"], "sampling": {"count": count}, **changes}
    return define(rig, vary, quantities, **given)


def small_chunks() -> None:
    """Chunks of so few variants that there are many."""
    workload.POINTS, workload.AT_LEAST = 1, CHUNK


def contents(folder: Path) -> dict[str, bytes]:
    """Bytes of all that a study leaves in its folder."""
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in folder.rglob("*")
        if file.is_file() and not file.name.startswith(".")
    }


def started(folder: Path, processes: int = 1, threads: int = 1) -> subprocess.Popen[bytes]:
    """A program of its own that runs the study."""
    here = str(Path(__file__).parent)
    path = os.pathsep.join([here, str(Path(tn.__file__).parents[1])])
    environment = {**os.environ, "PYTHONPATH": path, "OPENBLAS_NUM_THREADS": "1"}
    return subprocess.Popen(
        [sys.executable, "-m", "study_runs", str(folder), str(processes), str(threads)],
        env=environment,
        start_new_session=True,
    )


def deaf(number: int) -> bool:
    """Whether interrupts were held back from the process while it started."""
    del number
    return signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, ())


def deadly(number: int) -> None:
    """Ends its process, as a system does that has no memory left."""
    del number
    os.kill(os.getpid(), signal.SIGKILL)


if __name__ == "__main__":
    small_chunks()
    workers = Workers(int(sys.argv[2]), int(sys.argv[3]))
    with workers.executor(Path(sys.argv[1])) as executor:
        run_study(small_study(), sys.argv[1], executor=executor)
