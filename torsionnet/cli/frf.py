"""``torsionnet frf``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import click

from torsionnet.cli.cases import ConfiguredCase, joined, load_cases
from torsionnet.cli.options import csv_option, frequency_unit_option, json_option, model_options, plot_option
from torsionnet.cli.terminal import message, print_json, print_table, wrote
from torsionnet.core.errors import UsageError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from torsionnet.cli.frf_output import Shown
    from torsionnet.response import FrequencyResponse
    from torsionnet.response.frequency_response import FloatArray
    from torsionnet.solve.peaks import Solver

QUANTITIES = ("receptance", "mobility", "accelerance", "dynamic_stiffness")


@dataclass(frozen=True)
class FrfRequest:
    """What is asked of every case."""

    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    excitations: tuple[str, ...]
    quantity: str | None

    def solver(self, case: ConfiguredCase) -> Solver:
        def solve(frequencies: FloatArray) -> FrequencyResponse:
            response = case.drivetrain.frequency_response(
                list(self.outputs), list(self.inputs), frequencies, excitation=list(self.excitations) or None
            )
            return getattr(response, self.quantity)() if self.quantity else response

        return solve


@click.command("frf")
@model_options
@click.option(
    "--output",
    "outputs",
    metavar="NAME",
    multiple=True,
    required=True,
    help='Sensor or node, or "torque(gearbox, output_shaft)". Repeatable.',
)
@click.option(
    "--input",
    "inputs",
    metavar="NAME",
    multiple=True,
    required=True,
    help="Input or node (a torque there), or a sensor: a measured input. Repeatable.",
)
@click.option(
    "--excitation",
    "excitations",
    metavar="INPUT",
    multiple=True,
    help="What drives the drivetrain while the input is measured, if it has several inputs.",
)
@click.option("--from", "start", type=float, help="Lowest frequency; default: from the modes.")
@click.option("--to", "stop", type=float, help="Highest frequency.")
@click.option("--points", type=click.IntRange(2, 1_000_000), help="How many frequencies.  [default: 500]")
@click.option(
    "--log/--linear", "logarithmic", default=None, help="Spacing; default: logarithmic over more than a decade."
)
@click.option("--frequencies", "listed", metavar="LIST", help='"0.1:40:0.1" (start:stop:step) or "1,2,5" instead.')
@frequency_unit_option
@click.option("--quantity", type=click.Choice(QUANTITIES), help="Default: as the sensor measures.")
@click.option("--angle", type=click.Choice(["rad", "deg"]), default="rad", show_default=True, help="Unit of angles.")
@click.option("--db", "decibels", is_flag=True, help="Magnitudes in dB re 1 of their unit.")
@click.option("--full", is_flag=True, help="Print every frequency instead of static value and peaks.")
@json_option
@csv_option
@plot_option("a Bode plot")
def command(
    model: str,
    configurations: tuple[str, ...],
    settings: tuple[tuple[str, str], ...],
    outputs: tuple[str, ...],
    inputs: tuple[str, ...],
    excitations: tuple[str, ...],
    start: float | None,
    stop: float | None,
    points: int | None,
    logarithmic: bool | None,
    listed: str | None,
    frequency_unit: str,
    quantity: str | None,
    angle: str,
    decibels: bool,
    full: bool,
    as_json: bool,
    csv_file: str | None,
    plot_file: str | None,
) -> None:
    """Frequency responses: static value and peaks on the screen, every frequency in files.

    \b
    torsionnet frf dmf_rig --output theta_1 --input T_T --angle deg --plot bode.png
    torsionnet frf amt_rig -c all --output theta_1 --input T_M --from 0.3 --to 40 --csv gears.csv
    """
    cases = load_cases(model, configurations, settings)
    from torsionnet.cli.frf_output import Shown, as_data, full_table, peak_table
    from torsionnet.cli.sampling import Sampling
    from torsionnet.response import Conventions

    shown = Shown(Conventions(angle=angle, frequency=frequency_unit), decibels)
    sampling = Sampling(start, stop, points, logarithmic, listed)
    frequencies = sampling.frequencies(cases, shown.conventions.frequency_scale)
    request = FrfRequest(outputs, inputs, excitations, quantity)
    cases, solvers, responses = _answered(request, cases, frequencies)
    picture = _picture(responses, shown) if plot_file else None  # refuses unlike units before anything is printed
    if csv_file:
        tables = [full_table(response, shown) for response in responses]
        joined(cases, tables, named=bool(configurations)).to_csv(csv_file)
        wrote(csv_file)
    if plot_file and picture:
        import torsionnet.plot as plot

        plot.save(picture, plot_file)
        wrote(plot_file)
    if as_json:
        print_json([as_data(*trio, shown.conventions) for trio in zip(cases, responses, solvers, strict=True)])
    else:
        tables = [
            full_table(response, shown) if full else peak_table(response, solve, shown)
            for response, solve in zip(responses, solvers, strict=True)
        ]
        print_table(joined(cases, tables, named=bool(configurations)))


def _answered(
    request: FrfRequest, cases: list[ConfiguredCase], frequencies: FloatArray
) -> tuple[list[ConfiguredCase], list[Solver], list[FrequencyResponse]]:
    """The cases that have what is asked for; the others are named, unless there is none."""
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


def _picture(responses: list[FrequencyResponse], shown: Shown) -> Figure:
    import torsionnet.plot as plot

    return plot.bode(responses, conventions=shown.conventions, decibels=shown.decibels)
