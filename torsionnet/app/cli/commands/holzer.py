"""Command ``torsionnet holzer``, which prints the Holzer table of a mode or a trial frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from torsionnet.app.cli.cases import ConfiguredCase, ModelCommand
from torsionnet.app.cli.command import TABLE, Answer, click_command, separated_by_lines
from torsionnet.app.cli.options import EntryOption, option

if TYPE_CHECKING:
    from torsionnet.machinery.holzer.holzer_table import HolzerTable


class HolzerCommand(ModelCommand):
    """Holzer table of a mode or of a trial frequency: amplitudes, torques, twists and stresses, station by station.

    Without damping. Modes are numbered as in the table of torsionnet modes: 1 is the lowest vibration, rigid bodies and
    real poles have no number. Quantities are those of the station's own shaft, with --referred those on the shaft of
    the first station.

    \b
    torsionnet holzer plant.yaml --mode 2 --amplitude "1 mrad"
    torsionnet holzer plant.yaml --at "12 Hz" --first ring
    """

    forms = TABLE

    mode: int | None = option("--mode", type=click.IntRange(min=1), metavar="N", help="Number of the mode.")
    at: float | None = option(
        "--at",
        type=EntryOption("FREQUENCY", "machinery.holzer.holzer_table:FREQUENCY"),
        help="Instead, a trial frequency: 12 Hz.",
    )
    first: str | None = option("--first", metavar="NODE", help="Station to begin with.  [default: the first free end]")
    amplitude: float = option(
        "--amplitude",
        type=EntryOption("ANGLE", "machinery.holzer.holzer_table:AMPLITUDE"),
        default="1 rad",
        show_default=True,
        help="Angle of the first station.",
    )
    referred_to: str | None = option("--referred-to", metavar="NODE", help="Another shaft to refer to.")
    referred: bool = option("--referred", help="Show amplitudes and torques referred to one shaft.")

    def answer(self) -> Answer:
        if (self.mode is None) == (self.at is None):
            raise click.UsageError(
                "a Holzer table needs a frequency: give a mode, as --mode 1, or --at HZ for a trial frequency"
            )
        cases = self.cases()
        found = self.each("Holzer table", cases, self._run)
        pairs = list(zip(cases, found, strict=True))
        return Answer(
            screen=lambda: separated_by_lines(table for one in found for table in one.tables(referred=self.referred)),
            data=lambda: [table.record(case.configuration) for case, table in pairs],
            csv=lambda: [("", self.combined_table(cases, [one.table(referred=self.referred) for one in found]))],
        )

    def _run(self, case: ConfiguredCase) -> HolzerTable:
        return case.drivetrain.holzer_table(
            self.mode, at=self.at, first=self.first, amplitude=self.amplitude, referred_to=self.referred_to
        )


command = click_command("holzer", HolzerCommand)
