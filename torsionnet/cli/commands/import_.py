"""Command ``torsionnet import``, which makes a model file of a mass-elastic sheet or of a TORS file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from torsionnet.cli.command import Answer, Command, click_command, text_answer
from torsionnet.cli.declarations import argument
from torsionnet.cli.options import file_option
from torsionnet.cli.terminal import message

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

    def answer(self) -> Answer:
        if Path(self.source).suffix.lower() in SHEETS:
            return text_answer(_of_sheet(self.source).to_yaml(), self.output_file)
        from torsionnet.io.tors_reading import read_tors

        return text_answer(read_tors(self.source).to_yaml(), self.output_file)


def _of_sheet(source: str) -> Drivetrain:
    """Drivetrain made from a file with a mass-elastic sheet.

    The meaning and unit taken for each column go to stderr.
    """
    from torsionnet.io.mass_elastic_reading import mass_elastic_report, sheet_drivetrain

    sheet = mass_elastic_report(source)
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
