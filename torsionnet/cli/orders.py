"""``torsionnet orders``."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from torsionnet.cli.cases import ConfiguredCase, ModelCommand
from torsionnet.cli.command import TABLE, Answer, click_command
from torsionnet.cli.declarations import option
from torsionnet.cli.options import ANGLE

if TYPE_CHECKING:
    from torsionnet.response.order_response import OrderResponse
    from torsionnet.response.table import Table


class OrdersCommand(ModelCommand):
    """What engines, propellers and other excitations do to a drivetrain over its speed.

    The model says which in its entries excitations: and speeds:. On the screen each output has its worst speed and the
    orders that make it; --csv writes the complex amplitude of every order at every speed.

    \b
    torsionnet orders plant.yaml --output "torque(coupling)" --plot coupling.png
    torsionnet orders plant.yaml -c all --output T_shaft --csv orders.csv
    """

    forms = TABLE
    picture = "the amplitudes over speed"

    outputs: tuple[str, ...] = option(
        "--output", metavar="NAME", required=True, help='Sensor or node, or "torque(coupling)". Repeatable.'
    )
    excitations: tuple[str, ...] = option(
        "--excitation", metavar="NAME", help="Only this one acts. Repeatable.  [default: all of the model]"
    )
    angle: str = ANGLE

    def answer(self) -> Answer:
        from torsionnet.response import Conventions

        conventions = Conventions(angle=self.angle)
        cases = self.cases()
        found = [self._run(case) for case in cases]
        return Answer(
            screen=lambda: _shown(found, conventions),
            data=lambda: [_as_data(case, run) for case, run in zip(cases, found, strict=True)],
            csv=lambda: [("", self.joined(cases, [run.long_table() for run in found]))],
            figures=lambda plot: [
                (case.configuration, plot.order_response(run, conventions=conventions))
                for case, run in zip(cases, found, strict=True)
            ],
        )

    def _run(self, case: ConfiguredCase) -> OrderResponse:
        return case.drivetrain.order_response(list(self.outputs), excitations=self.excitations or None)


def _shown(found: list[OrderResponse], conventions: Any) -> Iterator[Table | str]:
    for number, (run, channel) in enumerate((one, channel) for one in found for channel in one.outputs):
        yield from [""] if number else []
        yield run.table(channel.name, conventions)


def _as_data(case: ConfiguredCase, run: OrderResponse) -> dict[str, Any]:
    from torsionnet.response.worst_response import WorstResponse

    return {
        "title": run.title,
        "configuration": case.configuration,
        "speed_of": run.reference,
        "speeds_rpm": run.rpm.tolist(),
        "common_cycle_revolutions": run.revolutions,
        "outputs": [
            {
                "output": channel.name,
                "unit": channel.unit,
                "half_range": run.half_range[:, place].tolist(),
                "rms": run.rms[:, place].tolist(),
                "cases": list(run.cases(channel.name)) if isinstance(run, WorstResponse) else None,
                "orders": [
                    {
                        "excitation": line.excitation,
                        "order": line.order,
                        "fixed_Hz": line.fixed,
                        "of_reference": float(line.relative),
                        "real": run.values[:, number, place].real.tolist(),
                        "imag": run.values[:, number, place].imag.tolist(),
                    }
                    for number, line in enumerate(run.lines)
                ],
            }
            for place, channel in enumerate(run.outputs)
        ],
    }


command = click_command("orders", OrdersCommand)
