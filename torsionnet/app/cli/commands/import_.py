"""Command ``torsionnet import``, which makes a model file of a mass-elastic sheet or of a TORS file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from torsionnet.app.cli.command import Answer, Command, click_command, text_answer
from torsionnet.app.cli.options import argument, file_option, option
from torsionnet.app.cli.terminal import message

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain

SHEETS = (".csv", ".txt", ".tsv")
"""Endings of files that are read as mass-elastic sheets."""


class ImportCommand(Command):
    """Make a model file of a maker's mass-elastic sheet, or of a model of another program.

    Endings .csv, .txt and .tsv are sheets, any other is a TORS file of openTorsion.
    Of a sheet, what each column was taken as, and in which unit, goes to stderr.

    \b
    torsionnet import engine.csv -o engine.yaml
    torsionnet import thruster.tors -o thruster.yaml
    """

    source: str = argument("FILE")
    output_file: str | None = file_option("The model file to write; default: stdout.", (".yaml", ".yml"))
    values: str | None = option(
        "--values",
        type=click.Choice(["real", "referred"]),
        help="Values of a sheet with several speeds.  [default: as the sheet says]",
    )
    factors: str | None = option(
        "--factors",
        type=click.Choice(["unit", "values"]),
        help="What factors in headings of a sheet multiply, as K x 10^-6.  [default: what gives a usual vibration]",
    )

    def answer(self) -> Answer:
        if Path(self.source).suffix.lower() in SHEETS:
            said = {"values": self.values or "", "factors": self.factors or ""}
            return text_answer(_of_sheet(self.source, said).to_yaml(), self.output_file)
        for name, value in (("--values", self.values), ("--factors", self.factors)):
            if value is not None:
                raise click.UsageError(f"{name} applies only to a mass-elastic sheet ({', '.join(SHEETS)})")
        from torsionnet.io.tors_reading import read_tors

        return text_answer(read_tors(self.source).to_yaml(), self.output_file)


def _of_sheet(source: str, said: dict[str, str]) -> Drivetrain:
    """Drivetrain made from a file with a mass-elastic sheet.

    The meaning and unit taken for each column go to stderr.
    """
    from torsionnet.io.mass_elastic_reading import mass_elastic_report, sheet_drivetrain

    sheet = mass_elastic_report(source, **said)
    drivetrain = sheet_drivetrain(sheet)
    report = sheet.report()
    message("read", report.title)
    for heading, taken, unit, remark in report.rows:
        more = f"{f' [{unit}]' if unit else ''}{f' ({remark})' if remark else ''}"
        message("column", f'"{heading}": {taken}{more}')
    for note in report.notes:
        message("note", note)
    return drivetrain


command = click_command("import", ImportCommand)
