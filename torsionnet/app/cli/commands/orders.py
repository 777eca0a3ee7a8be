"""Command ``torsionnet orders``, which calculates the vibration over speed, order by order."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import click

from torsionnet.app.cli.cases import ConfiguredCase, ModelCommand
from torsionnet.app.cli.command import TABLE, Answer, click_command
from torsionnet.app.cli.options import ANGLE, REFERRED_TO, option, referred_outputs
from torsionnet.base.errors import UsageError

if TYPE_CHECKING:
    from types import ModuleType
    from typing import TypeAlias

    from matplotlib.figure import Figure

    from torsionnet.base.table import Table
    from torsionnet.machinery.orders.calculated_order import SweptComparison
    from torsionnet.machinery.orders.order_response import OrderResponse
    from torsionnet.signals.orders.tracked_orders import MeasuredOrder

    Tests: TypeAlias = dict[str, tuple[MeasuredOrder, ...]]

PICTURES = ("orders", "waterfall", "waveform")


class OrdersCommand(ModelCommand):
    """Vibration of a drivetrain over its speed under engines, propellers and other excitations, order by order.

    The model says which in its entries excitations: and speeds:. On the screen each output has its worst speed and the
    orders that make it, whatever the step of the speeds; --csv writes the complex amplitude of every order at every
    speed, and at those between them that were needed for that.

    \b
    torsionnet orders plant.yaml --output "torque(coupling)" --plot coupling.png
    torsionnet orders plant.yaml -c all --output T_shaft --csv orders.csv
    torsionnet orders plant.yaml -c normal --output T_shaft --measured test.csv --plot compared.png
    """

    forms = TABLE
    picture = "the amplitudes over speed"

    outputs: tuple[str, ...] = option(
        "--output", metavar="NAME", required=True, help='Sensor or node, or "torque(coupling)". Repeatable.'
    )
    excitations: tuple[str, ...] = option(
        "--excitation", metavar="NAME", help="Only this one acts. Repeatable.  [default: all of the model]"
    )
    measured: str | None = option(
        "--measured",
        metavar="FILE",
        help="Orders of a test, to lay over the calculated ones: a file of torsionnet track, or CSV, as speed [rpm], "
        "order, amplitude [N*m], and perhaps phase [deg], half_width [N*m].",
    )
    drawn: str = option(
        "--picture",
        type=click.Choice(PICTURES),
        default=PICTURES[0],
        show_default=True,
        help="What --plot draws: amplitudes over speed, spectra of all speeds one behind the other, or the sum of all "
        "orders over the shaft's angle where it is largest.",
    )
    referred_to: str | None = REFERRED_TO
    angle: str = ANGLE

    def answer(self) -> Answer:
        from torsionnet.base.conventions import Conventions
        from torsionnet.machinery.orders.orders_record import orders_record

        conventions = Conventions(angle=self.angle)
        if self.measured and self.drawn != PICTURES[0]:
            raise UsageError(
                "a measurement can only be drawn into the plot of amplitudes over speed; leave out --picture, or the "
                "measurement"
            )
        if self.measured:
            self.require_one("a test is of one configuration: name one with -c")
        cases = self.cases()
        found = self.each("orders", cases, self._run)
        tests = self._tests(cases[0], found[0]) if self.measured else {}
        fast = self._swept(cases[0], found[0])
        return Answer(
            screen=lambda: self._compared(found[0], tests, fast, conventions) if tests else _shown(found, conventions),
            data=lambda: [
                orders_record(run, case.configuration, tests, fast.orders)
                for case, run in zip(cases, found, strict=True)
            ],
            csv=lambda: [("", self.combined_table(cases, [run.long_table() for run in found]))],
            figures=lambda plot: [
                (case.configuration + ending, figure)
                for case, run in zip(cases, found, strict=True)
                for ending, figure in self._pictures(plot, run, tests, fast.orders, conventions)
            ],
        )

    def _pictures(
        self, plot: ModuleType, run: OrderResponse, tests: Tests, swept: Mapping[str, Any], conventions: Any
    ) -> Iterator[tuple[str, Figure]]:
        """Endings of file names, and figures of the vibration over speed.

        One with all outputs, or one for each output.
        """
        if tests:
            yield "", plot.order_overlay(run, tests, conventions=conventions, swept=swept)
            return
        if self.drawn == PICTURES[0]:
            yield "", plot.order_response(run, conventions=conventions)
            return
        for place, channel in enumerate(run.outputs):
            ending = f" {channel.name}" if len(run.outputs) > 1 else ""
            if self.drawn == "waterfall":
                yield ending, plot.waterfall(run, channel.name, conventions=conventions)
            else:
                worst = run.rpm[run.half_range[:, place].argmax()]
                yield ending, plot.waveform(run, channel.name, rpm=worst, conventions=conventions)

    def _tests(self, case: ConfiguredCase, run: OrderResponse) -> Tests:
        """Orders measured at each output of the drivetrain, by output name."""
        from torsionnet.io.tracked_order_tables import read_orders

        return {channel.name: read_orders(str(self.measured), channel, case.configuration) for channel in run.outputs}

    def _swept(self, case: ConfiguredCase, run: OrderResponse) -> SweptComparison:
        """Orders of the model along the speed over time of a run-up too fast for steady peaks, and remarks on it."""
        from torsionnet.io.tracked_order_tables import is_tracked_table, tracked_channel
        from torsionnet.machinery.orders.calculated_order import SweptComparison, swept_comparison

        if not self.measured or not is_tracked_table(self.measured):
            return SweptComparison()
        tracked = tracked_channel(self.measured, run.outputs[0])
        outputs = referred_outputs(self.outputs, self.referred_to)
        return swept_comparison(case.drivetrain, run, outputs, tracked, self.excitations or None)

    def _compared(
        self, run: OrderResponse, tests: Tests, fast: SweptComparison, conventions: Any
    ) -> Iterator[Table | str]:
        """Yield tables of measured and calculated orders, and remarks on a run-up too fast for the steady response."""
        from torsionnet.machinery.orders.order_comparison import order_comparison

        for number, (name, measured) in enumerate(tests.items()):
            yield from [""] if number else []
            yield order_comparison(run, name, measured, conventions, fast.orders.get(name, ()))
        yield from fast.remarks

    def _run(self, case: ConfiguredCase) -> OrderResponse:
        return case.drivetrain.order_response(
            referred_outputs(self.outputs, self.referred_to), excitations=self.excitations or None, refine=True
        )


def _shown(found: list[OrderResponse], conventions: Any) -> Iterator[Table | str]:
    for number, (run, channel) in enumerate((one, channel) for one in found for channel in one.outputs):
        yield from [""] if number else []
        yield run.table(channel.name, conventions)


command = click_command("orders", OrdersCommand)
