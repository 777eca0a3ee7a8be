"""``torsionnet compare``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from torsionnet.cli.options import csv_option, json_option, model_options, plot_option
from torsionnet.cli.record_options import Averaging, RecordReading, estimator_options, record_options
from torsionnet.cli.terminal import print_json, print_table, wrote

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.response import Conventions, FrequencyResponse, Table


@click.command("compare")
@record_options
@model_options
@click.option("--output", metavar="NAME", required=True, help="Channel of the record, and sensor of the model.")
@click.option("--input", "into", metavar="NAME", required=True, help="Channel of the record, and input or sensor.")
@click.option("--model-output", metavar="NAME", help="Sensor of the model, if it has another name there.")
@click.option("--model-input", metavar="NAME", help="Input or sensor of the model, if it has another name there.")
@click.option("--excitation", metavar="INPUT", help="What drives the model, if it has several inputs.")
@estimator_options
@click.option("--from", "start", type=float, default=0.0, help="Lowest frequency in Hz.")
@click.option("--to", "stop", type=float, help="Highest frequency in Hz.")
@click.option("--angle", type=click.Choice(["rad", "deg"]), default="rad", show_default=True, help="Unit of angles.")
@json_option
@csv_option
@plot_option("test over model, with their differences")
def command(
    record: str,
    reading: RecordReading,
    model: str,
    configurations: tuple[str, ...],
    settings: tuple[tuple[str, str], ...],
    output: str,
    into: str,
    model_output: str | None,
    model_input: str | None,
    excitation: str | None,
    averaging: Averaging,
    start: float,
    stop: float | None,
    angle: str,
    as_json: bool,
    csv_file: str | None,
    plot_file: str | None,
) -> None:
    """A record against a model: both responses, how far they are apart, and where the test can be trusted.

    \b
    torsionnet bench amt_bench -c V -o gear_V.npz
    torsionnet compare gear_V.npz amt_rig -c V --output theta_1 --input T_T --preset paper --to 40 --plot V.png
    """
    from torsionnet.cli.cases import load_cases
    from torsionnet.cli.estimate import estimated
    from torsionnet.response import Conventions
    from torsionnet.signals.agreement import agreement

    if len(configurations) > 1 or "all" in configurations:
        raise click.UsageError("a record is of one configuration: name one with -c")
    case = load_cases(model, configurations, settings)[0]
    test = estimated(record, reading, (output,), (into,), averaging, start, stop)
    calculated = _calculated(case.drivetrain, test, model_output or output, model_input or into, excitation)
    conventions = Conventions(angle=angle)
    if csv_file:
        _full(test, calculated, conventions).to_csv(csv_file)
        wrote(csv_file)
    if plot_file:
        import torsionnet.plot as plot

        plot.save(plot.comparison(test, calculated, conventions=conventions), plot_file)
        wrote(plot_file)
    if as_json:
        print_json(_as_data(test, calculated, conventions))
    else:
        print_table(agreement(test, calculated, conventions))


def _calculated(
    drivetrain: Drivetrain, test: FrequencyResponse, output: str, into: str, excitation: str | None
) -> FrequencyResponse:
    """The model's response at the frequencies of the test, under the names of the test."""
    from dataclasses import replace

    found = drivetrain.frequency_response(output, into, test.frequencies, excitation=excitation)
    same = [
        tuple(replace(channel, name=other.name) for channel, other in zip(mine, theirs, strict=True))
        for mine, theirs in ((found.outputs, test.outputs), (found.inputs, test.inputs))
    ]
    return replace(found, outputs=same[0], inputs=same[1])


def _full(test: FrequencyResponse, model: FrequencyResponse, conventions: Conventions) -> Table:
    """Every frequency: test, model, coherence, differences."""
    from torsionnet.response import Column, Table
    from torsionnet.signals.comparison import difference

    apart, unit, scale = difference(test, model), test.unit(conventions=conventions), test.scale(conventions)
    data = {
        ("frequency", "Hz"): test.frequencies,
        ("|test|", unit): test.magnitude[:, 0, 0] * scale,
        ("phase test", "deg"): test.phase[:, 0, 0],
        ("|model|", unit): model.magnitude[:, 0, 0] * scale,
        ("phase model", "deg"): model.phase[:, 0, 0],
        ("difference", "dB"): apart.decibels[:, 0, 0],
        ("difference of phase", "deg"): apart.degrees[:, 0, 0],
    }
    if test.coherence is not None:
        data[("coherence", "1")] = test.coherence[:, 0, 0]
    rows = tuple(tuple(map(float, row)) for row in zip(*data.values(), strict=True))
    return Table(model.title, tuple(Column(*key) for key in data), rows, test.notes)


def _as_data(test: FrequencyResponse, model: FrequencyResponse, conventions: Conventions) -> dict[str, Any]:
    from torsionnet.cli.estimate import as_data
    from torsionnet.signals.agreement import agreement
    from torsionnet.signals.comparison import difference

    apart, table = difference(test, model), agreement(test, model, conventions)
    return {
        "test": as_data(test, conventions),
        "model": as_data(model, conventions),
        "difference_dB": apart.decibels[:, 0, 0].tolist(),
        "difference_deg": apart.degrees[:, 0, 0].tolist(),
        "summary": [dict(zip(("what", "at_Hz", "value", "unit"), row, strict=True)) for row in table.rows],
        "notes": list(table.notes),
    }
