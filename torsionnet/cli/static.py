"""``torsionnet static``."""

from __future__ import annotations

from torsionnet.cli.cases import ModelCommand
from torsionnet.cli.command import TABLE, Answer, click_command, spaced
from torsionnet.cli.declarations import option
from torsionnet.cli.options import ANGLE, Written


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
        type=Written("SPEED", "model.excitations.speed_range:SPEED"),
        help='Another speed of the node of the entry speeds:, as "500 rpm".',
    )
    angle: str = ANGLE

    def answer(self) -> Answer:
        from torsionnet.response import Conventions

        conventions = Conventions(angle=self.angle)
        cases = self.cases()
        found = [case.drivetrain.static_state(self.speed) for case in cases]
        return Answer(
            screen=lambda: spaced(state.table(conventions) for state in found),
            data=lambda: [
                {"configuration": case.configuration, **state.to_data()}
                for case, state in zip(cases, found, strict=True)
            ],
            csv=lambda: [("", self.joined(cases, [state.table(conventions) for state in found]))],
        )


command = click_command("static", StaticCommand)
