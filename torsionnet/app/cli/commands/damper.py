"""Command ``torsionnet damper``, which finds the damping and stiffness with which a vibration is smallest."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from torsionnet.app.cli.cases import ConfiguredCase, ModelCommand
from torsionnet.app.cli.command import TABLE, Answer, click_command, separated_by_lines
from torsionnet.app.cli.options import ANGLE, FiniteFloat, PairType, option
from torsionnet.base.errors import UsageError

if TYPE_CHECKING:
    from torsionnet.machinery.design.damper_optimum import DamperOptimum


class BoundedParameter(PairType):
    """Type of an option value ``NAME`` or ``NAME=LOW..HIGH``, a parameter and its bounds.

    A unit after the second bound is that of the first, too.
    """

    name = "NAME[=LOW..HIGH]"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        name, equals, written = (part.strip() for part in value.partition("="))
        low, dots, high = (part.strip() for part in written.partition(".."))
        if not name or (equals and not (low and dots and high)):
            self.fail(f'expected {self.name}, as in "c_dmp=10..90 kN*m*s/rad", got "{value}"', param, ctx)
        if not equals:
            return name, None
        unit = high.partition(" ")[2]
        return name, (low if " " in low or not unit else f"{low} {unit}", high)


class DamperCommand(ModelCommand):
    """The damping and stiffness of dampers with which the largest vibration is smallest.

    With --input, of one transfer function over a band of frequencies; without, of all orders of what excites the model
    (entries excitations: and speeds:) over its speeds. Bounds that are not given are those of the parameter in the
    model, else a tenth to ten times its value. --csv writes the largest vibration over every value sought.

    \b
    torsionnet damper marine_medium_speed --vary c_dmp --output T_crank --plot film.png
    torsionnet damper plant.yaml --vary damper.damping=20..2000 --output nose --input T_1 --from 5 --to 200
    """

    forms = TABLE
    picture = "the vibration with and without damper, and over the values"

    sought: tuple[tuple[str, tuple[str, str] | None], ...] = option(
        "--vary",
        type=BoundedParameter(),
        required=True,
        help='Parameter or element.field that is sought, "c_dmp=10..90 kN*m*s/rad". Repeatable.',
    )
    channel: str = option("--output", metavar="NAME", help='Sensor or node, or "torque(shaft)": what is to be small.')
    driven: str | None = option("--input", metavar="NAME", help="Input or node; default: the model's excitations act.")
    excitations: tuple[str, ...] = option(
        "--excitation", metavar="NAME", help="Only this one acts. Repeatable.  [default: all of the model]"
    )
    start: float | None = option(
        "--from", type=FiniteFloat(0, min_open=True), help="Lowest frequency in Hz, with --input."
    )
    stop: float | None = option("--to", type=FiniteFloat(0, min_open=True), help="Highest frequency in Hz.")
    angle: str = ANGLE

    def answer(self) -> Answer:
        from torsionnet.base.conventions import Conventions

        if (self.start is None) != (self.stop is None):
            raise UsageError("a band needs both ends: give --from and --to, or neither")
        conventions = Conventions(angle=self.angle)
        cases = self.cases()
        found = self.each("damper", cases, self._designed)
        pairs = list(zip(cases, found, strict=True))
        return Answer(
            screen=lambda: separated_by_lines([one.table(conventions) for one in found]),
            data=lambda: [optimum.record(case.configuration) for case, optimum in pairs],
            csv=lambda: [("", self.combined_table(cases, [one.effect_table() for one in found]))],
            figures=lambda plot: [
                (case.configuration, plot.damper_design(one, conventions=conventions)) for case, one in pairs
            ],
        )

    def _designed(self, case: ConfiguredCase) -> DamperOptimum:
        band = None if self.start is None or self.stop is None else (self.start, self.stop)
        return case.drivetrain.damper_design(
            self.channel,
            dict(self.sought),
            input=self.driven,
            band=band,
            excitations=self.excitations or None,
        )


command = click_command("damper", DamperCommand)
