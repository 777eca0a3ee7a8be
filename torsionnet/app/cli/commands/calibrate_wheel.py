"""Command ``torsionnet calibrate-wheel``, which finds the errors of pitch of a toothed wheel from its own pulses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from torsionnet.app.cli.command import TABLE, Answer, Command
from torsionnet.app.cli.options import SETTINGS, EntryOption, WrongUsage, argument, file_option, option
from torsionnet.app.cli.pulse_options import PulseOptions
from torsionnet.app.cli.record_options import RecordSpan
from torsionnet.base.errors import UsageError

if TYPE_CHECKING:
    from torsionnet.signals.rotation.calibration_result import WheelCalibration
    from torsionnet.signals.rotation.counter import PulseReading
    from torsionnet.signals.rotation.pitch_order import CalculatedOrders
    from torsionnet.signals.rotation.wheel_calibration import WheelTest
    from torsionnet.signals.rotation.wheel_channel import WheelChannel

PATTERN_ENDINGS = (".yaml", ".yml")
NONE = "none"


class CalibrateWheelCommand(Command):
    """Pitch pattern of a toothed wheel, order by order, from pulses at several speeds, or of two pickups.

    One speed cannot tell errors of pitch from vibration of whole orders. Two pickups on one wheel can, and so can the
    calculated orders of a model, or speeds alone in orders of which no part is constant. What stays ambiguous is said,
    with its amount, and left out of the file.

    \b
    torsionnet calibrate-wheel up.npz --pulses fly=60 --second-pickup fly_2 --pickup-angle 114deg -o flywheel.yaml
    torsionnet calibrate-wheel 600.npz 900.npz --pulses fly=60 --index tdc --model plant.yaml --node fly \\
        --zero 12deg -o flywheel.yaml
    """

    forms = TABLE
    picture = "the pattern over teeth and orders"

    records: tuple[str, ...] = argument("RECORD...")
    reading: PulseOptions
    span: RecordSpan
    second_pickup: str | None = option(
        "--second-pickup", metavar="CHANNEL", help="Pulses of a second pickup on the same wheel."
    )
    between: float | None = option(
        "--pickup-angle",
        type=EntryOption("ANGLE", "signals.rotation.calibration_result:PICKUP_ANGLE"),
        help="From the first pickup to the second in the sense of rotation, to half a pitch: 114deg.",
    )
    cycle: int = option(
        "--cycle",
        type=click.IntRange(1),
        default=2,
        help="Turns of the reference shaft until vibration repeats.  [default: 2]",
    )
    model: str | None = option("--model", metavar="MODEL", help="Whose calculated orders tell vibration from pattern.")
    node: str | None = option("--node", metavar="NODE", help="Of the model, where the wheel is.")
    configuration: str | None = option("--configuration", "-c", metavar="NAME", help="Of the model.")
    settings: tuple[tuple[str, str], ...] = SETTINGS
    zero: float | None = option(
        "--zero",
        type=EntryOption("ANGLE", "signals.rotation.calibration_result:ZERO_ANGLE"),
        help="With a model: its crank angle, 0 at top dead centre of the first cylinder, when tooth 0 passes.",
    )
    constant: str | None = option(
        "--constant-orders",
        metavar="ORDERS",
        help="With one pickup and no model: orders of which a part may be constant over speed, as 3,6; or none.",
    )
    wheel_name: str = option("--name", default="", help="Of the wheel, with machine and date, for its file.")
    output_file: str | None = file_option("Write the pattern: YAML.", PATTERN_ENDINGS)

    def answer(self) -> Answer:
        from torsionnet.base.conventions import Conventions
        from torsionnet.io.wheel_files import write_wheel_pattern

        self._refuse_contradictions()
        found = self.calibration()
        degrees = Conventions(angle="deg")
        return Answer(
            screen=lambda: [found.table(degrees)],
            data=lambda: found,
            csv=lambda: [("", found.table(degrees))],
            files=[(self.output_file, lambda file: write_wheel_pattern(found.stored(), file))],
            figures=lambda plot: [("", plot.wheel_pattern(found))],
        )

    def calibration(self) -> WheelCalibration:
        """Calibrated wheel with its pitch pattern in rad, from the records named."""
        from torsionnet.app.cli.terminal import progress
        from torsionnet.signals.rotation.wheel_calibration import calibrate_wheel

        name, wheel, marks = self._wheel()
        with progress("reading", len(self.records)) as advance:
            tests = []
            for path in self.records:
                tests.append(self._test(path, name, wheel, marks))
                advance(1)
        calculated = self._calculated(tests, wheel) if self.model else None
        with progress("calibrating", None):
            return calibrate_wheel(
                tests,
                wheel,
                pickup_angle=self.between,
                calculated=calculated,
                cycle=self.cycle,
                constant_orders=self._constant_orders(),
                name=self.wheel_name,
            )

    def _refuse_contradictions(self) -> None:
        if (self.second_pickup is None) != (self.between is None):
            raise WrongUsage(
                "--second-pickup and --pickup-angle go together: the second pickup and where it is",
                kind="missing-entry",
            )
        if self.reading.pattern:
            raise WrongUsage(
                "a calibration finds the pitch pattern from the pulses alone: leave --pattern out",
                kind="needless-entry",
            )
        if self.model and not (self.node and self.zero is not None):
            raise WrongUsage(
                "--model needs --node, where the wheel is, and --zero, the crank angle when its tooth 0 passes",
                kind="missing-entry",
            )
        if not self.model and (self.node or self.zero is not None or self.configuration or self.settings):
            raise WrongUsage("--node, --zero, -c and --set belong to a --model", kind="needless-entry")

    def _wheel(self) -> tuple[str, WheelChannel, dict[str, PulseReading]]:
        """Channel of the wheel that is calibrated, the wheel, and how other channels of its pulses are read."""
        from torsionnet.io.wheel_files import channels_of

        second = self.second_pickup
        wheels = self.reading.wheels(marks=filter(None, (second,)))
        chosen = channels_of({name: wheel for name, wheel in wheels.items() if name != second})
        if len(chosen) != 1:
            there = f"; there is {', '.join(chosen)}" if chosen else ""
            raise UsageError(
                f"one wheel is calibrated at a time: name the channel of its pulses, --pulses fly=60{there}",
                kind="missing-entry",
            )
        ((name, wheel),) = chosen.items()
        marks = self.reading.marks(filter(None, (wheel.index,)), wheels)
        return name, wheel, {**marks, **self.reading.marks((second,), wheels, like=name)}

    def _test(self, path: str, name: str, wheel: WheelChannel, marks: dict[str, PulseReading]) -> WheelTest:
        from torsionnet.io.turning_records import read_turning_record
        from torsionnet.signals.rotation.wheel_calibration import WheelTest
        from torsionnet.signals.rotation.wheel_channel import wheel_pulses

        self.span.check(path)
        record = self.span.cut(read_turning_record(path, {name: wheel}, marks, **self.reading.arguments))
        found = {mark: wheel_pulses(record, mark, one) for mark, one in marks.items()}
        return WheelTest(wheel_pulses(record, name, wheel), found.get(self.second_pickup or ""), found.get(wheel.index))

    def _calculated(self, tests: list[WheelTest], wheel: WheelChannel) -> CalculatedOrders:
        from torsionnet.app.cli.options import load_model
        from torsionnet.identification.wheel_orders import calculated_wheel_orders, speed_grid
        from torsionnet.signals.rotation.wheel_calibration import speed_range

        plant: Any = load_model(str(self.model))
        if self.configuration or self.settings:
            plant = plant.configured(self.configuration or "", **dict(self.settings))
        speeds = speed_grid(*speed_range(tests, wheel))
        return calculated_wheel_orders(plant, str(self.node), speeds, zero=float(self.zero or 0.0))

    def _constant_orders(self) -> list[float] | None:
        if self.constant is None:
            return None
        if self.constant.strip().lower() == NONE:
            return []
        try:
            return [float(word) for word in self.constant.split(",")]
        except ValueError:
            raise UsageError(
                f'--constant-orders is a list as 3,6, or none; got "{self.constant}"', kind="wrong-form"
            ) from None
