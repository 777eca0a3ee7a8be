"""Times of frequency responses against other ways to calculate them, with the ratios to be reached, as Markdown.

openTorsion 0.3.2 is no dependency: its row needs it in the interpreter that runs this, or in the one named by
``OPENTORSION_PYTHON`` (``python -m venv v; v/bin/pip install opentorsion==0.3.2``).
"""

import os
import platform
import statistics
import subprocess
import sys
import time
import warnings
from pathlib import Path

import numpy as np

import torsionnet as tn
from benchmarks._sizes import ARGUMENTS, sized
from torsionnet.linear.assembly.law_stiffness import law_stiffness
from torsionnet.linear.assembly.rows import Rows, RowSystem
from torsionnet.linear.dynamic_stiffness.quotient import METHODS, rounding_errors, uncertain_points
from torsionnet.linear.dynamic_stiffness.response_problem import Loading, ResponseProblem

OPENTORSION = """
import sys, time, numpy as np
from opentorsion import Assembly, Shaft, Disk
n, n_f = int(sys.argv[1]), int(sys.argv[2])
shafts = [Shaft(i, i + 1, k=1e6, c=10.0) for i in range(n - 1)]
rotor = Assembly(shafts, disk_elements=[Disk(i, I=1.0, c=0.1) for i in range(n)])
omega = 2 * np.pi * np.linspace(1, 300, n_f)
if sys.argv[3] == "frf":
    U = np.zeros((n, n_f)); U[0] = 1.0
    start = time.perf_counter(); rotor.ss_response(U, omega)
else:
    start = time.perf_counter(); rotor.modal_analysis(); rotor.eigenmodes()
print(time.perf_counter() - start)
"""


def chain(n, extra=(), parent=None, ratio=None):
    """Chain with J = 1, k = 1e6, c = 10 between neighbours, 0.1 to ground; ``extra`` pairs close loops."""
    parent = parent or (lambda i: i - 1)
    ratio = ratio or (lambda _: 1.0)
    links = [(parent(i), i, ratio(i)) for i in range(1, n)] + [(i, j, 1.0) for i, j in extra]
    rows = np.zeros((n + len(links), n))
    rows[:n] = np.eye(n)
    for number, (i, j, tau) in enumerate(links):
        rows[n + number, i], rows[n + number, j] = 1.0, -tau
    kind = np.arange(len(rows)) < n
    return RowSystem(Rows.of(rows), 1.0 * kind, np.where(kind, 0.1, 10.0), np.where(kind, 0.0, 1e6))


def graph(system, omega, method="graph"):
    """Receptance between the ends of a chain, by elimination along its graph."""
    n = system.n_coordinates
    # As a drivetrain keeps it for all calls and configured copies.
    problem = system.memo.once(
        ResponseProblem,
        "ends",
        lambda: ResponseProblem(system.sparse_rows, n, (Loading(load={0: 1.0}),), ({n - 1: 1.0},)),
    )
    kappa = law_stiffness([system], omega)

    def evaluate(laws, _=False):
        return np.moveaxis(METHODS[method](problem, laws), 2, 0)

    values = evaluate(kappa)
    uncertain_points(rounding_errors(evaluate, kappa, values), 1)  # as of every response
    return values[:, 0, 0]


def compiled(system, omega):
    return graph(system, omega, "compiled")


def thomas(system, omega):
    """Receptance between the ends of a chain, by tridiagonal elimination of its matrix, all frequencies at once."""
    M, C, K = system.M, system.C, system.K
    n, s = len(M), 1j * omega
    diagonal = [K[i, i] + s * (C[i, i] + s * M[i, i]) for i in range(n)]
    beside = [K[i, i + 1] + s * (C[i, i + 1] + s * M[i, i + 1]) for i in range(n - 1)]
    right = [np.ones(len(s), dtype=complex)] + [0.0] * (n - 1)
    for i in range(1, n):
        w = beside[i - 1] / diagonal[i - 1]
        diagonal[i] = diagonal[i] - w * beside[i - 1]
        right[i] = right[i] - w * right[i - 1]
    return right[-1] / diagonal[-1]


