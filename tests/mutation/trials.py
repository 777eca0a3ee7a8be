"""Copies of the checkout in which one module at a time is wrong, and the tests that reach the fault run there."""

from __future__ import annotations

import json
import multiprocessing
import os
import re
import resource
import shutil
import subprocess
import sys
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from itertools import count
from multiprocessing.context import ForkServerContext
from pathlib import Path
from queue import Queue

import numpy as np
import pytest
from reach.reach_map import ReachMap
from reach.recording import ROOT

from mutation.mutants import Mutant

OPTIONS = ("-x", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", "--tb=no", "--hypothesis-profile=hasty")
PRELOADED = ("pytest", "numpy", "scipy.linalg", "scipy.signal", "scipy.optimize", "scipy.sparse.linalg", "sympy")
"""Imported once, in the process from which those of all trials are forked."""
BATCHES = (6.0, 30.0, np.inf)
"""CPU seconds after which the next tests run in a new process: most faults are noticed by the first few, in few files."""
OF_FILE, OF_PLACE = 0.7, 1e-3
"""CPU seconds of collecting a file of tests; and what a test that reaches a further function is set back in the order."""
SLOWER, SPARE = 5.0, 30.0
"""A trial may take so many times the usual CPU time of its tests, and so many seconds more: beyond, the fault was noticed."""


@dataclass(frozen=True)
class Outcome:
    """What the tests that reach a fault said of it: ``noticed``, ``survived``, or ``undecided`` where not all had time to run."""

    mutant: Mutant
    word: str
    by: str = ""
    """The test that failed, or why it is not decided."""

    def __str__(self) -> str:
        return f"{self.word:9} {self.mutant}{f'  [{self.by}]' if self.by else ''}"


@dataclass(frozen=True)
class Trials:
    """Runs tests of faults in copies of the checkout, one for each that runs at a time."""

    folder: Path
    reach: ReachMap
    most: float
    """CPU seconds that the tests of one fault may take together."""
    processes: int = os.cpu_count() or 1

    @cached_property
    def _context(self) -> ForkServerContext:
        for library in ("OPENBLAS", "OMP", "MKL"):
            os.environ[f"{library}_NUM_THREADS"] = "1"
        os.environ |= {"MPLBACKEND": "Agg", "PYTHONDONTWRITEBYTECODE": "1"}
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload(list(PRELOADED))
        return context

    @cached_property
    def _copies(self) -> Queue[Path]:
        """Free copies of all files that git knows, and of new ones it does not ignore."""
        copies: Queue[Path] = Queue()
        names = subprocess.run(
            ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
            cwd=ROOT,
            capture_output=True,
            check=True,
        ).stdout.decode()
        for number in range(self.processes):
            copy = self.folder / str(number)
            for name in filter(None, names.split("\0")):
                if (ROOT / name).exists():
                    (copy / name).parent.mkdir(parents=True, exist_ok=True)
                    shutil.copy2(ROOT / name, copy / name)
            copies.put(copy)
        return copies

    @cached_property
    def _ticks(self) -> Iterator[int]:
        return count(1)

    def outcomes(self, faults: Iterable[Mutant]) -> Iterator[Outcome]:
        """Of each fault, in the order in which they are given."""
        self._copies, self._context  # noqa: B018
        with ThreadPoolExecutor(self.processes) as pool:
            yield from pool.map(self.outcome, faults)

    def outcome(self, mutant: Mutant) -> Outcome:
        """Tests run until the first fails; being far too slow is failing too."""
        numbers = self.reach.reaching(f"{mutant.module}:{mutant.function}")
        if not numbers.size:
            return Outcome(mutant, "undecided", "no test reaches it")
        places = np.diff(self.reach.bounds)[numbers]
        numbers = numbers[np.argsort(self.reach.seconds[numbers] + OF_PLACE * places, kind="stable")]
        within = np.cumsum(self._costs(numbers)) <= self.most
        copy = self._copies.get()
        try:
            with self._wrong(copy, mutant):
                for batch in self._batches(numbers[within | (np.arange(numbers.size) == 0)]):
                    if (failed := self._failed(copy, batch)) is not None:
                        return Outcome(mutant, "noticed", failed)
        finally:
            self._copies.put(copy)
        if within.all():
            return Outcome(mutant, "survived")
        return Outcome(mutant, "undecided", f"{np.sum(~within)} of {numbers.size} tests had no time")

    def _costs(self, numbers: np.ndarray) -> np.ndarray:
        """CPU seconds of tests, of the first of a file with those of collecting it."""
        files = [self.reach.tests[number].partition("::")[0] for number in numbers]
        _, firsts = np.unique(files, return_index=True)
        return np.asarray(self.reach.seconds[numbers] + OF_FILE * np.isin(np.arange(numbers.size), firsts))

    def _batches(self, numbers: np.ndarray) -> Iterator[np.ndarray]:
        """Tests for one process after another, by their time and that of collecting their files."""
        begin, limits = 0, iter(BATCHES)
        limit = next(limits)
        for place, spent in enumerate(np.cumsum(self._costs(numbers))):
            if spent > limit and place > begin:
                yield numbers[begin:place]
                begin, limit = place, next(limits)
        yield numbers[begin:]

    @contextmanager
    def _wrong(self, copy: Path, mutant: Mutant) -> Iterator[None]:
        path = copy / mutant.module
        text, stat = path.read_text(encoding="utf-8"), path.stat()
        path.write_text(mutant.applied(text), encoding="utf-8")
        # Bytecode is told apart by whole seconds and size alone.
        os.utime(path, (stat.st_atime, stat.st_mtime + 60 * next(self._ticks)))
        try:
            yield
        finally:
            path.write_text(text, encoding="utf-8")
            os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))

    def _failed(self, copy: Path, numbers: np.ndarray) -> str | None:
        """The first test that fails, or what ended them; None where all pass."""
        usual = float(np.sum(self.reach.seconds[numbers]))
        said = copy / "said.json"
        said.unlink(missing_ok=True)
        tests = [self.reach.tests[number] for number in numbers]
        while tests:
            run = self._context.Process(target=run_tests, args=(copy, tests, SLOWER * usual + SPARE, said))
            run.start()
            run.join()
            if not said.exists():
                return f"ended by {run.exitcode}, as by being {SLOWER:g} times too slow"
            code, failed, gone = json.loads(said.read_text(encoding="utf-8"))
            if not gone:
                return None if code == 0 else failed or f"pytest ended with {code}"
            tests = [test for test in tests if test not in gone]
        return None


