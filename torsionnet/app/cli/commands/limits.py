"""Command ``torsionnet limits``, which judges whether the elements bear what an engine does to them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from torsionnet.app.cli.cases import ConfiguredCase, ModelCommand
from torsionnet.app.cli.command import TABLE, Answer, click_command
from torsionnet.app.cli.options import ANGLE, option

if TYPE_CHECKING:
    from torsionnet.base.conventions import Conventions
    from torsionnet.base.table import Table
    from torsionnet.machinery.verdicts.limit_check import LimitCheck
    from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion
    from torsionnet.machinery.verdicts.measured_range import MeasuredRange

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
    angle: str = ANGLE

    def answer(self) -> Answer:
        from torsionnet.base.conventions import Conventions
        from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion

        conventions = Conventions(angle=self.angle)
        if self.measured:
            self.require_one("a test is of one configuration: name one with -c")
        cases = self.cases()
        found = self.each("limits", cases, lambda case: case.drivetrain.check_limits(self.limits or None))
        overall = LimitConclusion(tuple(found))
        tests = self._tests(cases[0], found[0]) if self.measured else ()
        return Answer(
            screen=lambda: self._shown(cases, overall, tests, conventions),
            data=lambda: [
                replace(one, measured=tuple(test.row() for test in tests)) if tests else one
                for one in overall.records()
            ],
            csv=lambda: [("", self.combined_table(cases, [one.long_table() for one in found]))],
            figures=lambda plot: [
                (case.configuration, plot.limit_check(one, conventions=conventions, measured=tests))
                for case, one in zip(cases, found, strict=True)
            ],
            exit_code=_exit_code(overall.verdict),
        )

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
        from torsionnet.machinery.verdicts.limit_check import PASS
        from torsionnet.machinery.verdicts.operating_instructions import instruction_table

        if len(overall.checks) > 1:
            yield replace(overall.worst_table(conventions), title=f"{cases[0].drivetrain.name}: worst of every limit")
            yield ""
        table = self.combined_table(cases, [one.table(conventions) for one in overall.checks])
        yield replace(table, title=f"{cases[0].drivetrain.name}: limits", notes=())
        yield ""
        yield from table.notes
        conditions = [(one.configuration, one.drivetrain.definition.excitations) for one in cases]
        for engine, names in conditions_running_alone(conditions).items():
            yield f"running on {engine} alone: {'examined in ' + ', '.join(names) if names else 'not examined'}"
        yield ""
        worse = [one for one in overall.checks if one.verdict != PASS] if len(overall.checks) > 1 else []
        for one in worse:
            yield f"{one.configuration}: {one.finding()}"
        if worse:
            yield ""
        if tests:
            from torsionnet.machinery.verdicts.measured_range import measured_range_table

            yield measured_range_table(f"{cases[0].drivetrain.name}: measured half ranges", tests, conventions)
            yield ""
        instructions = instruction_table(overall.checks, conventions)
        if instructions.rows:
            yield instructions
            yield ""
        yield f"{cases[0].drivetrain.name}: {overall.verdict}: {overall.sentence}"


def _exit_code(verdict: str) -> int:
    from torsionnet.machinery.verdicts.limit_check import FAIL, INCOMPLETE, OPEN

    return LIMIT_FAILS if verdict == FAIL else NOT_ALL_JUDGED if verdict in (INCOMPLETE, OPEN) else 0


command = click_command("limits", LimitsCommand)
