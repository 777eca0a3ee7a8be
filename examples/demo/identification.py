"""Damping of both rigs identified as in the paper: ``python examples/demo/identification.py [FOLDER]``.

Galvagno et al. (2015) fit the flywheel's c_2 by hand, and c_O and c_B of the transmission by least squares over gears
II, III and IV. Here records of virtual tests are fitted, whose true values are known.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import torsionnet.plot as plot
from torsionnet.app.cli.terminal import print_table
from torsionnet.base.conventions import Conventions
from torsionnet.bench import Bench, load_bench
from torsionnet.bench.plan import Encoder
from torsionnet.drivetrain import load
from torsionnet.identification import Fit, Measurement, identify
from torsionnet.signals import PAPER

TRUE_VALUES = {"c_2": 4.0, "c_O": 170.0, "c_B": 1.5}
"""Damping of the library models in N m s/rad, which the virtual tests have."""
START_VALUES = {"c_2": 8.0, "c_O": 80.0, "c_B": 4.0}
"""Damping in N m s/rad from which the fits start: wrong by a factor of 2 to 3."""
GEARS = ("II", "III", "IV")
QUADRATURE_ENCODER = Encoder(lines=1024, quadrature=True)

# Text printed below the tables of the fits.
REMARKS = """\
The fits predict the output from the measured torque, and estimate prediction and test alike (windows of 2 s, H1), so
leakage does not bias them. Alone, no gear tells c_O from c_B: only c_B + c_O/tau^2 acts. Records are those of the
library's benches with the encoder in quadrature; how often the intervals hold the truth is on the validation page."""


def with_quadrature(bench: Bench) -> Bench:
    """Copy of a bench with its encoder in quadrature."""
    channels = {**bench.plan.channels, "theta_1": QUADRATURE_ENCODER}
    return replace(bench, plan=replace(bench.plan, channels=channels))


def flywheel() -> Fit:
    """Fit of the damping c_2 in N m s/rad of the DMF rig to a virtual test."""
    test = Measurement(with_quadrature(load_bench("dmf_bench")).run(), "theta_1", "T_T", settings=PAPER, name="DMF")
    return identify(load("dmf_rig"), test, {"c_2": START_VALUES["c_2"]})


def transmission(gears: tuple[str, ...] = GEARS) -> Fit:
    """Fit of the damping c_O and c_B in N m s/rad of the AMT rig to virtual tests in several gears at once."""
    bench = with_quadrature(load_bench("amt_bench"))
    tests = [Measurement(bench.configured(gear).run(), "theta_1", "T_T", gear, settings=PAPER) for gear in gears]
    return identify(load("amt_rig"), tests, {name: START_VALUES[name] for name in ("c_O", "c_B")})


def show(folder: Path) -> dict[str, Fit]:
    """Print fitted and true values, write the pictures to the folder, and return the fits."""
    fits = {"fit_dmf": flywheel(), "fit_amt": transmission()}
    for fit in fits.values():
        print_table(fit.table(true=TRUE_VALUES))
        print()
    print("In gear II alone:", *transmission(("II",)).verdicts, sep="\n  ")
    print()
    print(REMARKS)
    print()
    print("Wrote")
    for name, fit in fits.items():
        path = folder / f"{name}.png"
        plot.save(plot.fit(fit, conventions=Conventions(angle="deg")), path)
        print(f"  {path}")
    return fits


def main(arguments: list[str] | None = None) -> int:
    """Fit both rigs, write the pictures to the folder given, and return the exit code."""
    given = sys.argv[1:] if arguments is None else arguments
    folder = Path(given[0] if given else "out")
    folder.mkdir(parents=True, exist_ok=True)
    show(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
