"""What the calls for which the package exists load and pass: modules, code lines, functions and files.

``python -m structure.core_use`` names the modules that they load in vain and the files that one of them passes.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import NamedTuple

from structure.modules import Module, modules_below

ROOT = Path(__file__).parents[2]
FOUR_CALLS = """
rig = tn.load("amt_rig").configured("V")
rig.modes()
rig.frequency_response("theta_1", "T_T", np.array([1.0, 5.0, 20.0]))
str(rig.symbolic().transfer_function("theta_1", "T_T"))
"""
"""Load, modes, measured-input response, symbolic transfer function."""
ONE_RESPONSE = """
tn.load("dmf_rig").frequency_response("theta_1", "T_T", np.array([1.0, 5.0, 20.0]))
"""
"""Load and one measured-input response, the way that a reader of the core walks first."""
OF_BOTH_RIGS = FOUR_CALLS + FOUR_CALLS.replace('tn.load("amt_rig").configured("V")', 'tn.load("dmf_rig")')
PROGRAM = """
import json, sys, time
import numpy as np
started, called = time.process_time(), set()
def watch(frame, event, _):
    code = frame.f_code
    # bodies of classes are not optimised code, lambdas are named <lambda>
    if event == "call" and code.co_flags & 1 and code.co_name[0] != "<":
        called.add((code.co_filename, code.co_qualname))
if {watched}:
    sys.setprofile(watch)
import torsionnet as tn
{calls}
sys.setprofile(None)
files = {{one.__file__ for name, one in sys.modules.items() if name.split(".")[0] == "torsionnet"}}
print(json.dumps([sorted(files), sorted(called), time.process_time() - started]))
"""


class Use(NamedTuple):
    """Modules that calls load, functions of them that run, by file and name, and the CPU seconds that they take."""

    loaded: list[Module]
    functions: list[tuple[str, str]]
    seconds: float

    @property
    def code_lines(self) -> int:
        return sum(module.code_lines for module in self.loaded)

    @property
    def files(self) -> set[str]:
        return {file for file, _ in self.functions}

    @property
    def idle(self) -> list[str]:
        """Modules with functions, none of which ran."""
        return [one.relative for one in self.loaded if one.has_functions and one.relative not in self.files]


def use_of(calls: str, root: Path = ROOT, *, watched: bool = True) -> Use:
    """What some calls of the package in a checkout load and run in a fresh process."""
    program = PROGRAM.format(calls=calls, watched=watched)
    done = subprocess.run([sys.executable, "-c", program], cwd=root, check=True, capture_output=True, text=True)
    files, called, seconds = json.loads(done.stdout)
    modules = {str(module.path): module for module in modules_below(root / "torsionnet")}
    functions = [(modules[file].relative, name) for file, name in called if file in modules]
    return Use([modules[file] for file in files if file in modules], functions, seconds)


def use_measures(root: Path) -> dict[str, str]:
    """Names and values of what ``make structure`` prints of the core."""
    four, response = use_of(FOUR_CALLS, root), use_of(ONE_RESPONSE, root)
    seconds = min(use_of(FOUR_CALLS, root, watched=False).seconds for _ in range(5))
    return {
        "four calls on amt_rig: modules, code lines": f"{len(four.loaded)}, {four.code_lines}",
        "their CPU seconds, least of 5": f"{seconds:.2f}",
        "dmf_rig, load and response: functions, files": f"{len(response.functions)}, {len(response.files)}",
        "modules loaded of which nothing runs, both rigs": str(len(use_of(OF_BOTH_RIGS, root).idle)),
    }


def main() -> None:
    for relative in use_of(OF_BOTH_RIGS).idle:
        print(f"no function runs: {relative}")
    passed = Counter(file for file, _ in use_of(ONE_RESPONSE).functions)
    for file, count in passed.most_common():
        print(f"{count:4d} {file}")


if __name__ == "__main__":
    main()
