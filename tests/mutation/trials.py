"""A copy of the checkout in which one module at a time is wrong."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from itertools import count
from pathlib import Path

from mutation.chosen import chosen_for
from mutation.mutants import Mutant

ROOT = Path(__file__).parents[2]
FOLDERS = ("torsionnet", "tests", "library", "benchmarks")
OPTIONS = ("-x", "-q", "-m", "not slow", "-p", "mutation.plugin", "-p", "no:cacheprovider", "--tb=no")
COULD_NOT_COLLECT, TOO_LATE = 2, -1
"""Exit codes: pytest's for tests that cannot be imported, after 1 for tests that fail; and one for none at all."""
SPARE = 20.0
"""Seconds by which a run may be late, beside being three times as slow as without a fault."""


@dataclass
class Trials:
    """Runs tests of modules in a copy, with and without faults."""

    root: Path
    most: float
    """CPU seconds that the tests of one fault may take together."""

    def __post_init__(self) -> None:
        self._ticks = count(1)
        self._usual: dict[str, float] = {}
        self._notes = self.root / "notes.json"
        self._notes.write_text("{}")
        for name in FOLDERS:
            ignored = shutil.ignore_patterns("__pycache__", ".hypothesis")
            shutil.copytree(ROOT / name, self.root / name, ignore=ignored)
        shutil.copy(ROOT / "pyproject.toml", self.root)

    def usual(self, module: str) -> float:
        """Seconds that the tests of a module take without a fault; they have to pass."""
        for tests in chosen_for(module):
            if tests not in self._usual:
                began = time.perf_counter()
                code, said = self._run([tests], None)
                if code != 0:
                    raise SystemExit(f"{tests}: fails without a fault\n{said}")
                self._usual[tests] = time.perf_counter() - began
        return sum(self._usual[tests] for tests in chosen_for(module))

    def survives(self, mutant: Mutant) -> bool:
        """Whether no test fails; being far too slow is a failure too."""
        limit = 3 * self.usual(mutant.module) + SPARE
        path = self.root / mutant.module
        text, stat = path.read_text(encoding="utf-8"), path.stat()
        path.write_text(mutant.applied(text), encoding="utf-8")
        # Bytecode is told apart by whole seconds and size alone.
        os.utime(path, (stat.st_atime, stat.st_mtime + 60 * next(self._ticks)))
        changes = {"MUTATION_FAULTY": f"{mutant.module}:{mutant.function}", "PYTHONDONTWRITEBYTECODE": "1"}
        try:
            code, said = self._run([mutant.module, *chosen_for(mutant.module)], limit, **changes)
        finally:
            path.write_text(text, encoding="utf-8")
            os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))
        if code > COULD_NOT_COLLECT:
            raise SystemExit(f"pytest stopped with {code}\n{said}")
        return code == 0

    def _run(self, tests: list[str], limit: float | None, **changes: str) -> tuple[int, str]:
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
        environment |= {"PYTHONPATH": f"{self.root}{os.pathsep}{self.root / 'tests'}", "OPENBLAS_NUM_THREADS": "1"}
        environment |= {"MPLBACKEND": "Agg", "MUTATION_NOTES": str(self._notes), "MUTATION_MOST": str(self.most)}
        environment |= changes
        command = [sys.executable, "-m", "pytest", *OPTIONS, *tests]
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
        with subprocess.Popen(command, cwd=self.root, env=environment, start_new_session=True, **pipes) as run:
            try:
                said, _ = run.communicate(timeout=limit)
            except subprocess.TimeoutExpired:
                return TOO_LATE, ""
            finally:
                if run.poll() is None:
                    os.killpg(run.pid, signal.SIGKILL)
        return run.returncode, said
