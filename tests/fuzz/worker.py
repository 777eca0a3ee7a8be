"""``python -m fuzz.worker KIND SEED FIRST SECONDS``: tries inputs one after the other and writes a line about each."""

from __future__ import annotations

import json
import os
import random
import resource
import sys
import tempfile
import time
from pathlib import Path

from fuzz import sources
from fuzz.kinds import KINDS, Kind
from fuzz.trying import attempt
from torsionnet.signals.foreign.process import end_all

ENDURED = 12
"""Seconds of processor time after which the system ends this process, to be started again behind the input."""
DATA = 1_500_000_000
"""Bytes of memory, beyond which Python raises."""
RENEWED = 40
"""Inputs after which the process that reads binary files is ended, so that its time is counted."""


def content(kind: Kind, seed: str, number: int, folder: Path) -> bytes:
    """The input of that number: the same at any time."""
    return kind.make(random.Random(f"{seed} {kind.name} {number}"), folder)


def main(name: str, seed: str, first: int, seconds: float) -> None:
    kind, told = KINDS[name], os.fdopen(os.dup(1), "w")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        sources.furnish(folder)
        path = folder / f"input{kind.ending}"
        path.write_bytes(kind.sound(folder))
        kind.use(path)  # loads the modules, which is not counted
        number, until = first, time.monotonic() + seconds
        while time.monotonic() < until:
            path.write_bytes(content(kind, seed, number, folder))
            told.write(json.dumps({"begin": number}) + "\n")
            told.flush()
            _limit()
            told.write(json.dumps(attempt(kind, path, number).to_data()) + "\n")
            number += 1
            if number % RENEWED == 0:
                end_all()
    told.write(json.dumps({"done": number}) + "\n")
    told.flush()


def _limit() -> None:
    used = resource.getrusage(resource.RUSAGE_SELF)
    resource.setrlimit(resource.RLIMIT_CPU, (int(used.ru_utime + used.ru_stime) + ENDURED, resource.RLIM_INFINITY))
    resource.setrlimit(resource.RLIMIT_DATA, (DATA, resource.RLIM_INFINITY))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]), float(sys.argv[4]))
