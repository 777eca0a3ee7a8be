"""``torsionnet identify-modes``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from torsionnet.cli.options import csv_option, json_option, plot_option
from torsionnet.cli.record_options import Averaging, RecordReading, estimator_options, record_options
from torsionnet.cli.terminal import message, print_json, print_table, say, wrote

if TYPE_CHECKING:
    from torsionnet.modal import Match, ModalEstimate
    from torsionnet.response import FrequencyResponse

METHODS = ("auto", "rational", "lscf", "peaks")


@click.command("identify-modes")
@record_options
@click.option("--output", "outputs", metavar="CHANNEL", multiple=True, required=True, help="Repeatable.")
@click.option("--input", "inputs", metavar="CHANNEL", multiple=True, required=True, help="Repeatable.")
@estimator_options
@click.option("--from", "start", type=float, default=0.0, help="Lowest frequency in Hz.")
@click.option("--to", "stop", type=float, help="Highest frequency in Hz; default: as far as the record can be used.")
@click.option(
    "--method",
    type=click.Choice(METHODS),
    default="auto",
    show_default=True,
    help="rational: few modes of any damping, also close ones; lscf: many light modes; auto: the better of these.",
)
@click.option("--order", type=click.IntRange(1), help="Highest order of the fit.")
@click.option("--against", "model", metavar="MODEL", help="Compare with the modes of a model.")
@click.option("--configuration", "-c", "configuration", metavar="NAME", default="", help="Of that model.")
@json_option
@csv_option
@plot_option("the stabilisation diagram")
def command(
    record: str,
    reading: RecordReading,
    outputs: tuple[str, ...],
    inputs: tuple[str, ...],
    averaging: Averaging,
    start: float,
    stop: float | None,
    method: str,
    order: int | None,
    model: str | None,
    configuration: str,
    as_json: bool,
    csv_file: str | None,
    plot_file: str | None,
) -> None:
    """Natural frequencies, damping ratios and shapes at the sensors from a record, without a model.

    Against a measured torque these are the poles of the drivetrain cut at the transducer; --against compares them with
    those of a model in the same way.

    \b
    torsionnet identify-modes test.npz --output theta_1 --input T_T --preset paper --against amt_rig -c V
    """
    from torsionnet.cli.estimate import estimated

    if plot_file and method == "peaks":
        raise click.UsageError(
            "peak picking has no stabilisation diagram; leave --plot out, or choose another --method"
        )
    response = estimated(record, reading, outputs, inputs, averaging, start, stop)
    if stop is None and response.usable_up_to is not None:
        response = response.between(start, response.usable_up_to)
    found, diagram = _identified(response, method, order)
    compared = _compared(found, model, configuration, inputs) if model else None
    for note in found.notes:
        kind, _, text = note.partition(": ")
        if kind == "warning":
            message("warning", text)
    if csv_file:
        found.table().to_csv(csv_file)
        wrote(csv_file)
    if plot_file:
        import torsionnet.plot as plot

        plot.save(plot.stabilisation(diagram, found), plot_file)
        wrote(plot_file)
    if as_json:
        print_json(_as_data(found, compared))
    else:
        print_table(found.table())
        if compared:
            say()
            print_table(compared.table())


def _identified(response: FrequencyResponse, method: Any, order: int | None) -> tuple[ModalEstimate, Any]:
    from torsionnet.modal import Settings, identify_modes, peak_picking, stabilisation

    if method == "peaks":
        return peak_picking(response), None
    chosen = Settings(method, order, weights=_weights(response))
    diagram = stabilisation(response, chosen)
    return identify_modes(diagram), diagram


def _weights(response: FrequencyResponse) -> Any:
    return "coherence" if response.coherence is not None else "uniform"


def _compared(found: ModalEstimate, model: str, configuration: str, inputs: tuple[str, ...]) -> Match:
    from torsionnet.loading import load
    from torsionnet.modal import match

    rig = load(model)
    rig = rig.configured(configuration) if configuration else rig
    measured = [name for name in inputs if name in rig.sensors]
    return match(found, rig.modes(measured_input=measured) if measured else rig.modes())


def _as_data(found: ModalEstimate, compared: Match | None) -> dict[str, Any]:
    modes = [
        {
            "mode": index + 1,
            "kind": found.kinds[index],
            "natural_frequency_Hz": float(found.natural_frequencies[index]),
            "standard_error_Hz": float(found.frequency_errors[index]),
            "damping_ratio": float(found.damping_ratios[index]),
            "standard_error": float(found.damping_errors[index]),
            "pole_rad_per_s": [float(found.poles[index].real), float(found.poles[index].imag)],
            "shape": {
                channel.name: [float(value.real), float(value.imag)]
                for channel, value in zip(found.outputs, found.shapes[:, index], strict=True)
            },
        }
        for index in range(len(found))
    ]
    data: dict[str, Any] = {"title": found.title, "method": found.method, "notes": list(found.notes), "modes": modes}
    if compared is not None:
        data["against_model"] = [
            {"identified": int(i) + 1, "model": int(m) + 1, "frequency_error": float(df), "damping_error": float(dz)}
            for i, m, df, dz in zip(
                compared.identified, compared.model, compared.frequency_errors, compared.damping_errors, strict=True
            )
        ]
    return data
