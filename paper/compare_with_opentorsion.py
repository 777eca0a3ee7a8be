"""Table of the paper: torsionnet beside openTorsion 0.3.2 on the same drivetrains, as Markdown.

openTorsion is no dependency. Give it an interpreter of its own and name that::

    python -m venv other && other/bin/pip install opentorsion==0.3.2
    OPENTORSION_PYTHON=other/bin/python python paper/compare_with_opentorsion.py

Both programs solve the same chains and the same geared train in one run, each in a process of its own with one thread;
the table has the largest relative difference of the results and the median times of three runs. Here building the model
counts, there it does not. The exit code is 0 if
all differences are below 1e-6, 3 if one is not, and 4 if openTorsion cannot be imported there.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import torsionnet as tn

CHAIN = 300
LOWEST = 20
"""Modes compared: who looks at a drivetrain wants the lowest."""
FREQUENCIES = np.linspace(1, 300, 500)
LARGEST_DIFFERENCE = 1e-6
RUNS = 3

THEIRS = """
import json, sys, time
import numpy as np
from opentorsion import Assembly, Disk, Gear, Shaft

def chain(n):
    shafts = [Shaft(i, i + 1, k=1e6, c=10.0) for i in range(n - 1)]
    return Assembly(shafts, disk_elements=[Disk(i, I=1.0, c=0.1) for i in range(n)])

def train():
    pinion = Gear(1, I=0.02, R=17)
    wheel = Gear(2, I=0.3, R=40, parent=pinion)
    shafts = [Shaft(0, 1, k=8000.0, c=6.0), Shaft(2, 3, k=5000.0, c=4.0)]
    disks = [Disk(0, I=0.8, c=2.0), Disk(3, I=4.0, c=1.0)]
    return Assembly(shafts, disk_elements=disks, gear_elements=[pinion, wheel])

def response(rotor, omega):
    torque = np.zeros((rotor.M.shape[0], len(omega))); torque[0] = 1.0
    return rotor.ss_response(torque, omega)[0][-1]

def frequencies(rotor):
    return rotor.modal_analysis()[0] / (2 * np.pi)

def timed(work):
    times = []
    for _ in range(runs):
        start = time.perf_counter(); result = work(); times.append(time.perf_counter() - start)
    return result, float(np.median(times))

n, runs, omega, file = int(sys.argv[1]), int(sys.argv[2]), 2 * np.pi * np.array(json.loads(sys.argv[3])), sys.argv[4]
results, seconds = {}, {}
for name, rotor in (("chain", chain(n)), ("train", train())):
    results[name + "_response"], seconds[name + "_response"] = timed(lambda: response(rotor, omega))
    results[name + "_modes"], seconds[name + "_modes"] = timed(lambda: frequencies(rotor))