def run_tests(copy: Path, tests: list[str], seconds: float, said: Path) -> None:
    """Tests of a copy in a process of its own, which ends after so many seconds of the processor."""
    os.setsid()
    os.chdir(copy)
    resource.setrlimit(resource.RLIMIT_CPU, (int(seconds), int(seconds) + 5))
    os.environ |= {"PYTHONPATH": f"{copy}{os.pathsep}{copy / 'tests'}"}
    sys.path[:] = [
        str(copy),
        str(copy / "tests"),
        *(path for path in sys.path if not path.startswith(str(ROOT)) or "site-packages" in path),
    ]
    with (copy / "log.txt").open("w", encoding="utf-8") as log:
        os.dup2(log.fileno(), 1)
        os.dup2(log.fileno(), 2)
        first = FirstFailure()
        code = pytest.main([*OPTIONS, *tests], plugins=[first])
    # Tests that have another name since the map was made, for which pytest runs none at all.
    missing = re.findall(rf"not found: {re.escape(str(copy))}/(\S.*)", (copy / "log.txt").read_text(encoding="utf-8"))
    said.write_text(
        json.dumps([int(code), first.name, missing if code == pytest.ExitCode.USAGE_ERROR else []]), encoding="utf-8"
    )


class FirstFailure:
    """For pytest: the name of the test that failed."""

    name = ""

    @pytest.hookimpl(tryfirst=True)
    def pytest_configure(self) -> None:
        """The same examples every time, and no search for the simplest that fails."""
        from hypothesis import Phase, settings

        phases = (Phase.explicit, Phase.generate)
        settings.register_profile("hasty", phases=phases, derandomize=True, database=None, deadline=None)

    def pytest_runtest_logreport(self, report) -> None:
        if report.failed and not self.name:
            self.name = report.nodeid
