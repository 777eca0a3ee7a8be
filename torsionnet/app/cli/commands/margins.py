"""Command ``torsionnet margins``, which prints the stability margins of the loop opened at a controller."""

from __future__ import annotations

from typing import TYPE_CHECKING

from torsionnet.app.cli.cases import ModelCommand
from torsionnet.app.cli.command import TABLE, Answer, click_command, separated_by_lines
from torsionnet.app.cli.options import option

if TYPE_CHECKING:
    pass


class MarginsCommand(ModelCommand):
    """Stability margins of the loop opened at a controller: gain, phase, delay, and the distance from -1.

    All other loops are closed. --plot draws Nyquist's plot.
    """

    forms = TABLE
    picture = "Nyquist's plot"

    at: str | None = option("--at", metavar="NAME", help="The controller.  [default: the only one]")

    def answer(self) -> Answer:
        cases = self.cases()
        found = self.each("margins", cases, lambda case: case.drivetrain.loop_margins(self.at))
        tables = [one.table() for one in found]
        pairs = list(zip(cases, found, strict=True))
        return Answer(
            screen=lambda: separated_by_lines(tables),
            data=lambda: [margins.record(case.configuration) for case, margins in pairs],
            csv=lambda: [("", self.combined_table(cases, tables))],
            figures=lambda plot: [(case.configuration, plot.nyquist(one)) for case, one in pairs],
        )


command = click_command("margins", MarginsCommand)
