"""Commands on running machinery: ``orders``, ``critical-speeds`` and ``holzer``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import click

from torsionnet.app.cli.command import TABLE, Answer, ConfiguredCase, ModelCommand, separated_by_lines
from torsionnet.app.cli.options import ANGLE, NONLINEAR, REFERRED_TO, EntryOption, WrongUsage, option, referred_outputs
from torsionnet.base.errors import UsageError

if TYPE_CHECKING:
    from types import ModuleType
    from typing import TypeAlias

    from matplotlib.figure import Figure

    from torsionnet.base.table import Table
    from torsionnet.machinery.criticals.critical_speeds import CriticalSpeeds
    from torsionnet.machinery.holzer.holzer_table import HolzerTable
    from torsionnet.machinery.orders.calculated_order import SweptComparison
    from torsionnet.machinery.orders.order_response import OrderResponse
    from torsionnet.signals.orders.tracked_orders import MeasuredOrder

    Tests: TypeAlias = dict[str, tuple[MeasuredOrder, ...]]


# Command ``torsionnet orders``, which calculates the vibration over speed, order by order.

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
    nonlinear: str | None = NONLINEAR
    referred_to: str | None = REFERRED_TO
    angle: str = ANGLE

    def answer(self) -> Answer:
        from torsionnet.base.conventions import Conventions
        from torsionnet.machinery.orders.orders_over_speed import orders_over_speed

        conventions = Conventions(angle=self.angle)
        if self.measured and self.drawn != PICTURES[0]:
            raise UsageError(
                "a measurement can only be drawn into the plot of amplitudes over speed; leave out --picture, or the "
                "measurement",
                kind="contradicting-entries",
            )
        if self.measured:
            self.require_one("a test is of one configuration: name one with -c")
        cases = self.cases()
        runs = self.each("orders", cases, self._run)
        tests = self._tests(cases[0], runs[0]) if self.measured else {}
        fast = self._swept(cases[0], runs[0])
        return Answer(
            screen=lambda: self._compared(runs[0], tests, fast, conventions) if tests else _shown(runs, conventions),
            data=lambda: [
                orders_over_speed(run, case.configuration, tests, fast.orders)
                for case, run in zip(cases, runs, strict=True)
            ],
            csv=lambda: [("", self.combined_table(cases, [run.long_table() for run in runs]))],
            figures=lambda plot: [
                (case.configuration + ending, figure)
                for case, run in zip(cases, runs, strict=True)
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
            from torsionnet.plot.order_overlay_plot import order_overlay

            yield "", order_overlay(run, tests, conventions=conventions, swept=swept)
            return
        if self.drawn == PICTURES[0]:
            yield "", plot.order_response(run, conventions=conventions)
            return
        for place, channel in enumerate(run.outputs):
            ending = f" {channel.name}" if len(run.outputs) > 1 else ""
            if self.drawn == "waterfall":
                yield ending, plot.waterfall(run, channel.name, conventions=conventions)
            else:
                worst = run.speeds[run.half_range[:, place].argmax()]
                yield ending, plot.waveform(run, channel.name, speed=worst, conventions=conventions)

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
            referred_outputs(self.outputs, self.referred_to),
            excitation=self.excitations or None,
            refine=True,
            nonlinear=self.nonlinear,
        )


def _shown(runs: list[OrderResponse], conventions: Any) -> Iterator[Table | str]:
    for number, (run, channel) in enumerate((each, channel) for each in runs for channel in each.outputs):
        yield from [""] if number else []
        yield run.table(channel.name, conventions)


# Command ``torsionnet critical-speeds``, which finds the speeds at which orders meet natural frequencies.

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
    lowest: int | None = option(
        "--lowest", type=click.IntRange(min=1), metavar="N", help="Only the N lowest vibrations."
    )
    line_frequency: float | None = option("--line-frequency", metavar="HZ", help="Also once and twice this frequency.")
    rings: str = option(
        "--rings", type=click.Choice(STATES), default=STATES[0], show_default=True, help="Rings of viscous dampers."
    )
    damper: tuple[str, ...] = option(
        "--damper", metavar="NAME", help="A damper, or a film.  [default: every viscous_damper]"
    )
    stars: int | None = option("--stars", type=click.IntRange(min=1), metavar="MODE", help="--plot draws these.")

    def answer(self) -> Answer:
        cases = self.cases()
        each = self.each("critical speeds", cases, self._run)
        speeds_of_cases = [speeds.in_conditions([other for other in each if other is not speeds]) for speeds in each]
        pairs = list(zip(cases, speeds_of_cases, strict=True))
        return Answer(
            screen=lambda: separated_by_lines(
                part for speeds in speeds_of_cases for part in _critical_speeds_shown(speeds)
            ),
            data=lambda: speeds_of_cases,
            csv=lambda: [("", self.combined_table(cases, [speeds.table() for speeds in speeds_of_cases]))],
            figures=lambda plot: [(case.configuration, self._picture(plot, speeds)) for case, speeds in pairs],
        )

    def _run(self, case: ConfiguredCase) -> CriticalSpeeds:
        return case.drivetrain.critical_speeds(
            list(self.outputs),
            excitation=self.excitations or None,
            margin=self.margin,
            reach=self.reach,
            lowest=self.lowest,
            line_frequency=self.line_frequency,
            rings=self.rings,
            damper=self.damper or None,
        )

    def _picture(self, plot: ModuleType, speeds: CriticalSpeeds) -> Figure:
        if self.stars is None:
            return plot.interference_diagram(speeds)  # type: ignore[no-any-return]
        speeds.mode(self.stars)
        stars = [
            crossing.star
            for crossing in speeds.crossings
            if crossing.mode.number == self.stars and crossing.star is not None
        ]
        several = [star for star in stars if len(star.vectors) > 1]
        return plot.star_diagrams(several or stars)  # type: ignore[no-any-return]


def _critical_speeds_shown(speeds: CriticalSpeeds) -> Iterator[Table]:
    yield speeds.mode_table()
    yield speeds.table()


# Command ``torsionnet holzer``, which prints the Holzer table of a mode or a trial frequency.


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
        if self.mode is not None and self.at is not None:
            text = "--mode and --at both give the frequency of a Holzer table; leave out one of them"
            raise WrongUsage(text, kind="contradicting-entries")
        if self.mode is None and self.at is None:
            raise WrongUsage(
                "a Holzer table needs a frequency: give a mode, as --mode 1, or --at HZ for a trial frequency",
                kind="missing-entry",
            )
        cases = self.cases()
        results = self.each("Holzer table", cases, self._run)
        return Answer(
            screen=lambda: separated_by_lines(
                table for result in results for table in result.tables(referred=self.referred)
            ),
            data=lambda: results,
            csv=lambda: [
                ("", self.combined_table(cases, [result.table(referred=self.referred) for result in results]))
            ],
        )

    def _run(self, case: ConfiguredCase) -> HolzerTable:
        return case.drivetrain.holzer_table(
            self.mode, at=self.at, first=self.first, amplitude=self.amplitude, referred_to=self.referred_to
        )
