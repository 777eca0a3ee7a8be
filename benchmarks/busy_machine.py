"""Times of modal fits and fits of records on a busy machine, with and without a limit to the threads of BLAS.

python -m benchmarks.busy_machine [BUSY]    # loops beside it; by default one for each core

Each case runs in a process of its own in which OPENBLAS_NUM_THREADS is not set.
"""

from __future__ import annotations

import os
import subprocess
import sys
from contextlib import ExitStack

from benchmarks._sizes import ARGUMENTS, sized

PROGRAM = """
import sys, time
from contextlib import nullcontext
from dataclasses import replace
from types import SimpleNamespace
import numpy as np
import torsionnet as tn
from torsionnet.base import threads
from torsionnet.modal import Settings, identify_modes
from torsionnet.signals import PAPER

if sys.argv[1] == "free":
    threads._controller = lambda: SimpleNamespace(limit=lambda **_: nullcontext())

rig = tn.load("amt_rig").configured("II")
clean = rig.frequency_response(["motor", "input_shaft", "output_shaft"], "T_M", np.arange(0.5, 30, float(sys.argv[2])))
noise = 0.01 * np.sqrt(np.mean(np.abs(clean.values) ** 2, axis=0))
test = replace(clean, values=clean.values + noise * np.random.default_rng(1).normal(size=clean.values.shape))
record = tn.load_bench("dmf_bench").run(1)
measured = tn.Measurement(record, "theta_1", "T_T", settings=PAPER)
cases = {
    "modes, rational": lambda: identify_modes(test, Settings("rational")),
    "modes, LSCF": lambda: identify_modes(test, Settings("lscf")),
    "fit of a record": lambda: tn.identify(tn.load("dmf_rig").configured(c_2=8), measured, ["c_2", "k_2"]),
}
for name, case in cases.items():
    began = time.perf_counter()
    case()
    print(f"{name};{time.perf_counter() - began}")
"""
BUSY = """
import os
os.environ["OPENBLAS_NUM_THREADS"] = "1"
import numpy as np
a = np.ones((300, 300))
while True:
    a @ a
"""


def measured(threads: str, spacing: float) -> dict[str, float]:
    """Seconds of every case."""
    environment = {key: value for key, value in os.environ.items() if key != "OPENBLAS_NUM_THREADS"}
    command = [sys.executable, "-c", PROGRAM, threads, str(spacing)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return {name: float(value) for name, value in (line.split(";") for line in done.stdout.splitlines())}


def main(busy: int) -> None:
    """Print the table of times."""
    for count in dict.fromkeys((0, busy)):
        with ExitStack() as stack:
            for _ in range(count):
                process = stack.enter_context(subprocess.Popen([sys.executable, "-c", BUSY]))
                stack.callback(process.kill)
            free, limited = (measured(threads, sized(0.1, 1.0)) for threads in ("free", "one"))
        for name, seconds in free.items():
            both = f"free {seconds:.2f} s, one thread {limited[name]:.2f} s"
            print(f"{count} loops beside it: {name:16s} {both}: {seconds / limited[name]:.1f} times", flush=True)


if __name__ == "__main__":
    main(int(ARGUMENTS[0]) if ARGUMENTS else sized(os.cpu_count() or 1, 1))
