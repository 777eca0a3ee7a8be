"""Commands that write and read files of other programs: ``export`` and ``import``."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from torsionnet.app.cli.command import Answer, Command, ModelCommand, result_path, text_answer
from torsionnet.app.cli.options import WrongUsage, argument, file_option, option
from torsionnet.app.cli.terminal import message, print_file_written
from torsionnet.base.errors import UsageError

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain


# Command ``torsionnet export``, which writes a model for another program.

FORMATS = {".tors": "tors", ".json": "tors", ".m": "matlab", ".mat": "mat", ".mo": "modelica",
           ".fmu": "fmu", ".csv": "sheet"}  # fmt: skip
"""Format in which a model is written, by the ending of the file."""
FORMAT_OPTIONS = {"step": ("--step", "fmu", "an FMU"), "version": ("--fmi", "fmu", "an FMU"),
       "referred_to": ("--referred-to", "sheet", "a mass-elastic sheet (.csv)")}  # fmt: skip
"""Options of the command that belong to one format: by name, their words, the format, and the kind of file it makes."""
ONE_PLATFORM_HINT = '; pip install "torsionnet[fmu]" brings a compiler for the others'


class ExportCommand(ModelCommand):
    """Write a model for another program.

    What the file leaves out or holds as a straight line is listed in it and on stderr.

    \b
    .tors, .json  TORS of openTorsion: disks, shafts and gears in a tree
    .m, .mat      matrices, state space and names for Matlab and Octave
    .mo           Modelica text of Modelica.Mechanics.Rotational components
    .fmu          functional mock-up unit, for co-simulation and model exchange
                  (extra fmu, or a C compiler)
    .csv          mass-elastic sheet: inertias and the shafts between them,
                  real or --referred-to a node

    \b
    torsionnet export amt_rig -c V -o rig.mo
    torsionnet export dmf_rig -o rig.fmu --fmi 3.0
    torsionnet export geared_branch -o sheet.csv --referred-to motor
    """

    output_file: str = file_option("The file to write.")
    form: str | None = option(
        "--format",
        type=click.Choice(list(dict.fromkeys(FORMATS.values()))),
        help="Default: by the ending of the file. Of text (tors, modelica, sheet) the ending may be any.",
    )
    step: float | None = option("--step", help="Communication step of an FMU in s.  [default: a fiftieth of a period]")
    version: str | None = option(
        "--fmi", type=click.Choice(["2.0", "3.0"]), help="Version of the interface of an FMU.  [default: 2.0]"
    )

    referred_to: str | None = option(
        "--referred-to",
        metavar="NODE",
        help="Values of a sheet as at the speed of this node.  [default: real]",
    )

    viscous_at: float | None = option(
        "--viscous-at",
        metavar="HZ",
        help="Springs with a loss factor or a table over frequency as springs and dampers that do the same at HZ.",
    )

    def answer(self) -> Answer:
        chosen = _format(Path(self.output_file).suffix.lower(), self.form)
        more = {name: value for name in FORMAT_OPTIONS if (value := getattr(self, name)) is not None}
        # An option of another format is refused: passed over, it would seem to have had an effect.
        for name in more:
            word, form, what = FORMAT_OPTIONS[name]
            if form != chosen:
                raise WrongUsage(
                    f"{word} applies only to {what}: leave it out, or choose that format", kind="needless-entry"
                )
        cases = self.cases()
        import torsionnet.io as io
        from torsionnet.io.export_losses import export_losses

        writers: dict[str, Callable[..., tuple[str, ...] | None]] = {
            "tors": io.write_tors,
            "matlab": io.write_matlab,
            "mat": io.write_matlab,
            "modelica": io.write_modelica,
            "fmu": io.write_fmu,
            "sheet": io.write_mass_elastic,
        }
        for case in cases:
            target = result_path(self.output_file, case.configuration, len(cases))
            platforms = self._write(writers[chosen], case.drivetrain, target, more)
            if platforms:
                message("note", f"binaries for {', '.join(platforms)}{'' if len(platforms) > 1 else ONE_PLATFORM_HINT}")
            # What the format cannot hold is lost, and said.
            for sentence in export_losses(case.drivetrain, chosen).sentences():
                message("note", sentence)
            print_file_written(target)
        return Answer()

    def _write(
        self, writer: Callable[..., tuple[str, ...] | None], drivetrain: Drivetrain, target: str, more: dict[str, Any]
    ) -> tuple[str, ...] | None:
        written = self._written(drivetrain)
        try:
            return writer(written, target, **more)
        except UsageError as error:
            if not written.assembly.system.dynamic:
                raise
            instead = "--viscous-at HZ replaces laws over frequency by springs and dampers with their values at HZ"
            raise UsageError(f"{error}; {instead}", kind=error.kind) from error

    def _written(self, drivetrain: Drivetrain) -> Drivetrain:
        if self.viscous_at is None:
            return drivetrain
        from torsionnet.linear.assembly.table_range import range_notes
        from torsionnet.machinery.design.damper_design import viscous_equivalent

        equivalent = viscous_equivalent(drivetrain, self.viscous_at)
        message(
            "note",
            "stiffness and damping over frequency are replaced by springs and "
            f"viscous dampers with their values at {self.viscous_at:g} Hz",
        )
        for note in range_notes(drivetrain.assembly, [self.viscous_at]):
            message("note", note)
        return equivalent


def _format(ending: str, form: str | None) -> str:
    usual = FORMATS.get(ending)
    if form is None and usual is None:
        raise WrongUsage(
            f'"{ending}" tells no format; end the file in {", ".join(FORMATS)}, or give --format', kind="unknown-word"
        )
    if form and usual and form != usual:
        raise WrongUsage(
            f"a file ending in {ending} is of the format {usual}, not {form}; change one of the two",
            kind="contradicting-entries",
        )
    return form or str(usual)


# Command ``torsionnet import``, which makes a model file of a mass-elastic sheet or of a TORS file.

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
                raise WrongUsage(
                    f"{name} applies only to a mass-elastic sheet ({', '.join(SHEETS)})", kind="needless-entry"
                )
        from torsionnet.io.tors_reading import read_tors

        return text_answer(read_tors(self.source).to_yaml(), self.output_file)


def _of_sheet(source: str, said: dict[str, str]) -> Drivetrain:
    """Drivetrain made from a file with a mass-elastic sheet.

    The meaning and unit taken for each column go to stderr.
    """
    from torsionnet.io.mass_elastic_files import mass_elastic_report, sheet_drivetrain

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
