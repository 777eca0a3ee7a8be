"""CPU times per variant of a study, beside other ways to calculate it, as Markdown.

python -m benchmarks.studies [kernel]    # all parts by default
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: one thread is meant

import resource
import statistics
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import torsionnet as tn
from benchmarks._sizes import ARGUMENTS, sized
from torsionnet.linear.batch.batch import Batch
from torsionnet.linear.batch.batch_plan import BatchPlan, batch_plan
from torsionnet.linear.batch.batched_responses import batched_responses
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest, cached_request

RUNS = sized(5, 1)
N_LOOP = sized(40, 3)


def chain(n: int) -> tn.Drivetrain:
    """Chain of inertias between springs, all values parameters."""
    elements: list[tn.Element] = []
    parameters: dict[str, float] = {}
    for i in range(n):
        parameters[f"J_{i}"] = 1 + 0.1 * i
        elements.append(tn.Inertia(f"mass_{i}", node=f"n_{i}", inertia=f"J_{i}"))
        elements.append(tn.Damper(f"drag_{i}", nodes=(f"n_{i}", "ground"), damping=0.1))
        if i:
            parameters[f"k_{i}"] = 1e6
            nodes = (f"n_{i - 1}", f"n_{i}")
            elements.append(tn.Spring(f"shaft_{i}", nodes=nodes, stiffness=f"k_{i}", damping=10))
    return tn.Drivetrain("chain", elements, parameters=parameters, inputs={"T": {"torque": "n_0"}})


def drawn(model: tn.Drivetrain, count: int, names: list[str], seed: int = 0) -> dict[str, np.ndarray]:
    random = np.random.default_rng(seed)
    return {name: model.parameters[name] * random.normal(1, 0.1, count) for name in names}


def cpu(work: Callable[[], object], variants: int) -> float:
    """Median CPU time in ms per variant."""
    work()
    times = []
    for _ in range(RUNS):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return 1e3 * statistics.median(times) / variants


def lapack(batch: Batch, omega: np.ndarray) -> np.ndarray:
    """|H| of the last coordinate from the assembled matrices of every variant, a block of frequencies at a time."""
    rows = batch.drivetrain.assembly.system.rows
    load = np.zeros((rows.shape[1], 1))
    load[0] = 1
    found = np.empty((len(batch), len(omega)))
    s = 1j * omega[:, None, None]
    for place in range(len(batch)):
        M, C, K = (rows.T @ (part[place, :, None] * rows) for part in (batch.inertia, batch.damping, batch.stiffness))
        for start in range(0, len(omega), 200):
            part = slice(start, start + 200)
            D = K + s[part] * C + s[part] ** 2 * M
            found[place, part] = np.abs(np.linalg.solve(D, load)[:, -1, 0])
    return found


def magnitudes(
    plan: BatchPlan, request: TransferRequest, values: dict[str, np.ndarray], f: np.ndarray, method: str
) -> np.ndarray:
    """Magnitudes |H| of variants from values of parameters."""
    return np.abs(batched_responses(plan.batch(values), request, f, method).values)


def kernel() -> None:
    count, f = sized(500, 20), np.linspace(1, 300, 1000)
    rig = chain(6)
    names = list(rig.parameters)
    values, plan = drawn(rig, count, names), batch_plan(rig, names)
    assert plan is not None
    request = cached_request(rig, "n_5", "T", None)
    few = {name: column[:N_LOOP] for name, column in values.items()}
    singles = [dict(zip(few, map(float, row), strict=True)) for row in zip(*few.values(), strict=True)]
    found = {
        "batched LAPACK solve": cpu(lambda: lapack(plan.batch(values), 2 * np.pi * f), count),
        "each `configured()`": cpu(
            lambda: [abs(rig.configured(**one).frequency_response("n_5", "T", f).values) for one in singles], N_LOOP
        ),
        "batch, numba": cpu(lambda: magnitudes(plan, request, values, f, "compiled"), count),
        "batch, numpy": cpu(lambda: magnitudes(plan, request, values, f, "graph"), count),
        "coefficients alone": cpu(lambda: plan.batch(values), count),
    }
    print("6 DOF x 1000 frequencies, from arrays of parameters to |H|, CPU time in ms a variant; goals 0.2 and 0.6\n")
    print("| way | ms | LAPACK / this |\n|---|---|---|")
    for way, taken in found.items():
        print(f"| {way} | {taken:.4f} | {found['batched LAPACK solve'] / taken:.1f} |")
    library_rig()


def library_rig() -> None:
    """Print the CPU time of variants of a library model in chunks, with sampling and a reduction."""
    rig, f = tn.load("amt_rig").configured("V"), np.linspace(0.1, 40, 400)
    names = ["k_1", "k_2", "c_1", "c_O", "I_1", "I_2"]
    plan, request = batch_plan(rig, names), cached_request(rig, "theta_1", "T_T", None)
    assert plan is not None
    chunk, chunks = sized(5000, 50), sized(8, 2)

    def work(seed: int) -> np.ndarray:
        return magnitudes(plan, request, drawn(rig, chunk, names, seed), f, "compiled").max(axis=0)

    work(0)
    times = {}
    for workers in (1, 2):
        start, used = time.perf_counter(), time.process_time()
        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(work, range(chunks)))
        times[workers] = time.perf_counter() - start, time.process_time() - used
    print(f"\namt_rig x {len(f)} frequencies, {chunks} chunks of {chunk} variants, with sampling and a reduction\n")
    print("| threads | CPU ms a variant | 1e6 variants, minutes | speed |\n|---|---|---|---|")
    for workers, (elapsed, spent) in times.items():
        each = 1e3 * spent / (chunk * chunks)
        print(f"| {workers} | {each:.4f} | {1e6 * elapsed / (chunk * chunks) / 60:.2f} | {times[1][0] / elapsed:.2f} |")
    print(f"\nPeak memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20:.2f} GiB (goal: 1)")


PARTS = {"kernel": kernel}

if __name__ == "__main__":
    for part in ARGUMENTS or PARTS:
        PARTS[part]()
