"""The command line of the package, called as ``torsionnet COMMAND ...``; also as ``python -m torsionnet``.

Results go to stdout, messages to stderr. Exit codes: 0 done, 1 wrong model, 2 wrong usage, 3 no numerical answer,
4 missing package, 70 a bug, 74 a file that cannot be written, 130 interrupted.
"""

from __future__ import annotations

import gc
import os
from collections.abc import Sequence

OBJECTS_BETWEEN_COLLECTIONS = 200_000
"""New objects between two runs of the garbage collector, as fewer slow down starting and more take memory."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line and return its exit code; default: the arguments of the process."""
    gc.set_threshold(OBJECTS_BETWEEN_COLLECTIONS)  # a short process: starting up leaves next to no garbage
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # starting threads costs more than small matrices gain
    try:
        from torsionnet.app.cli.app import run

        return run(arguments)
    except KeyboardInterrupt:
        return 130
