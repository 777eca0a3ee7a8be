"""Command ``torsionnet static``, which prints mean torque, twist, stress and power of every element."""

from __future__ import annotations

from typing import TYPE_CHECKING

from torsionnet.app.cli.cases import ConfiguredCase, ModelCommand
from torsionnet.app.cli.command import TABLE, Answer, click_command, separated_by_lines
from torsionnet.app.cli.options import ANGLE, EntryOption, option
from torsionnet.app.cli.terminal import message

if TYPE_CHECKING:
    from torsionnet.machinery.mean.static_state import StaticState


class StaticCommand(ModelCommand):
    """Mean torque, twist, shear stress and power of every element under the load of the model.

    The model says in its entry load: who drives and who absorbs, or gives torques in its operating point. Without
    --speed it is examined at the speed of the operating point, else at the rated speed.

    \b
    torsionnet static plant.yaml -c all
    torsionnet static plant.yaml --speed "500 rpm" --csv static.csv
    """

    forms = TABLE

    speed: float | None = option(
        "--speed",
        type=EntryOption("SPEED", "machinery.excitations.speed_range:SPEED"),
        help='Another speed of the node of the entry speeds:, as "500 rpm".',
    )
    angle: str = ANGLE

    def answer(self) -> Answer:
        from torsionnet.base.conventions import Conventions

        conventions = Conventions(angle=self.angle)
        cases, found = self._found()
        return Answer(
            screen=lambda: separated_by_lines(state.table(conventions) for state in found),
            data=lambda: [state.record(case.configuration) for case, state in zip(cases, found, strict=True)],
            csv=lambda: [("", self.combined_table(cases, [state.table(conventions) for state in found]))],
        )

    def _found(self) -> tuple[list[ConfiguredCase], list[StaticState]]:
        """Drivetrains for which the load determines mean torques, and their mean torques, twists and powers.

        Notes name the cases left out.
        """
        from torsionnet.model.load.external_torques import CutOffError

        asked = self.cases()
        cases: list[ConfiguredCase] = []
        found: list[StaticState] = []
        for case in asked:
            try:
                found.append(case.drivetrain.static_state(self.speed))
                cases.append(case)
            except CutOffError as error:
                if len(asked) == 1:
                    raise
                message("note", f"left out {case.configuration}: {error}")
        if not found:
            raise CutOffError(
                "the load determines no mean torques in any of these configurations, for the reasons above; "
                "name with -c one in which the shafts of the load turn together"
            )
        return cases, found


command = click_command("static", StaticCommand)
