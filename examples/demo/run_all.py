"""Demonstration of modes, virtual tests, damping fits and reports on both rigs of Galvagno and others (2015).

It is run by ``python examples/demo/run_all.py [FOLDER]``.
"""

from __future__ import annotations

import sys
from pathlib import Path

import figures
import identification
import reports
import rigs


def main(arguments: list[str] | None = None) -> int:
    """Run all demonstrations, write their files to the folder given, and return the exit code."""
    given = sys.argv[1:] if arguments is None else arguments
    folder = Path(given[0] if given else "out")
    folder.mkdir(parents=True, exist_ok=True)
    rigs.show(folder)
    print()
    tests = figures.show(folder)
    print()
    fits = identification.show(folder)
    print()
    reports.show(folder, tests, fits)
    return 0


if __name__ == "__main__":
    sys.exit(main())
