"""Command ``torsionnet calibrate-wheel``, which finds the errors of pitch of a toothed wheel from its own pulses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from torsionnet.cli.command import TABLE, Answer, Command, click_command
from torsionnet.cli.declarations import argument, option
from torsionnet.cli.options import SETTINGS, EntryOption, FiniteFloat, file_option
from torsionnet.core.errors import UsageError

if TYPE_CHECKING:
    from torsionnet.signals.rotation.calculated_orders import CalculatedOrders
    from torsionnet.signals.rotation.calibration_result import WheelCalibration
    from torsionnet.signals.rotation.wheel import Wheel
    from torsionnet.signals.rotation.wheel_calibration import WheelTest

PATTERN_ENDINGS = (".yaml", ".yml")
NONE = "none"


class CalibrateWheelCommand(Command):
    """Pitch pattern of a toothed wheel, order by order, from pulses at several speeds, or of two pickups.

    One speed cannot tell errors of pitch from vibration of whole orders. Two pickups on one wheel can, and so can the
    calculated orders of a model, or speeds alone in orders of which no part is constant. What stays ambiguous is said,
    with its amount, and left out of the file.

    \b
    torsionnet calibrate-wheel up.npz --pulses fly --teeth 60 --second fly_2 --angle 114deg -o flywheel.yaml
    torsionnet calibrate-wheel 600.npz 900.npz --pulses fly --teeth 60 --index tdc --model plant.yaml --node fly \\
        --zero 12deg -o flywheel.yaml
    """

    forms = TABLE
    picture = "the pattern over teeth and orders"

    records: tuple[str, ...] = argument("RECORD...")
    pulses: str = option("--pulses", metavar="CHANNEL", help="Pulses of the wheel: their times, or counts.")
    teeth: int = option("--teeth", type=click.IntRange(2), help="Pulses per turn of the wheel, missing ones included.")
    missing: int = option("--missing", type=click.IntRange(0), default=0, help="Teeth that the gap lacks: 2 of 60-2.")
    index: str | None = option("--index", metavar="CHANNEL", help="One pulse per turn, before tooth 0.")
    second: str | None = option("--second", metavar="CHANNEL", help="Pulses of a second pickup on the same wheel.")
    between: float | None = option(
        "--angle",
        type=EntryOption("ANGLE", "signals.rotation.calibration_entries:PICKUP_ANGLE"),
        help="From the first pickup to the second in the sense of rotation, to half a pitch: 114deg.",
    )
    tick: float | None = option(
        "--tick", type=EntryOption("TIME", "signals.rotation.calibration_entries:TICK"), help="Of one count: 12.5ns."
    )
    bits: int | None = option("--bits", type=click.IntRange(4, 64), help="Width of the counter, if it wraps.")
    ratio: float = option(
        "--ratio",
        type=FiniteFloat(0, min_open=True),
        default=1.0,
        help="Turns of the reference shaft per turn of the wheel.",
    )
    reversed: bool = option("--reversed", help="The wheel turns against the sense of the model.")
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
        type=EntryOption("ANGLE", "signals.rotation.calibration_entries:ZERO_ANGLE"),
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
        from torsionnet.io.wheel_pattern_files import write_wheel_pattern
        from torsionnet.response import Conventions

        self._refuse_contradictions()
        found = self.calibration()
        degrees = Conventions(angle="deg")
        return Answer(
            screen=lambda: [found.table(degrees)],
            data=found.record,
            csv=lambda: [("", found.table(degrees))],
            files=[(self.output_file, lambda file: write_wheel_pattern(found.stored(), file))],
            figures=lambda plot: [("", plot.wheel_pattern(found))],
        )

    def calibration(self) -> WheelCalibration:
        """Calibrated wheel with its pitch pattern in rad, from the records named."""
        from torsionnet.cli.progress import progress
        from torsionnet.signals.rotation.wheel import Wheel
        from torsionnet.signals.rotation.wheel_calibration import calibrate_wheel

        wheel = Wheel(
            teeth=self.teeth, missing_teeth=self.missing, ratio=self.ratio, reversed=self.reversed
        )  # fmt: skip
        with progress("reading", len(self.records)) as advance:
            tests = []
            for path in self.records:
                tests.append(self._test(path))
                advance(1)
        calculated = self._calculated(tests, wheel) if self.model else None
        with progress("calibrating", None):
            return calibrate_wheel(
                tests,
                wheel,
                angle=self.between,
                calculated=calculated,
                cycle=self.cycle,
                constant_orders=self._constant_orders(),
                name=self.wheel_name,
            )

    def _refuse_contradictions(self) -> None:
        if (self.second is None) != (self.between is None):
            raise click.UsageError("--second and --angle go together: the second pickup and where it is")
        if self.model and not (self.node and self.zero is not None):
            raise click.UsageError(
                "--model needs --node, where the wheel is, and --zero, the crank angle when its tooth 0 passes"
            )
        if not self.model and (self.node or self.zero is not None or self.configuration or self.settings):
            raise click.UsageError("--node, --zero, -c and --set belong to a --model")

    def _test(self, path: str) -> WheelTest:
        from torsionnet.io.recording_files import read_recording
        from torsionnet.signals.rotation.pulse_reading import PulseReading
        from torsionnet.signals.rotation.wheel_calibration import WheelTest

        reading = PulseReading(tick=self.tick, bits=self.bits)
        names = [name for name in (self.pulses, self.second, self.index) if name]
        record = read_recording(path, names=names, pulse_readings=dict.fromkeys(names, reading))
        first, second, index = (
            record.pulses_of(name) if name else None for name in (self.pulses, self.second, self.index)
        )
        assert first is not None
        return WheelTest(first, second, index)

    def _calculated(self, tests: list[WheelTest], wheel: Wheel) -> CalculatedOrders:
        from torsionnet.cli.models import load_model
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
            raise UsageError(f'--constant-orders is a list as 3,6, or none; got "{self.constant}"') from None


command = click_command("calibrate-wheel", CalibrateWheelCommand)
