"""Command ``torsionnet show``, which prints the content of a model."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from torsionnet.app.cli.cases import ConfiguredCase, ModelCommand
from torsionnet.app.cli.command import TABLE, Answer, click_command, separated_by_lines
from torsionnet.app.cli.options import option
from torsionnet.app.cli.terminal import wrapped

if TYPE_CHECKING:
    from torsionnet.base.table import Table
    from torsionnet.drivetrain import Drivetrain


class ShowCommand(ModelCommand):
    """Elements with their values as written and in SI, parameters, inputs, sensors, configurations, mean speeds.

    With --equations, --matrices or --flat only these; --csv writes the table of elements.
    """

    forms = TABLE
    picture = "the schematic"

    equations: bool = option("--equations", help="The equations of motion in the model's own symbols.")
    flat: bool = option("--flat", help="The model file with its parts put in, dots in the names of what they hold.")
    boxes: bool = option("--boxes", help="Draw each part that is used as one box.")
    matrices: bool = option("--matrices", help="M, C, K in numbers.")

    def answer(self) -> Answer:
        from torsionnet.app.cli.output import shown_model
        from torsionnet.model.overview import elements_table

        cases = self.cases()
        return Answer(
            screen=lambda: self.parts(cases),
            data=lambda: [
                shown_model(case.drivetrain, equations=self.equations, matrices=self.matrices) for case in cases
            ],
            csv=lambda: [("", self.combined_table(cases, [elements_table(case.drivetrain) for case in cases]))],
            figures=lambda plot: [
                (case.configuration, plot.schematic(case.drivetrain, boxes=self.boxes)) for case in cases
            ],
        )

    def parts(self, cases: list[ConfiguredCase]) -> Iterator[Table | str]:
        from torsionnet.model.files.writer import flat_text

        for number, case in enumerate(cases):
            if number:
                yield ""
            if self.flat:
                yield flat_text(case.drivetrain.definition).rstrip("\n")
                continue
            if not (self.equations or self.matrices):
                yield from _described(case.drivetrain)
            if self.equations:
                from torsionnet.app.cli.commands.equations import equations_text

                yield equations_text(case.drivetrain)
            if self.matrices:
                from torsionnet.app.cli.commands.equations import matrix_tables

                yield from [""] if self.equations else []
                yield from separated_by_lines(matrix_tables(case.drivetrain))


def _described(rig: Drivetrain) -> Iterator[Table | str]:
    from torsionnet.model.overview import tables

    yield rig.title
    for text in (rig.description, rig.source and f"Source: {rig.source}"):
        yield from wrapped(text)
    for table in tables(rig):
        if table.rows:
            yield ""
            yield table


command = click_command("show", ShowCommand)
