"""``torsionnet modes``."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from torsionnet.cli.cases import ConfiguredCase, file_of, joined, load_cases
from torsionnet.cli.options import csv_option, frequency_unit_option, json_option, model_options, plot_option
from torsionnet.cli.terminal import print_json, print_table, say, wrote
from torsionnet.cli.wide_tables import in_blocks, shares_on_screen

if TYPE_CHECKING:
    from torsionnet.response import Conventions, Modes, Table

EIGENVALUES = ("Re lambda", "Im lambda")


@click.command("modes")
@model_options
@click.option(
    "--measured-input", metavar="SENSOR", help="The poles of responses against this sensor: those of the cut system."
)
@click.option("--excitation", metavar="INPUT", help="What drives the drivetrain then, if it has several inputs.")
@click.option("--lowest", type=click.IntRange(min=1), metavar="N", help="Only the N lowest modes; default: all.")
@click.option("--shapes", is_flag=True, help="Also the mode shapes, at every node.")
@click.option("--energies", is_flag=True, help="Also the share of every element in the energies.")
@frequency_unit_option
@json_option
@csv_option
@plot_option("the mode shapes")
def command(
    model: str,
    configurations: tuple[str, ...],
    settings: tuple[tuple[str, str], ...],
    measured_input: str | None,
    excitation: str | None,
    lowest: int | None,
    shapes: bool,
    energies: bool,
    frequency_unit: str,
    as_json: bool,
    csv_file: str | None,
    plot_file: str | None,
) -> None:
    """Complex modes: natural frequencies |lambda|/2pi, damping ratios, descriptions.

    The eigenvalues, shapes and energy shares are all in --json; --csv has the eigenvalues.
    """
    cases = load_cases(model, configurations, settings)
    from torsionnet.response import Conventions

    conventions = Conventions(frequency=frequency_unit)
    results = [
        case.drivetrain.modes(measured_input=measured_input, excitation=excitation, lowest=lowest) for case in cases
    ]
    tables = [modes.table(conventions) for modes in results]
    if csv_file:
        joined(cases, tables, named=bool(configurations)).to_csv(csv_file)
        wrote(csv_file)
    if plot_file:
        _plot(plot_file, cases, results, conventions)
    if as_json:
        print_json([_as_data(case, modes) for case, modes in zip(cases, results, strict=True)])
    else:
        for number, (modes, table) in enumerate(zip(results, tables, strict=True)):
            parts = [on_screen(table)]
            parts += in_blocks(modes.shape_table(), 2) if shapes else []
            parts += in_blocks(shares_on_screen(modes.energy_table()), 3) if energies else []
            for position, part in enumerate(parts):
                if number or position:
                    say()
                print_table(part)


def on_screen(table: Table) -> Table:
    """Without the eigenvalues, which say the same again; files have them."""
    kept = [index for index, column in enumerate(table.columns) if column.name not in EIGENVALUES]
    rows = tuple(tuple(row[index] for index in kept) for row in table.rows)
    return replace(table, columns=tuple(table.columns[index] for index in kept), rows=rows)


def _plot(file: str, cases: list[ConfiguredCase], results: list[Modes], conventions: Conventions) -> None:
    """The shapes of each configuration in a file of its own: overlaid they could not be told apart."""
    import torsionnet.plot as plot

    for case, modes in zip(cases, results, strict=True):
        path = file_of(file, case, cases)
        plot.save(plot.mode_shapes(modes, case.drivetrain, conventions=conventions), path)
        wrote(path)


def _as_data(case: ConfiguredCase, modes: Modes) -> dict[str, Any]:
    return {
        "title": modes.title,
        "configuration": case.configuration,
        "notes": list(modes.notes),
        "undamped_natural_frequencies_Hz": modes.undamped_natural_frequencies.tolist(),
        "nodes": list(modes.nodes),
        "modes": [_mode(modes, index) for index in range(len(modes))],
    }


def _mode(modes: Modes, index: int) -> dict[str, Any]:
    value = complex(modes.eigenvalues[index])
    shares = modes.energy_shares(index)
    return {
        "mode": index + 1,
        "kind": modes.kinds[index],
        "natural_frequency_Hz": float(modes.natural_frequencies[index]),
        "damped_frequency_Hz": float(modes.damped_frequencies[index]),
        "damping_ratio": float(modes.damping_ratios[index]),
        "eigenvalue_rad_per_s": [value.real, value.imag],
        "converged": bool(modes.converged[index]),
        "description": modes.descriptions[index],
        "shape": {
            node: [float(a.real), float(a.imag)] for node, a in zip(modes.nodes, modes.shapes[:, index], strict=True)
        },
        "energy_shares": {
            name: dict(zip(("kinetic", "strain", "dissipated"), parts, strict=True)) for name, parts in shares.items()
        },
    }
