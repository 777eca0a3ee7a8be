"""Commands that judge and improve a drivetrain by its limits: ``limits`` and ``damper``."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from torsionnet.app.cli.command import TABLE, Answer, ConfiguredCase, ModelCommand, separated_by_lines
from torsionnet.app.cli.options import ANGLE, NONLINEAR, FiniteFloat, PairType, band_option, option, refuse

if TYPE_CHECKING:
    from torsionnet.base.conventions import Conventions
    from torsionnet.base.table import Table
    from torsionnet.machinery.design.damper_optimum import DamperOptimum
    from torsionnet.machinery.verdicts.limit_check import LimitCheck
    from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion
    from torsionnet.machinery.verdicts.measured_range import MeasuredRange


# Command ``torsionnet limits``, which judges whether the elements bear what an engine does to them.

LIMIT_FAILS, NOT_ALL_JUDGED = 5, 6
"""Exit codes if a limit fails, and if none fails but not all limits and configurations were examined or judged."""


class LimitsCommand(ModelCommand):
    """Whether shafts, couplings, gears and dampers bear what an engine does to them, and which speeds are barred.

    The model says what they bear in its entry limits: and what runs in excitations: and speeds:. Every limit is judged
    at its worst speed: "pass", "barred range" (it holds outside of the speeds given), "reduced speed" (with a cylinder
    out it holds up to a highest speed), "fail", or "not judged". With -c all the worst of every limit stands first;
    what follows for operation is a table of instructions. Between
    the speeds of a range more are examined until the result does not depend on their step. The last line is the verdict
    on the model: "incomplete" unless all configurations (-c all) and limits were examined. Exit code 5 if a limit
    fails, 6 if none does but the verdict is "incomplete" or "not judged"; a barred range is no failure. --csv writes
    value and value allowed at every speed.

    \b
    torsionnet limits plant.yaml -c all
    torsionnet limits plant.yaml -c misfire --plot misfire.png --csv misfire.csv
    torsionnet limits plant.yaml -c normal --measured tracked.csv --plot beside.png
    """

    forms = TABLE
    picture = "orders over speed with their limits and barred ranges"

    limits: tuple[str, ...] = option(
        "--limit", metavar="NAME", help="Only this limit. Repeatable.  [default: all of the model]"
    )
    measured: str | None = option(
        "--measured",
        metavar="FILE",
        help="Half ranges of a test, to lay beside limits and barred ranges: a file of torsionnet track.",
    )
    nonlinear: str | None = NONLINEAR
    angle: str = ANGLE

    def answer(self) -> Answer:
        from torsionnet.base.conventions import Conventions
        from torsionnet.machinery.verdicts.limit_conclusion import ConcludedCheck, LimitConclusion

        conventions = Conventions(angle=self.angle)
        if self.measured:
            self.require_one("a test is of one configuration: name one with -c")
        cases = self.cases()
        checks = self.each("limits", cases, self._checked)
        overall = LimitConclusion(tuple(checks))
        tests = self._tests(cases[0], checks[0]) if self.measured else ()
        return Answer(
            screen=lambda: self._shown(cases, overall, tests, conventions),
            data=lambda: [ConcludedCheck(**vars(check), overall=overall, measured=tests or None) for check in checks],
            csv=lambda: [("", self.combined_table(cases, [check.long_table() for check in checks]))],
            figures=lambda plot: [
                (case.configuration, plot.limit_check(check, conventions=conventions, measured=tests))
                for case, check in zip(cases, checks, strict=True)
            ],
            exit_code=_exit_code(overall.verdict),
        )

    def _checked(self, case: ConfiguredCase) -> LimitCheck:
        return case.drivetrain.check_limits(self.limits or None, nonlinear=self.nonlinear)

    def _tests(self, case: ConfiguredCase, check: LimitCheck) -> tuple[MeasuredRange, ...]:
        """Half ranges of the test beside the limits that judge them."""
        from torsionnet.io.tracked_order_tables import read_tracked_orders
        from torsionnet.machinery.verdicts.measured_range import measured_ranges

        return measured_ranges(case.drivetrain, check, read_tracked_orders(str(self.measured)))

    def _shown(
        self,
        cases: list[ConfiguredCase],
        overall: LimitConclusion,
        tests: tuple[MeasuredRange, ...],
        conventions: Conventions,
    ) -> Iterator[Table | str]:
        from torsionnet.machinery.excitations.reciprocating_engine import conditions_running_alone
        from torsionnet.machinery.verdicts.limit_verdict import PASS

        if len(overall.checks) > 1:
            yield replace(overall.worst_table(conventions), title=f"{cases[0].drivetrain.name}: worst of every limit")
            yield ""
        table = self.combined_table(cases, [check.table(conventions) for check in overall.checks])
        yield replace(table, title=f"{cases[0].drivetrain.name}: limits", notes=())
        yield ""
        yield from table.notes
        conditions = [(case.configuration, case.drivetrain.definition.excitations) for case in cases]
        for engine, names in conditions_running_alone(conditions).items():
            yield f"running on {engine} alone: {'examined in ' + ', '.join(names) if names else 'not examined'}"
        yield ""
        # The finding of a single condition is in the last line.
        worse = [check for check in overall.checks if check.verdict != PASS] if len(overall.checks) > 1 else []
        for check in worse:
            yield f"{check.configuration}: {check.finding()}"
        if worse:
            yield ""
        if tests:
            from torsionnet.machinery.verdicts.measured_range import measured_range_table

            yield measured_range_table(f"{cases[0].drivetrain.name}: measured half ranges", tests, conventions)
            yield ""
        instructions = overall.instruction_table(conventions)
        if instructions.rows:
            yield instructions
            yield ""
        yield f"{cases[0].drivetrain.name}: {overall.verdict}: {overall.sentence}"


def _exit_code(verdict: str) -> int:
    from torsionnet.machinery.verdicts.limit_verdict import FAIL, INCOMPLETE, OPEN

    return LIMIT_FAILS if verdict == FAIL else NOT_ALL_JUDGED if verdict in (INCOMPLETE, OPEN) else 0


# Command ``torsionnet damper``, which finds the damping and stiffness with which a vibration is smallest.


class BoundedParameter(PairType):
    """Type of an option value ``NAME`` or ``NAME=LOW..HIGH``, a parameter and its bounds.

    A unit after the second bound is that of the first, too.
    """

    name = "NAME[=LOW..HIGH]"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        name, equals, written = (part.strip() for part in value.partition("="))
        low, dots, high = (part.strip() for part in written.partition(".."))
        if not name or (equals and not (low and dots and high)):
            refuse(
                f'expected {self.name}, as in "c_dmp=10..90 kN*m*s/rad", got "{value}"', param, ctx, kind="wrong-form"
            )
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
    torsionnet damper plant.yaml --vary damper.damping=20..2000 --output nose --input T_1 --band 5 200
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
    band: tuple[float, float] | None = band_option("Frequencies in Hz, with --input.", FiniteFloat(0, min_open=True))
    angle: str = ANGLE

    def answer(self) -> Answer:
        from torsionnet.base.conventions import Conventions

        conventions = Conventions(angle=self.angle)
        cases = self.cases()
        designs = self.each("damper", cases, self._designed)
        pairs = list(zip(cases, designs, strict=True))
        return Answer(
            screen=lambda: separated_by_lines([design.table(conventions) for design in designs]),
            data=lambda: designs,
            csv=lambda: [("", self.combined_table(cases, [design.effect_table() for design in designs]))],
            figures=lambda plot: [
                (case.configuration, plot.damper_design(design, conventions=conventions)) for case, design in pairs
            ],
        )

    def _designed(self, case: ConfiguredCase) -> DamperOptimum:
        return case.drivetrain.damper_design(
            self.channel,
            dict(self.sought),
            input=self.driven,
            band=self.band,
            excitation=self.excitations or None,
        )
