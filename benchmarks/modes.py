"""Times of the modes of large damped and undamped chains, as Markdown.

openTorsion 0.3.2 is no dependency: its row needs it in the interpreter named by ``OPENTORSION_PYTHON``
(``python -m venv v; v/bin/pip install opentorsion==0.3.2``).
"""

import os
import platform
from pathlib import Path

import numpy as np

import torsionnet as tn
from benchmarks._sizes import ARGUMENTS, sized
from benchmarks.frequency_response import opentorsion_seconds, seconds

HUGE, SEGMENTS, LARGE, MIDDLE = sized((5000, 1000, 500, 250), (100, 60, 60, 40))


def rig(n, *, damped=True):
    """Chain with J = 1, k = 1e6, c = 10 between neighbours and 0.1 to ground."""
    elements = [tn.Inertia(f"J{i}", node=f"n{i}", inertia=1) for i in range(n)]
    if damped:
        elements += [tn.Damper(f"c{i}", nodes=(f"n{i}", "ground"), damping=0.1) for i in range(n)]
    damping = 10 if damped else 0
    elements += [tn.Spring(f"k{i}", nodes=(f"n{i}", f"n{i + 1}"), stiffness=1e6, damping=damping) for i in range(n - 1)]
    model = tn.Drivetrain("chain", elements)
    _ = model.assembly
    return model


def rows():
    """Rows of the table: task, seconds, seconds of the other program, and the ratio or seconds to reach."""
    huge = rig(HUGE)
    yield f"{HUGE} DOF damped, lowest 20", seconds(lambda: huge.modes(lowest=20), runs=1), None, "<= 3 s"
    one = tn.Shaft("S", nodes=("a", "b"), length=3, outer_diameter=0.05, segments=SEGMENTS)
    shaft = tn.Drivetrain("shaft", [one])
    yield f"a shaft of {SEGMENTS} segments, lowest 20", seconds(lambda: shaft.modes(lowest=20), runs=1), None, "<= 2 s"
    whole = tn.Drivetrain("shaft", [tn.ContinuousShaft("S", nodes=("a", "b"), length=3, outer_diameter=0.05)])
    exact = seconds(lambda: whole.modes(lowest=20), runs=3)
    fine = seconds(lambda: shaft.modes(lowest=20), runs=1)
    yield f"a continuous shaft, lowest 20, against {SEGMENTS} segments (1.5e-4 off in the last)", exact, fine, ""
    chain = rig(LARGE)
    here = seconds(lambda: chain.modes(lowest=20), runs=3)
    there = opentorsion_seconds(LARGE, 1, "modes") if "OPENTORSION_PYTHON" in os.environ else None
    yield f"{LARGE} DOF damped, lowest 20, against openTorsion `modal_analysis` + `eigenmodes`", here, there, ">= 20"
    middle = rig(MIDDLE)
    few, every = seconds(lambda: middle.modes(lowest=20), runs=3), seconds(middle.modes, runs=1)
    yield f"{MIDDLE} DOF damped, lowest 20, against all modes", few, every, ""
    undamped = rig(MIDDLE, damped=False)
    few, every = seconds(lambda: undamped.modes(lowest=20), runs=3), seconds(undamped.modes, runs=1)
    yield f"{MIDDLE} DOF undamped, lowest 20, against all modes", few, every, ""


def table():
    yield "| modes | here, s | other, s | ratio | to reach | |"
    yield "|---|---|---|---|---|---|"
    for name, here, there, goal in rows():
        ratio = there / here if there else None
        cells = [f"{value:.3g}" if value else "" for value in (here, there, ratio)]
        yield f"| {name} | {' | '.join(cells)} | {goal} | {judged(here, ratio, goal)} |"


def judged(here, ratio, goal):
    if goal.startswith("<="):
        return "reached" if here <= float(goal.split()[1]) else "missed"
    if not goal:
        return ""
    if ratio is None:
        return "openTorsion is not installed"
    return "reached" if ratio >= float(goal.split()[1]) else "missed"


def main():
    lines = [
        f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}, numpy {np.__version__}",
        "",
    ]
    print(*lines, sep="\n")
    for line in table():
        print(line, flush=True)
        lines.append(line)
    if ARGUMENTS:
        Path(ARGUMENTS[0]).write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
