"""Phases one after another or side by side, until one fails; a table of what each took, and a verdict on the sum."""

from __future__ import annotations

import os
import re
import signal
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from support import fixed_work

ROOT = Path(__file__).parents[2]
PYTHON = ROOT / ".venv" / "bin" / "python"
ALLOWED = 1.25
"""A run may take so many times what it takes on a quiet machine: what `fixed_work` cannot see of a machine stays below."""
LACKING = b"skipped for want of a tool"


FOREIGN = {"PYTHONPATH", "MAKEFLAGS", "MFLAGS", "MAKEOVERRIDES", "MAKELEVEL", "ARGS", "SECONDS", "KERNEL", "MARKED"}
"""What `make test-nightly ARGS=reached` would hand to the targets of all phases."""


@dataclass(frozen=True)
class Phase:
    """One command."""

    name: str
    command: tuple[str, ...]
    quiet: float | None = None
    """Processor seconds on the quiet machine; None where they are not the project's, and do not count."""
    brings_tools: bool = False
    """It may fail. If it does not, no test may be left out for want of a tool."""


Lane = Sequence[Phase]
Step = Sequence[Lane]
"""Lanes run side by side, for phases that keep one core busy."""


def make(target: str, quiet: float | None, *words: str, name: str = "") -> Phase:
    """Phase of a target of the Makefile."""
    return Phase(name or target, ("make", target, *words), quiet)


@dataclass
class Row:
    """What a phase took."""

    phase: Phase
    wall: float
    processor: float
    said: bytes
    code: int

    @property
    def note(self) -> str:
        """What pytest says last, with the number of tests."""
        lines = re.findall(r"^.*\d+ passed.*$", self.said.decode(errors="replace"), re.MULTILINE)
        return lines[-1].strip("= ") if lines else ""


@dataclass
class Run:
    """Steps that are carried out, with what was measured so far."""

    title: str
    limit: float
    """Processor seconds of all phases on the quiet machine."""
    rows: list[Row] = field(default_factory=list)
    slowness: list[float] = field(default_factory=list)
    fault: str = ""

    def __post_init__(self) -> None:
        self._running: set[subprocess.Popen[bytes]] = set()
        self._lock = threading.Lock()
        self._complete = False
        self._began = time.monotonic()

    def carry_out(self, steps: Iterable[Step]) -> int:
        """Exit code after all steps, or after the first phase that fails; the table is printed in any case."""
        signal.signal(signal.SIGTERM, signal.default_int_handler)  # what runs is ended, too
        try:
            for step in steps:
                self._step(step)
                if self.fault:
                    break
                self._time_fixed_work()
        except KeyboardInterrupt:
            self.fault = "interrupted"
        finally:
            self._stop()
        if not self.fault and self.total > ALLOWED * self.limit:
            self.fault = f"{self.total:.0f} s of the processor, at most {ALLOWED * self.limit:.0f} s are allowed"
        print(self.table(), flush=True)
        return bool(self.fault)

    @property
    def factor(self) -> float:
        """How much slower than the quiet machine this one was."""
        return statistics.median(self.slowness) if self.slowness else 1.0

    @property
    def total(self) -> float:
        """Processor seconds of the phases that count, as on the quiet machine."""
        return sum(row.processor for row in self.rows if row.phase.quiet is not None) / self.factor

    def table(self) -> str:
        """One line for each phase, and the sums."""
        lines = [f"== {self.title}", f"{'phase':22s}{'wall s':>8s}{'CPU s':>8s}{'as quiet':>10s}{'target':>8s}"]
        for row in self.rows:
            numbers = f"{row.phase.name:22s}{row.wall:8.0f}{row.processor:8.0f}"
            if row.phase.quiet is not None:
                numbers += f"{row.processor / self.factor:10.0f}{row.phase.quiet:8.0f}"
            lines.append(f"{numbers:56s}  {row.note}".rstrip())
        processor = sum(row.processor for row in self.rows)
        wall = time.monotonic() - self._began
        lines.append(f"{'all, without tools':22s}{wall:8.0f}{processor:8.0f}{self.total:10.0f}{self.limit:8.0f}")
        if self.slowness:
            spread = f"{min(self.slowness):.2f} to {max(self.slowness):.2f}"
            lines.append(
                f"A fixed piece of work took {self.factor:.2f} times as long as on a quiet machine ({spread})."
            )
        lines.append(f"== FAILED: {self.fault}" if self.fault else "== all phases ok")
        return "\n".join(lines)

    def _step(self, lanes: Step) -> None:
        if len(lanes) == 1:
            return self._lane(lanes[0], streams=True)
        names = ", ".join(phase.name for lane in lanes for phase in lane)
        print(f"== side by side, each shown when it ends: {names}", flush=True)
        with ThreadPoolExecutor(len(lanes)) as pool:
            for done in [pool.submit(self._lane, lane, streams=False) for lane in lanes]:
                done.result()
        return None

    def _lane(self, phases: Lane, *, streams: bool) -> None:
        for phase in phases:
            if self.fault:
                return
            if streams:
                print(f"== {phase.name}", flush=True)
            row = self._run(phase, streams=streams)
            with self._lock:
                if self.fault:  # what another lane ended says nothing
                    return
                self._judge(row, streams=streams)

    def _judge(self, row: Row, *, streams: bool) -> None:
        phase = row.phase
        self.rows.append(row)
        if not streams:
            print(f"== {phase.name}", flush=True)
            _show(row.said)
        if phase.brings_tools:
            self._complete = row.code == 0
        elif row.code:
            self.fault = f"phase {phase.name} (exit code {row.code})"
        elif self._complete and LACKING in row.said:
            self.fault = f"phase {phase.name}: tests {LACKING.decode()}"
        if self.fault:
            self._stop()
        else:
            print(f"== {phase.name}: ok, {row.wall:.0f} s", flush=True)

    def _run(self, phase: Phase, *, streams: bool) -> Row:
        environment = {name: value for name, value in os.environ.items() if name not in FOREIGN}
        environment |= {"CI": "true", "NO_COLOR": "1"}
        began, said = time.monotonic(), b""
        with subprocess.Popen(
            phase.command, cwd=ROOT, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
        ) as process:  # fmt: skip
            self._running.add(process)
            if self.fault:  # another lane failed while this phase began, and ended those that ran by then
                process.terminate()
            assert process.stdout is not None
            while chunk := os.read(process.stdout.fileno(), 65536):
                said += chunk
                if streams:
                    _show(chunk)
            # Children that have ended count, with theirs.
            _, status, usage = os.wait4(process.pid, 0)
            self._running.discard(process)
            process.returncode = os.waitstatus_to_exitcode(status)
        return Row(phase, time.monotonic() - began, usage.ru_utime + usage.ru_stime, said, process.returncode)

    def _stop(self) -> None:
        for process in list(self._running):
            process.terminate()

    def _time_fixed_work(self) -> None:
        if PYTHON.exists():
            self.slowness.append(fixed_work.slowness(PYTHON))


def _show(text: bytes) -> None:
    sys.stdout.buffer.write(text)
    sys.stdout.buffer.flush()
