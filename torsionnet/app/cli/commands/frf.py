"""Command ``torsionnet frf``, which calculates frequency responses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from torsionnet.app.cli.cases import ConfiguredCase, ModelCommand
from torsionnet.app.cli.command import TABLE, Answer, click_command
from torsionnet.app.cli.options import ANGLE, FREQUENCY_UNIT, REFERRED_TO, option, referred_outputs
from torsionnet.app.cli.terminal import message
from torsionnet.base.errors import UsageError

if TYPE_CHECKING:
    from torsionnet.base.table import Table
    from torsionnet.linear.frequency_response import FloatArray, FrequencyResponse
    from torsionnet.linear.responses.grid import Solver

QUANTITIES = ("receptance", "mobility", "accelerance", "dynamic_stiffness")


class FrfCommand(ModelCommand):
    """Frequency responses: static value and peaks on the screen, every frequency in files.

    \b
    torsionnet frf dmf_rig --output theta_1 --input T_T --angle deg --plot bode.png
    torsionnet frf amt_rig -c all --output theta_1 --input T_M --from 0.3 --to 40 --csv gears.csv
    """

    forms = TABLE
    picture = "a Bode plot"

    outputs: tuple[str, ...] = option(
        "--output",
        metavar="NAME",
        required=True,
        help='Sensor or node, or "torque(gearbox, output_shaft)". Repeatable.',
    )
    inputs: tuple[str, ...] = option(
        "--input",
        metavar="NAME",
        required=True,
        help="Input or node (a torque there), or a sensor: a measured input. Repeatable.",
    )
    excitations: tuple[str, ...] = option(
        "--excitation",
        metavar="INPUT",
        help="What drives the drivetrain while the input is measured, if it has several inputs.",
    )
    start: float | None = option("--from", help="Lowest frequency; default: from the modes.")
    stop: float | None = option("--to", help="Highest frequency.")
    points: int | None = option(
        "--points", type=click.IntRange(2, 1_000_000), help="How many frequencies.  [default: 500]"
    )
    logarithmic: bool | None = option(
        "--log/--linear", default=None, help="Spacing; default: logarithmic over more than a decade."
    )
    listed: str | None = option(
        "--frequencies", metavar="LIST", help='"0.1:40:0.1" (start:stop:step) or "1,2,5" instead.'
    )
    frequency_unit: str = FREQUENCY_UNIT
    referred_to: str | None = REFERRED_TO
    quantity: str | None = option("--quantity", type=click.Choice(QUANTITIES), help="Default: as the sensor measures.")
    angle: str = ANGLE
    decibels: bool = option("--db", help="Magnitudes in dB re 1 of their unit.")
    full: bool = option("--full", help="Print every frequency instead of static value and peaks.")

    def answer(self) -> Answer:
        cases = self.cases()
        from torsionnet.app.cli.frf_output import DisplayUnits, Sampling, full_table, peak_table, responses_record
        from torsionnet.base.conventions import Conventions

        shown = DisplayUnits(Conventions(angle=self.angle, frequency=self.frequency_unit), self.decibels)
        sampling = Sampling(self.start, self.stop, self.points, self.logarithmic, self.listed)
        frequencies = sampling.frequencies(cases, shown.conventions.frequency_scale)
        cases, solvers, responses = _answered(self, cases, frequencies)
        trios = list(zip(cases, responses, solvers, strict=True))

        def full() -> list[Table]:
            return [full_table(response, shown) for response in responses]

        def brief() -> list[Table]:
            return [peak_table(response, solve, shown) for _, response, solve in trios]

        return Answer(
            screen=lambda: [self.combined_table(cases, full() if self.full else brief())],
            data=lambda: [responses_record(*trio, shown.conventions) for trio in trios],
            csv=lambda: [("", self.combined_table(cases, full()))],
            figures=lambda plot: [("", plot.bode(responses, conventions=shown.conventions, decibels=self.decibels))],
        )

    def solver(self, case: ConfiguredCase) -> Solver:
        def solve(frequencies: FloatArray) -> FrequencyResponse:
            response = case.drivetrain.frequency_response(
                referred_outputs(self.outputs, self.referred_to),
                list(self.inputs),
                frequencies,
                excitation=list(self.excitations) or None,
            )
            return getattr(response, self.quantity)() if self.quantity else response

        return solve


def _answered(
    request: FrfCommand, cases: list[ConfiguredCase], frequencies: FloatArray
) -> tuple[list[ConfiguredCase], list[Solver], list[FrequencyResponse]]:
    """Cases that have the outputs and inputs asked for, functions that solve them, and their frequency responses.

    Notes name the cases left out.
    """
    found: list[tuple[ConfiguredCase, Solver, FrequencyResponse]] = []
    refusals: dict[str, UsageError] = {}
    for case in cases:
        solve = request.solver(case)
        try:
            found.append((case, solve, solve(frequencies)))
        except UsageError as error:
            refusals[case.configuration] = error
    if not found:
        raise next(iter(refusals.values()))
    for name, refusal in refusals.items():
        message("note", f"configuration {name} is left out: {refusal}")
    left, solvers, responses = zip(*found, strict=True)
    return list(left), list(solvers), list(responses)


command = click_command("frf", FrfCommand)
