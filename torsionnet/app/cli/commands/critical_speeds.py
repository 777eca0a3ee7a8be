"""Command ``torsionnet critical-speeds``, which finds the speeds at which orders meet natural frequencies."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import click

from torsionnet.app.cli.cases import ConfiguredCase, ModelCommand
from torsionnet.app.cli.command import TABLE, Answer, click_command, separated_by_lines
from torsionnet.app.cli.options import option

if TYPE_CHECKING:
    from types import ModuleType

    from matplotlib.figure import Figure

    from torsionnet.base.table import Table
    from torsionnet.machinery.criticals.critical_speeds import CriticalSpeeds

STATES = ("as_modelled", "free", "locked", "half")


class CriticalSpeedsCommand(ModelCommand):
    """Critical speeds, at which orders meet natural frequencies, their margin to the operating range, and excitation.

    The model says what runs and at which speeds in its entries excitations: and speeds:. With several configurations
    a crossing that one of them does not excite says which others do.

    \b
    torsionnet critical-speeds plant.yaml --margin api684 --plot campbell.png
    torsionnet critical-speeds plant.yaml -c normal -c misfire --output "torque(crank)"
    torsionnet critical-speeds plant.yaml --stars 1 --plot stars.png
    """

    forms = TABLE
    picture = "the interference (Campbell) diagram, or star diagrams"

    outputs: tuple[str, ...] = option(
        "--output", metavar="NAME", help="Also the speed at which orders of this are largest. Repeatable."
    )
    excitations: tuple[str, ...] = option(
        "--excitation", metavar="NAME", help="Only this one counts. Repeatable.  [default: all of the model]"
    )
    margin: str | None = option(
        "--margin", metavar="RULE", help="api610, api617, api618, api684, line_frequency, or a share as 15%."
    )
    reach: float = option(
        "--reach", default=0.25, show_default=True, help="How far outside the operating range, as a share of speed."
    )
    lowest: int | None = option("--lowest", type=click.IntRange(min=1), metavar="N", help="Only the N lowest modes.")
    line_frequency: float | None = option("--line-frequency", metavar="HZ", help="Also once and twice this frequency.")
    dampers: str = option(
        "--dampers", type=click.Choice(STATES), default=STATES[0], show_default=True, help="Rings of viscous dampers."
    )
    damper_names: tuple[str, ...] = option(
        "--damper", metavar="NAME", help="A damper, or a film.  [default: every viscous_damper]"
    )
    stars: int | None = option("--stars", type=click.IntRange(min=1), metavar="MODE", help="--plot draws these.")

    def answer(self) -> Answer:
        cases = self.cases()
        each = self.each("critical speeds", cases, self._run)
        found = [one.in_conditions([other for other in each if other is not one]) for one in each]
        pairs = list(zip(cases, found, strict=True))
        return Answer(
            screen=lambda: separated_by_lines(part for one in found for part in _shown(one)),
            data=lambda: found,
            csv=lambda: [("", self.combined_table(cases, [one.table() for one in found]))],
            figures=lambda plot: [(case.configuration, self._picture(plot, one)) for case, one in pairs],
        )

    def _run(self, case: ConfiguredCase) -> CriticalSpeeds:
        return case.drivetrain.critical_speeds(
            list(self.outputs),
            excitations=self.excitations or None,
            margin=self.margin,
            reach=self.reach,
            lowest=self.lowest,
            line_frequency=self.line_frequency,
            dampers=self.dampers,
            damper_names=self.damper_names or None,
        )

    def _picture(self, plot: ModuleType, found: CriticalSpeeds) -> Figure:
        if self.stars is None:
            return plot.interference_diagram(found)  # type: ignore[no-any-return]
        found.mode(self.stars)
        stars = [one.star for one in found.crossings if one.mode.number == self.stars and one.star is not None]
        several = [star for star in stars if len(star.vectors) > 1]
        return plot.star_diagrams(several or stars)  # type: ignore[no-any-return]


def _shown(found: CriticalSpeeds) -> Iterator[Table]:
    yield found.mode_table()
    yield found.table()


command = click_command("critical-speeds", CriticalSpeedsCommand)