np.savez(file, **results)
print(json.dumps(seconds))
"""


def chain(n: int) -> tn.Drivetrain:
    """``n`` inertias of 1 kg m² between springs of 1 MN m/rad, each on a damper to ground."""
    elements: list[tn.Element] = [tn.Inertia(f"J{i}", node=f"n{i}", inertia=1) for i in range(n)]
    elements += [tn.Damper(f"c{i}", nodes=(f"n{i}", "ground"), damping=0.1) for i in range(n)]
    elements += [tn.Spring(f"k{i}", nodes=(f"n{i}", f"n{i + 1}"), stiffness=1e6, damping=10) for i in range(n - 1)]
    return tn.Drivetrain("chain", elements)


def train() -> tn.Drivetrain:
    """Motor and load on a pair of wheels with 17 and 40 teeth."""
    return tn.Drivetrain(
        "geared train",
        [
            tn.Inertia("motor", node="n0", inertia=0.8),
            tn.Damper("c0", nodes=("n0", "ground"), damping=2.0),
            tn.Spring("coupling", nodes=("n0", "n1"), stiffness=8000, damping=6),
            tn.Inertia("pinion", node="n1", inertia=0.02),
            tn.Gear("stage", nodes=("n1", "n2"), ratio=-40 / 17),
            tn.Inertia("wheel", node="n2", inertia=0.3),
            tn.Spring("shaft", nodes=("n2", "n3"), stiffness=5000, damping=4),
            tn.Inertia("load", node="n3", inertia=4),
            tn.Damper("c3", nodes=("n3", "ground"), damping=1.0),
        ],
    )


def timed(work: Callable[[], np.ndarray]) -> tuple[np.ndarray, float]:
    """Result of ``work``, and the median of its times in s."""
    times = []
    for _ in range(RUNS):
        start = time.perf_counter()
        result = work()
        times.append(time.perf_counter() - start)
    return result, float(np.median(times))


def response(make: Callable[[], tn.Drivetrain], last: str) -> np.ndarray:
    """Angle of the last node over a torque on the first in rad/(N m), shape (n_f,)."""
    return make().frequency_response(output=last, input="n0", frequencies=FREQUENCIES).values[:, 0, 0]


def frequencies(make: Callable[[], tn.Drivetrain]) -> np.ndarray:
    """Frequencies in Hz of the lowest modes that vibrate, in rising order."""
    return vibrations(make().modes(lowest=LOWEST).natural_frequencies)


def difference(ours: np.ndarray, theirs: np.ndarray) -> float:
    """Largest difference over the largest value of each."""
    return float(np.max(np.abs(ours - theirs) / np.abs(theirs)))


def vibrations(values: np.ndarray) -> np.ndarray:
    """Frequencies in Hz above 1 Hz in rising order: a rigid body on dampers has its own below."""
    return np.sort(values[values > 1.0])


def their_results(folder: str) -> tuple[dict[str, np.ndarray], dict[str, float]]:
    """Results of openTorsion by task, and its times in s. Leaves with exit code 4 without openTorsion."""
    python = os.environ.get("OPENTORSION_PYTHON", sys.executable)
    if subprocess.run([python, "-c", "import opentorsion"], capture_output=True, check=False).returncode:
        sys.stderr.write(f"error: {python} has no openTorsion: pip install opentorsion==0.3.2 there\n")
        sys.exit(4)
    file = Path(folder) / "theirs.npz"
    run = subprocess.run(
        [python, "-c", THEIRS, str(CHAIN), str(RUNS), json.dumps(FREQUENCIES.tolist()), str(file)],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
    )
    with np.load(file) as stored:
        return dict(stored), json.loads(run.stdout)


def main() -> int:
    """Print the table."""
    with tempfile.TemporaryDirectory() as folder:
        theirs, their_seconds = their_results(folder)
    print("| task | largest relative difference | openTorsion, ms | torsionnet, ms | ratio |\n|---|---|---|---|---|")
    good = True
    for name, key, make, last in (
        (f"chain of {CHAIN}", "chain", lambda: chain(CHAIN), f"n{CHAIN - 1}"),
        ("geared train of 4", "train", train, "n3"),
    ):
        swept, swept_s = timed(lambda make=make, last=last: response(make, last))
        modes, modes_s = timed(lambda make=make: frequencies(make))
        theirs_modes = vibrations(theirs[f"{key}_modes"])[::2][: len(modes)]  # two conjugate poles a mode
        for task, apart, here, work in (
            (
                f"{name}, {len(FREQUENCIES)} frequencies",
                difference(swept, theirs[f"{key}_response"]),
                swept_s,
                "response",
            ),
            (f"{name}, lowest modes", difference(modes, theirs_modes), modes_s, "modes"),
        ):
            there = their_seconds[f"{key}_{work}"]
            print(f"| {task} | {apart:.1e} | {1e3 * there:.3g} | {1e3 * here:.3g} | {there / here:.2g} |")
            good = good and apart < LARGEST_DIFFERENCE
    return 0 if good else 3


if __name__ == "__main__":
    sys.exit(main())
