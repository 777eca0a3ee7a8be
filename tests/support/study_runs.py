"""Studies for tests that kill what calculates them: many small chunks, answers, and a program that runs them."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import torsionnet as tn
from torsionnet.study.quantities.evaluator import Evaluator
from torsionnet.study.run import evaluation_memory
from torsionnet.study.run import run_chunks as workload
from torsionnet.study.run.answering import Workers, answer_study
from torsionnet.study.run.run_chunks import run_study
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


def study_of_answers(answers: tuple[str, ...] = ()) -> Study:
    """Nothing but answers that choose their variants themselves: samplings, searches, and one with derivatives."""
    asked = {
        "shares": {"type": "sobol_indices", "quantities": ["f_1", "zeta_1"], "count": 512},
        "rare": {"type": "failure_probability", "method": "subset", "count": 200},
        "worst": {"type": "worst_case", "quantity": "zeta_1", "direction": "smallest", "tried": 500},
        "place": {"type": "optimum", "targets": {"f_1": 6, "zeta_1": 0.1}, "design": DESIGN},
        "lowest": {"type": "optimum", "minimise": "peak", "design": DESIGN},
        "damper": {"type": "best_damper", "input": "T_M", "output": "theta_1", "design": {"c_2": [0.5, 20]}},
        "map": {"type": "map", "x": "k_2", "y": "c_2", "quantity": "f_1", "points": 9},
    }
    return define(
        tn.load("dmf_rig"),
        {"k_2": {"type": "normal", "deviation": "5 %"}, "c_2": {"type": "uniform", "low": "-30 %", "high": "+30 %"}},
        {
            "f_1": {"type": "natural_frequency", "mode": 1},
            "zeta_1": {"type": "damping_ratio", "mode": 1},
            "peak": {"type": "peak", "output": "theta_1", "input": "T_M", "band": "1..20 Hz"},
        },
        limits={"zeta_1": {"above": 0.16}},
        answers={name: asked[name] for name in answers or asked},
    )


DESIGN = {"k_2": [200, 800], "c_2": [1, 10]}


def answers_as_text(study: Study, folder: Path | None = None, workers: Workers | None = None) -> str:
    """All that the answers come to, in full precision."""
    conclusions = answer_study(study, folder, workers=workers).conclusions
    return json.dumps({name: [one.to_data(), one.sentences] for name, one in conclusions.items()})


def slow_and_shared() -> None:
    """Every evaluation takes a while, so that it can be killed, and all that can be shared is."""
    evaluation_memory.LEAST_SHARED_SECONDS = evaluation_memory.LEAST_CALL_SECONDS = 0.0
    rows = Evaluator.rows

    def slowly(self: Evaluator, *asked: Any) -> Any:
        time.sleep(0.01)
        return rows(self, *asked)

    Evaluator.rows = slowly  # type: ignore[method-assign]


def small_chunks() -> None:
    """Chunks of so few variants that there are many."""
    workload.CHUNK_POINTS, workload.LEAST_CHUNK_SIZE = 1, CHUNK


def contents(folder: Path) -> dict[str, bytes]:
    """Bytes of all that a study leaves in its folder."""
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in folder.rglob("*")
        if file.is_file() and not file.name.startswith(".")
    }


def started(folder: Path, processes: int = 1, *words: str) -> subprocess.Popen[bytes]:
    """A program of its own that runs the study, or with the word ``answers`` those named after it, by default all."""
    here = str(Path(__file__).parents[1])
    path = os.pathsep.join([here, str(Path(tn.__file__).parents[1])])
    environment = {**os.environ, "PYTHONPATH": path, "OPENBLAS_NUM_THREADS": "1"}
    return subprocess.Popen(
        [sys.executable, "-m", "support.study_runs", str(folder), str(processes), *words],
        env=environment,
        start_new_session=True,
    )


def processes_of_session(session: int) -> list[int]:
    """Those that a program with a session of its own has started, and itself."""
    processes = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                fields = (entry / "stat").read_text().rpartition(")")[2].split()
            except OSError:
                continue
            if int(fields[3]) == session and fields[0] != "Z":
                processes.append(int(entry.name))
    return processes


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
    workers = Workers(int(sys.argv[2]))
    if "answers" in sys.argv:
        slow_and_shared()
        asked = study_of_answers(tuple(sys.argv[sys.argv.index("answers") + 1 :]))
        Path(sys.argv[1]).with_suffix(".json").write_text(answers_as_text(asked, Path(sys.argv[1]), workers))
        sys.exit()
    with workers.executor(Path(sys.argv[1])) as executor:
        run_study(small_study(), sys.argv[1], executor=executor)
