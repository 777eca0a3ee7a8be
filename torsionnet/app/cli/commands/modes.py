"""Command ``torsionnet modes``, which prints natural frequencies, damping ratios and shapes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import click

from torsionnet.app.cli.cases import ConfiguredCase, ModelCommand
from torsionnet.app.cli.command import TABLE, Answer, click_command, separated_by_lines
from torsionnet.app.cli.options import EXCITATION, FREQUENCY_UNIT, option
from torsionnet.app.cli.terminal import blank_zero_shares, split_table

if TYPE_CHECKING:
    from torsionnet.base.table import Table
    from torsionnet.linear.modes.modes import Modes

EIGENVALUES = ("Re lambda", "Im lambda")


class ModesCommand(ModelCommand):
    """Complex modes: natural frequencies |lambda|/2pi, damping ratios, descriptions.

    The eigenvalues, shapes and energy shares are all in --json; --csv has the eigenvalues.
    """

    forms = TABLE
    picture = "the mode shapes"

    measured_input: str | None = option(
        "--measured-input",
        metavar="SENSOR",
        help="The poles of responses against this sensor: those of the cut system.",
    )
    excitation: str | None = EXCITATION
    lowest: int | None = option(
        "--lowest",
        type=click.IntRange(min=1),
        metavar="N",
        help="Only the N lowest modes; default: all, or 20 with continuous shafts.",
    )
    up_to: float | None = option(
        "--up-to",
        type=click.FloatRange(min=0, min_open=True),
        metavar="HZ",
        help="Only modes up to this natural frequency in Hz; with continuous shafts all of these.",
    )
    shapes: bool = option("--shapes", help="Also the mode shapes, at every node.")
    referred_to: str | None = option(
        "--referred-to", metavar="NODE", help="Shapes with all angles referred to the shaft of this node."
    )
    energies: bool = option("--energies", help="Also the share of every element in the energies.")
    frequency_unit: str = FREQUENCY_UNIT

    def answer(self) -> Answer:
        cases = self.cases()
        from torsionnet.base.conventions import Conventions

        conventions = Conventions(frequency=self.frequency_unit)
        found = self.each(
            "modes",
            cases,
            lambda case: case.drivetrain.modes(
                measured_input=self.measured_input, excitation=self.excitation, lowest=self.lowest, up_to=self.up_to
            ),
        )
        results = [self._referred(case, modes) for case, modes in zip(cases, found, strict=True)]
        tables = [modes.table(conventions) for modes in results]
        pairs = list(zip(cases, results, strict=True))
        return Answer(
            screen=lambda: separated_by_lines(
                part for pair in zip(results, tables, strict=True) for part in self.parts(*pair)
            ),
            data=lambda: [modes.record(case.configuration) for case, modes in pairs],
            csv=lambda: [("", self.combined_table(cases, tables))],
            # overlaid the shapes of several configurations could not be told apart
            figures=lambda plot: [
                (
                    case.configuration,
                    plot.mode_shapes(modes, case.drivetrain, referred_to=self.referred_to, conventions=conventions),
                )
                for case, modes in zip(cases, found, strict=True)
            ],
        )

    def _referred(self, case: ConfiguredCase, modes: Modes) -> Modes:
        """Modes of a case with shapes referred to the shaft asked for."""
        if self.referred_to is None:
            return modes
        from torsionnet.linear.modes.mode_pairs import referred_shapes

        return referred_shapes(case.drivetrain, modes, self.referred_to)

    def parts(self, modes: Modes, table: Table) -> Iterator[Table]:
        """Tables of the modes of one configuration for the screen, with shapes and energy shares if asked for."""
        yield without_eigenvalues(table)
        if self.shapes:
            yield from split_table(self.output.with_digits(modes.shape_table()), 2)
        if self.energies:
            yield from split_table(self.output.with_digits(blank_zero_shares(modes.energy_table())), 3)


def without_eigenvalues(table: Table) -> Table:
    """Copy of the table of modes without the columns of eigenvalues, which only files have."""
    return table.chosen([index for index, one in enumerate(table.columns) if one.name not in EIGENVALUES])


command = click_command("modes", ModesCommand)
