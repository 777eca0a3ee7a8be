"""``torsionnet estimate``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from torsionnet.cli.options import csv_option, json_option, output_file_option, plot_option
from torsionnet.cli.record_options import Averaging, RecordReading, estimator_options, record_options
from torsionnet.cli.terminal import message, print_json, print_table, wrote

if TYPE_CHECKING:
    from torsionnet.response import Conventions, FrequencyResponse, Table

RESPONSE_ENDINGS = (".uff", ".unv", ".mat", ".npz", ".csv")


@click.command("estimate")
@record_options
@click.option("--output", "outputs", metavar="CHANNEL", multiple=True, required=True, help="Repeatable.")
@click.option("--input", "inputs", metavar="CHANNEL", multiple=True, required=True, help="Repeatable.")
@estimator_options
@click.option("--from", "start", type=float, default=0.0, help="Lowest frequency in Hz.")
@click.option("--to", "stop", type=float, help="Highest frequency in Hz.")
@click.option("--angle", type=click.Choice(["rad", "deg"]), default="rad", show_default=True, help="Unit of angles.")
@json_option
@csv_option
@output_file_option("Write the response: UFF58, MAT, NPZ or CSV.", RESPONSE_ENDINGS)
@plot_option("magnitude, phase and coherence")
def command(
    record: str,
    reading: RecordReading,
    outputs: tuple[str, ...],
    inputs: tuple[str, ...],
    averaging: Averaging,
    start: float,
    stop: float | None,
    angle: str,
    as_json: bool,
    csv_file: str | None,
    output_file: str | None,
    plot_file: str | None,
) -> None:
    """Frequency responses and coherence from a record of signals.

    Several inputs are separated from each other; they must not be proportional.

    \b
    torsionnet estimate test.tdms --input T_T --output theta_1 --preset paper --angle deg --plot frf.png
    torsionnet estimate test.csv --input M1 --output phi --quantity phi=angle --unit phi=deg --csv frf.csv
    torsionnet estimate test.npz --input T_T --output theta_1 --reference T_M_set --plot frf.png
    """
    from torsionnet.response import Conventions

    response = estimated(record, reading, outputs, inputs, averaging, start, stop)
    conventions = Conventions(angle=angle)
    if csv_file:
        response.to_csv(csv_file, conventions)
        wrote(csv_file)
    if output_file:
        from torsionnet.io import write_frequency_response

        write_frequency_response(response, output_file)
        wrote(output_file)
    if plot_file:
        import torsionnet.plot as plot

        plot.save(plot.bode(response, conventions=conventions), plot_file)
        wrote(plot_file)
    if as_json:
        print_json(as_data(response, conventions))
    else:
        print_table(peak_table(response, conventions))


def estimated(
    record: str,
    reading: RecordReading,
    outputs: tuple[str, ...],
    inputs: tuple[str, ...],
    averaging: Averaging,
    start: float,
    stop: float | None,
) -> FrequencyResponse:
    """The response between two frequencies; warnings about it go to stderr."""
    from torsionnet.cli.progress import progress
    from torsionnet.cli.records import load_record
    from torsionnet.signals.estimators import estimate

    settings = averaging.settings()
    with progress("averaging", None) as advance:
        measured = load_record(record, reading, (*outputs, *inputs, *averaging.references), settings.seconds, advance)
        band = (start, float("inf") if stop is None else stop)
        response = estimate(
            measured, outputs, inputs, averaging.estimator, settings, reference=averaging.references, band=band
        )
    for note in response.notes:
        kind, _, text = note.partition(": ")
        if kind == "warning":
            message("warning", text)
    return response


def peak_table(response: FrequencyResponse, conventions: Conventions) -> Table:
    """A row for the first line and one for every peak that stands out where the response can be used."""
    from torsionnet.response import Column, Table
    from torsionnet.response.frequency_response import SIGN_NOTE, limit_line

    columns = (
        Column("response"),
        Column("unit"),
        Column("at"),
        Column("frequency", "Hz", 5),
        Column("magnitude", digits=4),
        Column("phase", "deg", 4),
        Column("coherence", "", 3),
    )
    rows: list[tuple[Any, ...]] = []
    for o, output in enumerate(response.outputs):
        for i, into in enumerate(response.inputs):
            scale, unit = response.scale(conventions, o, i), response.unit(o, i, conventions)
            for name, index in _places(response, o, i):
                value = response.values[index, o, i]
                row = (response.frequencies[index], abs(value) * scale, response.phase[index, o, i])
                coherence = None if response.coherence is None else float(response.coherence[index, o, i])
                rows.append((f"{output.name}/{into.name}", unit, name, *map(float, row), coherence))
    kept = [note for note in response.notes if not note.startswith("warning:")]
    return Table(response.title, columns, tuple(rows), (*kept, *filter(None, [limit_line(response)]), SIGN_NOTE))


def _places(response: FrequencyResponse, o: int, i: int) -> list[tuple[str, int]]:
    from torsionnet.signals.advice import peaks

    usable = response.between(0, response.usable_up_to) if response.usable_up_to is not None else response
    if not len(response.frequencies):
        return []
    found = peaks(usable.magnitude[:, o, i])
    return [("first line", 0), *((f"peak {number}", index) for number, index in enumerate(found, 1))]


def as_data(response: FrequencyResponse, conventions: Conventions) -> dict[str, Any]:
    """Everything for a program: complex values in the angle unit chosen."""
    pairs = []
    for o, output in enumerate(response.outputs):
        for i, into in enumerate(response.inputs):
            values = response.values[:, o, i] * response.scale(conventions, o, i)
            pairs.append(
                {
                    "output": output.name,
                    "input": into.name,
                    "quantity": response.kind(o, i),
                    "unit": response.unit(o, i, conventions),
                    "real": values.real.tolist(),
                    "imag": values.imag.tolist(),
                    "coherence": None if response.coherence is None else response.coherence[:, o, i].tolist(),
                }
            )
    return {
        "title": response.title,
        "notes": list(response.notes),
        "usable_up_to_Hz": response.usable_up_to,
        "frequencies_Hz": response.frequencies.tolist(),
        "responses": pairs,
    }
