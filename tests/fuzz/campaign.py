"""All kinds in turn, each for some seconds in a process of its own, which is started again when an input ends it."""

from __future__ import annotations

import json
import os
import selectors
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import torsionnet as tn
from fuzz.trying import Trial

TESTS = Path(__file__).parents[1]
TURN = 40.0
"""Seconds of one kind at a time."""
SILENCE = 60.0
"""Seconds without a word, after which a process is ended."""


def trials(names: list[str], seed: str, seconds: float) -> Iterator[tuple[str, Trial]]:
    """Kinds and what came of their inputs, until the time is over; every kind has had its turn by then."""
    began, following = time.monotonic(), dict.fromkeys(names, 0)
    turn = min(TURN, seconds / len(names))
    while True:
        for name in names:
            for trial in _turn(name, seed, following[name], turn):
                following[name] = trial.number + 1
                yield name, trial
        if time.monotonic() - began >= seconds:
            return


def _turn(name: str, seed: str, first: int, seconds: float) -> Iterator[Trial]:
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        running = _Worker(name, seed, first, until - time.monotonic())
        yield from running.trials()
        if running.is_done:
            return
        if running.at is None:
            raise SystemExit(f"{name}: the process ended before its first input ({running.ending})")
        yield Trial(running.at, "failure", running.ending)
        first = running.at + 1


class _Worker:
    """A process and the input that it tries."""

    def __init__(self, name: str, seed: str, first: int, seconds: float) -> None:
        root = Path(tn.__file__).parents[1]
        paths = os.pathsep.join([str(root), str(TESTS), *filter(None, [os.environ.get("PYTHONPATH")])])
        self.at: int | None = None
        self.is_done = False
        self.ending = ""
        self.process = subprocess.Popen(
            [sys.executable, "-m", "fuzz.worker", name, seed, str(first), f"{seconds:.1f}"],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=os.environ | {"PYTHONPATH": paths, "OPENBLAS_NUM_THREADS": "1"},
        )  # fmt: skip

    def trials(self) -> Iterator[Trial]:
        for line in self._lines():
            said = json.loads(line)
            if "begin" in said:
                self.at = said["begin"]
            elif "done" in said:
                self.is_done = True
            else:
                yield Trial(**said)
        self.ending = self.ending or _words(self.process.wait())

    def _lines(self) -> Iterator[bytes]:
        assert self.process.stdout is not None
        rest = b""
        with selectors.DefaultSelector() as selector, self.process:
            selector.register(self.process.stdout, selectors.EVENT_READ)
            while True:
                if not selector.select(SILENCE):
                    self.ending = f"no answer in {SILENCE:.0f} s"
                    self.process.kill()
                    return
                read = os.read(self.process.stdout.fileno(), 1 << 16)
                if not read:
                    return
                *lines, rest = (rest + read).split(b"\n")
                yield from lines


def _words(code: int) -> str:
    if code == -signal.SIGXCPU:
        return "more than 12 s of processor time"
    return f"process ended by {signal.Signals(-code).name}" if code < 0 else f"process ended with {code}"
