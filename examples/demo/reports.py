"""Reports on both rigs, with the virtual tests and the fits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from figures import Run

from torsionnet.report import write_report

if TYPE_CHECKING:
    from torsionnet.identification import Fit


def show(folder: Path, tests: Sequence[Run], fits: Mapping[str, Fit]) -> None:
    """Write the reports of both rigs to the folder and print their paths."""
    dmf, *gears = tests
    measured = {test.case.removeprefix("AMT "): test.estimated for test in gears}
    print("Wrote")
    for rig, responses, fit in (("dmf", [dmf.estimated], fits["fit_dmf"]), ("amt", measured, fits["fit_amt"])):
        path = folder / f"{rig}_report.html"
        write_report(f"{rig}_rig", path, tests=responses, fits=[fit])
        print(f"  {path}")