def batched(system, omega):
    n, block = system.n_coordinates, 200
    answer = np.empty(len(omega), dtype=complex)
    load = np.zeros((n, 1))
    load[0] = 1.0
    for start in range(0, len(omega), block):
        s = 1j * omega[start : start + block, None, None]
        answer[start : start + block] = np.linalg.solve(system.K + s * system.C + s * s * system.M, load)[:, -1, 0]
    return answer


def sparse_loop(system, omega):
    from scipy import sparse
    from scipy.sparse.linalg import splu

    M, C, K = (sparse.csc_matrix(matrix) for matrix in (system.M, system.C, system.K))
    load = np.zeros(system.n_coordinates, dtype=complex)
    load[0] = 1.0
    return np.array([splu((K + 1j * w * C - w * w * M).tocsc()).solve(load)[-1] for w in omega])


def control_system(system):
    import control

    n, inverse = system.n_coordinates, np.linalg.inv(system.M)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ system.K, -inverse @ system.C]])
    B = np.zeros((2 * n, 1))
    B[n:, 0] = inverse[:, 0]
    read = np.zeros((1, 2 * n))
    read[0, n - 1] = 1.0
    return control.StateSpace(A, B, read, 0)


def exact_error(system, omega, found):
    """Largest relative error against 60 digits at a few frequencies."""
    import mpmath

    with mpmath.workdps(60):
        worst = 0.0
        for i in range(0, len(omega), max(1, len(omega) // 5)):
            w, (M, C, K) = mpmath.mpf(omega[i]), (mpmath.matrix(m) for m in (system.M, system.C, system.K))
            load = mpmath.matrix([1.0] + [0.0] * (system.n_coordinates - 1))
            q = mpmath.lu_solve(K + mpmath.mpc(0, w) * C - w * w * M, load)[system.n_coordinates - 1]
            worst = max(worst, float(abs(mpmath.mpmathify(complex(found[i])) - q) / abs(q)))
        return worst


def seconds(function, *arguments, runs=5):
    function(*arguments)
    times = []
    for _ in range(sized(runs, 1)):
        start = time.perf_counter()
        function(*arguments)
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def opentorsion_seconds(n, n_f, work):
    python = os.environ.get("OPENTORSION_PYTHON", sys.executable)
    run = subprocess.run(
        [python, "-c", OPENTORSION, str(n), str(n_f), work], capture_output=True, text=True, check=False
    )
    return float(run.stdout.split()[-1]) if run.returncode == 0 else None


def frequencies(n_f):
    return 2 * np.pi * np.linspace(1, 300, n_f)


def long_chain():
    n, n_f = sized(500, 50), sized(1000, 100)
    system, omega = chain(n), frequencies(n_f)
    ours, theirs = seconds(graph, system, omega), seconds(thomas, system, omega, runs=3)
    assert np.allclose(graph(system, omega), thomas(system, omega), rtol=1e-6)
    other = opentorsion_seconds(n, n_f, "frf")
    yield f"{n}-DOF chain, {n_f} frequencies, against openTorsion `ss_response`", ours, other, ">= 900", None
    yield "the same against a hand-written vectorised Thomas", ours, theirs, "time <= 1.5 x", ours / theirs <= 1.5


def against(what, n, n_f, reference, least):
    """Rows of the table for numpy, and for the compiled loop of the extra ``fast``."""
    system, omega = chain(n), frequencies(n_f)
    start = time.perf_counter()
    expected = reference(system, omega)
    theirs = time.perf_counter() - start
    for (way, solve), goal in zip((("", graph), (", compiled", compiled)), least, strict=True):
        ours = seconds(solve, system, omega)
        assert np.allclose(solve(system, omega), expected, rtol=1e-6)
        yield f"{n} DOF, {n_f} frequencies, against {what}{way}", ours, theirs, f">= {goal}", theirs / ours >= goal


def loops():
    rng = np.random.default_rng(1)
    parents = [0] + [int(rng.integers(max(0, i - 6), i)) for i in range(1, 200)]
    ratios = rng.choice([1.0, 1.0, 2.0, -3.3], 200)
    tree = chain(200, parent=parents.__getitem__, ratio=ratios.__getitem__)
    looped = chain(200, [(150, 20), (199, 90), (60, 10)], parents.__getitem__, ratios.__getitem__)
    ours, theirs = (seconds(graph, system, frequencies(1000)) for system in (looped, tree))
    yield "branched, geared, 200 DOF: 3 closed loops against the tree", ours, theirs, "time <= 3 x", ours <= 3 * theirs


def growth(name, sizes, run):
    times = [seconds(run, size) for size in sizes]
    exponent = float(np.polyfit(np.log(sizes), np.log(times), 1)[0])
    return (
        f"growth of time with {name}, {sizes[0]} to {sizes[-1]}: exponent {exponent:.2f}",
        times[-1],
        None,
        "<= 1.1",
        exponent <= 1.1,
    )


def siso():
    import control

    n = sized(50, 10)
    system, omega = chain(n), frequencies(1000)
    ours = seconds(graph, system, omega)
    model = control_system(system)
    theirs = seconds(lambda: control.frequency_response(model, omega), runs=3)
    error = exact_error(system, omega, graph(system, omega))
    other = exact_error(system, omega, control.frequency_response(model, omega).complex.ravel())
    name = f"{n} DOF, 1000 frequencies, against python-control (errors {error:.0e}, {other:.0e})"
    yield name, ours, theirs, ">= 100, error <= 1e-11", theirs / ours >= 100 and error <= 1e-11


def small():
    rig = tn.Drivetrain(
        "two masses",
        [
            tn.Inertia("motor", node="a", inertia=0.078),
            tn.Spring("shaft", nodes=("a", "b"), stiffness="k", damping=0.1),
            tn.Inertia("load", node="b", inertia=0.152),
            tn.Spring("mount", nodes=("b", "ground"), stiffness=500, damping=1),
        ],
        parameters={"k": 13.3e3},
    )
    f = np.linspace(1, 100, 400)
    whole = seconds(lambda: rig.frequency_response("a", "a", f), runs=101)
    yield "2 DOF, 400 frequencies, whole call after the first", whole, None, "<= 0.3 ms", whole <= 0.3e-3
    copies = iter([rig.configured(k=12e3 + i) for i in range(102)])
    copied = seconds(lambda: next(copies).frequency_response("a", "a", f), runs=101)
    yield "the same of a newly configured copy", copied, None, "<= 1 ms", copied <= 1e-3
    stiffness = iter(range(102))
    both = seconds(lambda: rig.configured(k=11e3 + next(stiffness)).frequency_response("a", "a", f), runs=101)
    yield "the same with making the copy", both, None, "", None


def rows():
    yield from long_chain()
    yield from against("batched `numpy.linalg.solve`", 100, sized(10_000, 100), batched, (200, 900))
    yield from against(
        "a `scipy.sparse.linalg.splu` loop", sized(1000, 100), sized(10_000, 100), sparse_loop, (33, 180)
    )
    yield from loops()
    yield growth("DOF", list(CHAINS), lambda n: graph(CHAINS[n], frequencies(sized(2000, 100))))
    yield growth("frequencies", LINES, lambda n: graph(CHAINS[200], frequencies(n)))
    yield from siso()
    yield from small()


CHAINS = {n: chain(n) for n in sized([100, 200, 400, 800, 1600], [100, 200])}
LINES = sized([1000, 3000, 10_000, 30_000], [100, 300])


def milliseconds(value):
    return "" if value is None else f"{1e3 * value:.3g}"


def table():
    yield "| work | here, ms | other, ms | ratio | to reach | |"
    yield "|---|---|---|---|---|---|"
    for name, ours, other, goal, reached in rows():
        ratio = "" if other is None else f"{other / ours:.3g}"
        enough = other / ours >= float(goal[3:]) if other is not None and reached is None else reached
        missing = "openTorsion is not installed" if other is None and "openTorsion" in name else ""
        word = missing or {None: "", True: "reached", False: "missed"}[None if enough is None else bool(enough)]
        yield f"| {name} | {milliseconds(ours)} | {milliseconds(other)} | {ratio} | {goal} | {word} |"


def main():
    warnings.simplefilter("ignore")
    lines = [
        f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}, numpy {np.__version__}",
        "",
    ]
    print(lines[0], end="\n\n")
    for line in table():
        print(line, flush=True)
        lines.append(line)
    if ARGUMENTS:
        Path(ARGUMENTS[0]).write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
