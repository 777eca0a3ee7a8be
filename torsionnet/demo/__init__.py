"""Demonstration of modes, virtual tests, damping fits and reports on both rigs of Galvagno and others (2015).

It is run by ``python -m torsionnet.demo [FOLDER]``.
"""

from __future__ import annotations

import sys
from pathlib import Path


def main(arguments: list[str] | None = None) -> int:
    """Run all demonstrations, write their files to the folder given, and return the exit code."""
    import torsionnet.demo.figures as figures
    import torsionnet.demo.identification as identification
    import torsionnet.demo.reports as reports
    import torsionnet.demo.rigs as rigs

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


__all__ = ["main"]
