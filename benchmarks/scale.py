"""Seconds and memory to build, check, write, load and assemble drivetrains of many elements, by size.

Every size runs in a process of its own, so that each peak of memory is its own. A chain has an inertia and a spring a
node; a train hangs gears, couplings and branches together.
"""

import contextlib
import io
import json
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import torsionnet as tn
from benchmarks._sizes import ARGUMENTS, sized

SIZES = sized([1000, 2000, 5000, 10_000, 20_000], [200, 400])
STAGES = ("build and check", "write YAML", "load YAML", "assemble", "show")


def chain(n: int) -> list[tn.Element]:
    half = n // 2
    elements: list[tn.Element] = [tn.Inertia(f"J{i}", node=f"n{i}", inertia=1) for i in range(half)]
    ends = zip(range(half), range(1, half + 1), strict=True)
    elements += [tn.Spring(f"k{i}", nodes=(f"n{i}", f"n{j}"), stiffness=1e6, damping=10) for i, j in ends]
    return [*elements[:-1], tn.Spring("last", nodes=(f"n{half - 1}", "ground"), stiffness=1e6)]


def train(n: int) -> list[tn.Element]:
    """Drivetrain with four elements per node: an inertia, and in turn a shaft, a gear, a coupling to a branch."""
    elements: list[tn.Element] = [tn.Inertia("J0", node="n0", inertia=1)]
    for i in range(1, n // 2):
        ends = (f"n{(i - 1) // 2}", f"n{i}")
        kind = i % 4
        if kind == 0:
            elements.append(tn.RigidCoupling(f"e{i}", nodes=ends))
        elif kind == 1:
            elements.append(tn.Gear(f"e{i}", nodes=ends, ratio=(-2, 0.5, 3.25)[i % 3]))
        else:
            elements.append(tn.Spring(f"e{i}", nodes=ends, stiffness=1e5 * kind, damping=1))
        elements.append(tn.Inertia(f"J{i}", node=f"n{i}", inertia=0.1))
    return elements


SHAPES = {"chain": chain, "geared tree": train}


def stages(shape: str, n: int) -> dict[str, float]:
    """Seconds of CPU time of every stage, and the peak memory of this process in MB."""
    seconds, began = {}, time.process_time()

    def done(stage: str) -> None:
        nonlocal began
        seconds[stage] = time.process_time() - began
        began = time.process_time()

    model = tn.Drivetrain("large", SHAPES[shape](n), inputs={"T": {"torque": "n0"}})
    done("build and check")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "large.yaml"
        model.to_yaml(file)
        done("write YAML")
        model = tn.load(file)
        done("load YAML")
        _ = model.assembly
        done("assemble")
        from torsionnet.app.cli.terminal import print_table
        from torsionnet.model.overview import tables

        with contextlib.redirect_stdout(io.StringIO()):
            for one in tables(model):
                print_table(one)
        done("show")
    return seconds | {"memory": peak()}


def peak() -> float:
    """Peak memory of this program in MB, as Linux reports it; nan on other systems."""
    status = Path("/proc/self/status")
    return (
        int(status.read_text(encoding="utf-8").partition("VmHWM:")[2].split()[0]) / 1024
        if status.exists()
        else float("nan")
    )


def exponent(values: list[float]) -> float:
    return float(np.polyfit(np.log(SIZES), np.log(values), 1)[0])


def table() -> Iterator[str]:
    yield f"| elements | {' | '.join(f'{stage}, s' for stage in STAGES)} | sum without writing, s | memory, MB |"
    yield "|---" * (len(STAGES) + 3) + "|"
    for shape in SHAPES:
        totals = []
        for n in SIZES:
            run = subprocess.run(
                [sys.executable, "-m", "benchmarks.scale", "--one", shape, str(n)],
                capture_output=True, text=True, check=True,
            )  # fmt: skip
            found = json.loads(run.stdout.splitlines()[-1])
            totals.append(sum(found[stage] for stage in STAGES if stage != "write YAML"))
            cells = [f"{found[stage]:.3g}" for stage in STAGES] + [f"{totals[-1]:.3g}", f"{found['memory']:.0f}"]
            yield f"| {shape}, {n} | {' | '.join(cells)} |"
        yield f"| {shape}: exponent of growth {exponent(totals):.2f} |{' |' * (len(STAGES) + 2)}"


def main() -> None:
    if ARGUMENTS[:1] == ["--one"]:
        print(json.dumps(stages(ARGUMENTS[1], int(ARGUMENTS[2]))))
        return
    print(f"{platform.machine()}, Python {platform.python_version()}, numpy {np.__version__}", end="\n\n")
    for line in table():
        print(line, flush=True)


if __name__ == "__main__":
    main()
