"""Figs 2 to 7, 11 and 12 of Galvagno et al. (2015) from a virtual bench: ``python examples/demo/figures.py``."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import torsionnet.plot as plot
from torsionnet import FrequencyResponse
from torsionnet.app.cli.terminal import print_table
from torsionnet.base.conventions import Conventions
from torsionnet.base.table import Column, Table
from torsionnet.bench import Bench, load_bench
from torsionnet.signals import PAPER, Recording, decimate, estimate, spectrogram
from torsionnet.signals.comparison import agreement

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DEGREES = Conventions(angle="deg")
GEARS = ("II", "III", "IV", "V")
BAND = (0.3, 40.0)
"""Lowest and highest frequency in Hz at which the responses are estimated, as in the paper's figures."""

# Text printed below the table of agreements.
REMARKS = """\
The bench is a model: its torque of 15 N*m, 100 s long, 60 Hz of bandwidth and harmonics of 2 and 1.3 % are chosen, as
the paper states none of them; sensors and sampling are the paper's. What these figures show:
* The encoder's 1024 steps a revolution set the limit. Below four steps of amplitude (8 to 11 Hz) the estimate is biased
  by decibels while the coherence still looks well; below half a step (about 22 Hz) the coherence collapses. The paper
  stops at 30 Hz for this reason.
* Gear II at its peak is off by half a dB and 5 degrees: its peak is 2 Hz wide, the narrowest, and the window of 2 s
  smears it (leakage). Windows of 8 s leave 1.5 degrees.
* Torque meter and motor see different torques: at the rig's resonance the meter reads more than the motor gives."""


@dataclass(frozen=True)
class Run:
    """Record of a virtual test, the response estimated from it, and the model's response at the same frequencies."""

    case: str
    record: Recording
    estimated: FrequencyResponse
    model: FrequencyResponse


def run(bench: Bench, case: str) -> Run:
    """Virtual test of a bench, with record, theta_1/T_T estimated by the paper's settings, and the model's response."""
    record = bench.run()
    estimated = estimate(record, "theta_1", "T_T", settings=PAPER).between(*BAND)
    return Run(case, record, estimated, bench.drivetrain.frequency_response("theta_1", "T_T", estimated.frequencies))


def tests() -> Iterator[Run]:
    """Yield a :class:`Run` for the virtual test of the DMF rig, then for that of the AMT rig in each of four gears."""
    yield run(load_bench("dmf_bench"), "DMF")
    amt = load_bench("amt_bench")
    for gear in GEARS:
        yield run(amt.configured(gear), f"AMT {gear}")


def figures(dmf: Run, gears: list[Run]) -> Iterator[tuple[str, Figure]]:
    """File names and figures of the paper's Figs 2 to 7, 11 and 12."""
    labels = [test.case.removeprefix("AMT ") for test in gears]
    slow, amt = decimate(dmf.record, PAPER.decimation), [test.estimated for test in gears]
    yield "fig_02_time_histories", plot.time_histories(dmf.record, ["T_T", "theta_1"], conventions=DEGREES)
    yield "fig_03_spectrogram_torque", plot.spectrogram(spectrogram(slow, "T_T", PAPER_AT_ONCE))
    yield (
        "fig_04_spectrogram_angle",
        plot.spectrogram(spectrogram(slow, "theta_1", PAPER_AT_ONCE), conventions=DEGREES),
    )
    yield "fig_05_dmf_estimate", plot.bode(dmf.estimated, conventions=DEGREES)
    yield (
        "fig_06_amt_estimates",
        plot.bode(amt, labels=labels, conventions=DEGREES, coherence=False, title="AMT test rig, by gear"),
    )
    yield "fig_07_amt_coherence", plot.coherence(amt, labels=labels, title="AMT test rig, by gear")
    yield "fig_11_dmf_test_and_model", plot.comparison(dmf.estimated, dmf.model, conventions=DEGREES)
    yield "fig_12_amt_II_test_and_model", plot.comparison(gears[0].estimated, gears[0].model, conventions=DEGREES)


PAPER_AT_ONCE = type(PAPER)(PAPER.window, PAPER.seconds, PAPER.overlap)
"""Settings of the paper's estimate without its decimation, for a record that is decimated already."""


def agreements(done: list[Run]) -> Table:
    """Table of the largest differences between each estimate and its model in the usable frequency range."""
    columns = (
        Column("case"),
        Column("usable up to", "Hz", 3),
        Column("peak of test", "Hz", 3),
        Column("largest difference", "dB", 2),
        Column("largest difference", "deg", 2),
    )
    rows = []
    for test in done:
        agreed = {row[0]: row for row in agreement(test.estimated, test.model, DEGREES).rows}
        rows.append(
            (
                test.case,
                test.estimated.usable_up_to,
                agreed["largest response of the test"][1],
                abs(agreed["largest difference in magnitude"][2]),
                abs(agreed["largest difference in phase"][2]),
            )
        )
    return Table("Virtual bench against model, theta_1/T_T", columns, tuple(rows))


def show(folder: Path) -> list[Run]:
    """Print how tests and models agree, write the paper's figures to the folder, and return the virtual tests."""
    dmf, *gears = tests()
    print_table(agreements([dmf, *gears]))
    print()
    print(REMARKS)
    print()
    print("Wrote")
    for name, figure in figures(dmf, gears):
        plot.save(figure, folder / f"{name}.png")
        print(f"  {folder / name}.png")
    return [dmf, *gears]


def main(arguments: list[str] | None = None) -> int:
    """Write the paper's figures of tests to the folder given and return the exit code."""
    given = sys.argv[1:] if arguments is None else arguments
    folder = Path(given[0] if given else "out")
    folder.mkdir(parents=True, exist_ok=True)
    show(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
