"""``torsionnet sensitivity``."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import click

from torsionnet.cli.cases import ConfiguredCase, file_of, joined, load_cases
from torsionnet.cli.options import csv_option, json_option, model_options, plot_option
from torsionnet.cli.terminal import print_json, print_table, wrote
from torsionnet.core.errors import UsageError

if TYPE_CHECKING:
    from torsionnet.response import Table
    from torsionnet.solve.sensitivity import ModeSensitivities

ROUNDING = 1e-9
MOST = 10
"""Effects on the screen unless some are asked for."""


@click.command("sensitivity")
@model_options
@click.option(
    "--parameter", "parameters", metavar="NAME", multiple=True, help="Or element.field; default: all. Repeatable."
)
@click.option("--mode", "modes", type=click.IntRange(1), multiple=True, help="Only this mode. Repeatable.")
@click.option("--measured-input", metavar="SENSOR", help="Poles of responses against this sensor instead.")
@click.option("--excitation", metavar="INPUT", help="What drives the drivetrain then, if it has several inputs.")
@click.option("--full", is_flag=True, help=f"Print every effect instead of the {MOST} largest.")
@json_option
@csv_option
@plot_option("a tornado plot")
def command(
    model: str,
    configurations: tuple[str, ...],
    settings: tuple[tuple[str, str], ...],
    parameters: tuple[str, ...],
    modes: tuple[int, ...],
    measured_input: str | None,
    excitation: str | None,
    full: bool,
    as_json: bool,
    csv_file: str | None,
    plot_file: str | None,
) -> None:
    """Exact derivatives of natural frequencies and damping ratios to the parameters of a model.

    \b
    torsionnet sensitivity amt_rig -c V --mode 1 --plot tornado.png
    """
    cases = load_cases(model, configurations, settings)
    from torsionnet.solve.sensitivity import mode_sensitivities

    results = [
        mode_sensitivities(
            case.drivetrain, list(parameters) or None, measured_input=measured_input, excitation=excitation
        )
        for case in cases
    ]
    _require(modes, results)
    tables = [_chosen(one, modes) for one in results]
    if csv_file:
        joined(cases, tables, named=bool(configurations)).to_csv(csv_file)
        wrote(csv_file)
    if plot_file:
        import torsionnet.plot as plot

        for case, one in zip(cases, results, strict=True):
            path = file_of(plot_file, case, cases)
            plot.save(plot.tornado(one, modes=list(modes) or None), path)
            wrote(path)
    if as_json:
        print_json([_as_data(case, one, modes) for case, one in zip(cases, results, strict=True)])
    else:
        shown = tables if full or modes or parameters else [_largest(table) for table in tables]
        print_table(joined(cases, shown, named=bool(configurations)))


def _require(modes: tuple[int, ...], results: list[ModeSensitivities]) -> None:
    known = sorted({one.number(mode) for one in results for mode in range(len(one.poles))})
    for mode in modes:
        if mode not in known:
            raise UsageError(f"there is no mode {mode} to move; there are {', '.join(map(str, known)) or 'none'}")


def _chosen(found: ModeSensitivities, modes: tuple[int, ...]) -> Table:
    """Only some modes, of them what moves at all."""
    from dataclasses import replace

    table = found.table()
    rows = tuple(
        row for row in table.rows if (not modes or row[0] in modes) and max(abs(row[4]), abs(row[5])) > ROUNDING
    )
    notes = tuple(note for index, note in enumerate(table.notes) if not modes or found.number(index) in modes)
    return replace(table, rows=rows, notes=notes)


def _largest(table: Table) -> Table:
    """The effects that move an eigenvalue farthest for its size, and what is said of their modes."""
    from dataclasses import replace

    if len(table.rows) <= MOST:
        return table
    rows = sorted(table.rows, key=lambda row: math.hypot(row[4], row[2] * row[5]), reverse=True)[:MOST]
    seen = {row[0] for row in rows}
    notes = [note for note in table.notes if any(note.startswith(f"mode {mode} ") for mode in seen)]
    rest = f"the {MOST} largest of {len(table.rows)} effects; --mode and --parameter choose, --full prints all"
    return replace(table, rows=tuple(rows), notes=(*notes, rest))


def _as_data(case: ConfiguredCase, found: ModeSensitivities, modes: tuple[int, ...]) -> dict[str, Any]:
    every = range(len(found.poles))
    chosen = [mode for mode in every if found.number(mode) in modes] or every
    return {
        "title": found.title,
        "configuration": case.configuration,
        "parameters": list(found.parameters),
        "values": found.values.tolist(),
        "modes": [
            {
                "mode": found.number(mode),
                "natural_frequency_Hz": float(found.natural_frequencies[mode]),
                "damping_ratio": float(found.damping_ratios[mode]),
                "frequency_percent_per_percent": found.relative_frequencies[mode].tolist(),
                "damping_percent_per_percent": found.relative_dampings[mode].tolist(),
                "d_frequency": found.frequency_slopes[mode].tolist(),
                "d_damping": found.damping_slopes[mode].tolist(),
            }
            for mode in chosen
        ],
        "words": list(found.words()),
    }
