"""``torsionnet show``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from torsionnet.cli.cases import ConfiguredCase, file_of, joined, load_cases
from torsionnet.cli.options import csv_option, json_option, model_options, plot_option
from torsionnet.cli.terminal import print_json, print_table, say, wrapped, wrote

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain


@click.command("show")
@model_options
@click.option("--equations", is_flag=True, help="The equations of motion in the model's own symbols.")
@click.option("--matrices", is_flag=True, help="M, C, K in numbers.")
@json_option
@csv_option
@plot_option("the schematic")
def command(
    model: str,
    configurations: tuple[str, ...],
    settings: tuple[tuple[str, str], ...],
    equations: bool,
    matrices: bool,
    as_json: bool,
    csv_file: str | None,
    plot_file: str | None,
) -> None:
    """Elements with their values as written and in SI, parameters, inputs, sensors, configurations, mean speeds.

    With --equations or --matrices only these; --csv writes the table of elements.
    """
    cases = load_cases(model, configurations, settings)
    if csv_file:
        from torsionnet.model.overview import elements_table

        joined(cases, [elements_table(case.drivetrain) for case in cases], named=bool(configurations)).to_csv(csv_file)
        wrote(csv_file)
    if plot_file:
        _plot(plot_file, cases)
    if as_json:
        print_json([_as_data(case, equations, matrices) for case in cases])
    else:
        for number, case in enumerate(cases):
            if number:
                say()
            _show(case.drivetrain, equations, matrices)


def _show(rig: Drivetrain, equations: bool, matrices: bool) -> None:
    if not (equations or matrices):
        _describe(rig)
    if equations:
        from torsionnet.cli.equations import equations_text

        say(equations_text(rig))
    if matrices:
        from torsionnet.cli.equations import matrix_tables

        for number, table in enumerate(matrix_tables(rig)):
            if number or equations:
                say()
            print_table(table)


def _describe(rig: Drivetrain) -> None:
    from torsionnet.model.overview import tables

    say(rig.title)
    for text in (rig.description, rig.source and f"Source: {rig.source}"):
        for line in wrapped(text):
            say(line)
    for table in tables(rig):
        if table.rows:
            say()
            print_table(table)


def _plot(file: str, cases: list[ConfiguredCase]) -> None:
    import torsionnet.plot as plot

    for case in cases:
        path = file_of(file, case, cases)
        plot.save(plot.schematic(case.drivetrain), path)
        wrote(path)


def _as_data(case: ConfiguredCase, equations: bool, matrices: bool) -> dict[str, Any]:
    from torsionnet.cli.equations import equations_data, matrices_data
    from torsionnet.model.overview import as_data

    data = as_data(case.drivetrain)
    if equations:
        data["equations"] = equations_data(case.drivetrain)
    if matrices:
        data["matrices"] = matrices_data(case.drivetrain)
    return data
