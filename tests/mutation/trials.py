"""A copy of the checkout in which one module at a time is wrong."""

from __future__ import annotations

import os
import resource
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
OPTIONS = ("-x", "-q", "-m", "not slow", "-p", "mutation.hasty", "-p", "no:cacheprovider", "--tb=no")
COULD_NOT_COLLECT, TOO_LATE = 2, -1
"""Exit codes: pytest's for tests that cannot be imported, after 1 for tests that fail; and one for none at all."""
SPARE = 20.0
"""Seconds by which a run may be late, beside being three times as slow as without a fault."""


@dataclass
class Trials:
    """Runs tests of modules in a copy, with and without faults."""

    root: Path

    def __post_init__(self) -> None:
        self._ticks = count(1)
        self._usual: dict[tuple[str, ...], tuple[float, float]] = {}
        for name in FOLDERS:
            ignored = shutil.ignore_patterns("__pycache__", ".hypothesis")
            shutil.copytree(ROOT / name, self.root / name, ignore=ignored)
        shutil.copy(ROOT / "pyproject.toml", self.root)

    def seconds_without_fault(self, module: str) -> tuple[float, float]:
        """How long the chosen tests take, by the clock and of the processor; they have to pass."""
        chosen = tuple(chosen_for(module)[1:])
        if chosen not in self._usual:
            self._usual[chosen] = self._measured(module)
        return self._usual[chosen]

    def _measured(self, module: str) -> tuple[float, float]:
        began, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
        code, said = self._run(module, None, keep_bytecode=True)
        if code != 0:
            raise SystemExit(f"{module}: its tests fail without a fault\n{said}")
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return time.perf_counter() - began, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def survives(self, mutant: Mutant, limit: float) -> bool:
        """Whether no test fails within the limit in seconds; being too slow is a failure too."""
        path = self.root / mutant.module
        text, stat = path.read_text(encoding="utf-8"), path.stat()
        path.write_text(mutant.applied(text), encoding="utf-8")
        # Bytecode is told apart by whole seconds and size alone.
        os.utime(path, (stat.st_atime, stat.st_mtime + 60 * next(self._ticks)))
        try:
            code, said = self._run(mutant.module, limit)
        finally:
            path.write_text(text, encoding="utf-8")
            os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))
        if code > COULD_NOT_COLLECT:
            raise SystemExit(f"pytest stopped with {code}\n{said}")
        return code == 0

    def _run(self, module: str, limit: float | None, *, keep_bytecode: bool = False) -> tuple[int, str]:
        environment = {**os.environ, "PYTHONPATH": f"{self.root}{os.pathsep}{self.root / 'tests'}"}
        environment |= {"OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}
        environment["PYTHONDONTWRITEBYTECODE"] = "" if keep_bytecode else "1"
        command = [sys.executable, "-m", "pytest", *OPTIONS, *chosen_for(module)]
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
