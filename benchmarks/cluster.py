"""CPU time and duration of a study on workers of dask.distributed against the same study in one process.

python -m benchmarks.cluster

Each case runs in a process of its own; its CPU includes that of its workers, of the scheduler, and of starting them.
The bytes of all chunks must be the same. The last case has dask's own setting of the C library's memory.
"""

from __future__ import annotations

import hashlib
import json
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import torsionnet as tn
from benchmarks._sizes import ARGUMENTS, SHORT, sized
from torsionnet.study.quantities.transfer_quantity import ResponseQuantity
from torsionnet.study.run import dask_executor as connecting
from torsionnet.study.run.chunk_values import Chunks, chunk_file
from torsionnet.study.run.dask_executor import DaskExecutor, connected
from torsionnet.study.run.process_pool import ProcessExecutor
from torsionnet.study.run.run_chunks import ChunkWork, Executor, SerialExecutor
from torsionnet.study.space.samples import Samples
from torsionnet.study.space.space import Space
from torsionnet.study.space.variations.normal import Normal
from torsionnet.study.study import Study

CHUNKS, SIZE = sized((90, 10_000), (4, 100))
CASES = ("serial", "2 processes", "local:1", "local:2", "local:2, memory as dask has it")


def work_in(folder: Path) -> ChunkWork:
    """Work of a study in a folder: response of an AMT test rig at 400 frequencies with four varying parameters."""
    rig = tn.load("amt_rig").configured("II")
    vary = {name: Normal(deviation="5 %") for name in ("k_1", "k_2", "c_1", "I_2")}
    space = Space(rig, vary, sampling=Samples(count=CHUNKS * SIZE))
    curve = ResponseQuantity(output="theta_1", input="T_T", band="0.5..30 Hz", points=400, spacing="linear")
    (folder / "chunks").mkdir()
    return ChunkWork(Study(rig, space, {"curve": curve}), Chunks(1, space.count, SIZE), 1, folder)


@contextmanager
def executor(case: str, folder: Path) -> Iterator[Executor]:
    if case == "serial":
        yield SerialExecutor()
    elif case == "2 processes":
        yield ProcessExecutor(2)
    else:
        where, _, otherwise = case.partition(",")
        if otherwise:
            connecting.SURROUNDINGS["MALLOC_TRIM_THRESHOLD_"] = "65536"
            connecting.SURROUNDINGS.pop("MALLOC_MMAP_THRESHOLD_")
        with connected(where) as client:
            yield DaskExecutor(client, folder)


def measured(case: str) -> dict[str, float | str]:
    """CPU time, duration, peak memory and digest of a case, its children included, which must have ended."""
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as name:
        work = work_in(Path(name))
        with executor(case, Path(name)) as chosen:
            for _ in chosen.map(work, range(CHUNKS)):
                pass
        digest = hashlib.sha256(b"".join(chunk_file(Path(name), n).read_bytes() for n in range(CHUNKS))).hexdigest()
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    cpu = sum(one.ru_utime + one.ru_stime for one in used)
    peak = max(one.ru_maxrss for one in used) / 1024
    return {"cpu": cpu, "seconds": time.perf_counter() - began, "peak": peak, "digest": digest}


def in_process(case: str) -> dict[str, float | str]:
    command = [sys.executable, "-m", "benchmarks.cluster", case, *(["--short"] if SHORT else [])]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    found: dict[str, float | str] = json.loads(done.stdout.splitlines()[-1])
    return found


def main() -> None:
    """Print the table of CPU times and durations."""
    print(f"{CHUNKS * SIZE:,} variants, 400 frequencies, in {CHUNKS} chunks")
    found = {case: in_process(case) for case in CASES}
    if len({one["digest"] for one in found.values()}) > 1:
        raise SystemExit("the bytes differ")
    serial = float(found["serial"]["cpu"])
    for case, one in found.items():
        cpu = float(one["cpu"])
        print(
            f"{case:32s} {one['seconds']:7.1f} s, CPU {cpu:7.1f} s, {cpu / serial:5.2f} times serial, "
            f"largest process {one['peak']:.0f} MiB"
        )


if __name__ == "__main__":
    if ARGUMENTS:
        print(json.dumps(measured(ARGUMENTS[0])))
    else:
        main()
