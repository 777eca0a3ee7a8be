"""CPU times (user + system, median of five processes) of the most frequent commands, against their budgets."""

import os
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from benchmarks._sizes import sized

ROOT = Path(__file__).parents[1]
STUDY = """
torsionnet: 1
name: two stiffnesses
model: amt_rig
configurations: [V]
vary:
  k_1: {type: list, values: [400 N*m/rad, 500 N*m/rad]}
quantities:
  f_1: {type: natural_frequency, mode: 1}
"""
RUNS = sized(5, 1)
BUDGETS = {
    "--help": 0.1,
    "check dmf_rig": 0.2,
    "check amt_rig": 0.2,
    "modes dmf_rig": 0.5,
    "modes amt_rig --configuration V": 0.5,
    "study two_stiffnesses.yaml": 1.0,
}


def cpu_seconds(command, environment):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, capture_output=True, cwd=ROOT, env=environment)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def median_of(command, environment):
    cpu_seconds(command, environment)  # writes the bytecode that an installed package already has
    return statistics.median(cpu_seconds(command, environment) for _ in range(RUNS))


def main():
    with tempfile.TemporaryDirectory() as cache:
        environment = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
        environment["PYTHONPYCACHEPREFIX"] = cache
        study = Path(cache) / "two_stiffnesses.yaml"
        study.write_text(STUDY, encoding="utf-8")
        rows = {
            f"torsionnet {arguments}": (
                median_of(
                    [sys.executable, "-m", "torsionnet", *arguments.replace(study.name, str(study)).split()],
                    environment,
                ),
                budget,
            )
            for arguments, budget in BUDGETS.items()
        }
        bare = median_of([sys.executable, "-c", "pass"], environment)
        numpy = median_of([sys.executable, "-c", "import numpy"], environment)
    print("| command | CPU s | budget s | |")
    print("|---|---|---|---|")
    for command, (seconds, budget) in rows.items():
        print(f"| `{command}` | {seconds:.3f} | {budget:g} | {'' if seconds < budget else 'over'} |")
    print(f"| Python alone | {bare:.3f} | | |")
    print(f"| `import numpy` alone | {numpy:.3f} | | |")


if __name__ == "__main__":
    main()
