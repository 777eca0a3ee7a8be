"""Commands on toothed wheels and their pulses: angles and speeds, pitch errors, clocks of two systems."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import click

from torsionnet.app.cli.command import TABLE, Answer, Command
from torsionnet.app.cli.options import SETTINGS, EntryOption, WrongUsage, argument, file_option, option
from torsionnet.app.cli.pulse_options import PulseOptions
from torsionnet.app.cli.record_options import RecordSpan
from torsionnet.app.cli.terminal import print_warnings
from torsionnet.base.errors import UsageError
from torsionnet.base.notes import NoteOrText, is_warning
from torsionnet.base.packages import imported
from torsionnet.base.result_rows import Out
from torsionnet.base.units import RPM
from torsionnet.signals.recording import Recording

if TYPE_CHECKING:
    from torsionnet.base.table import Table
    from torsionnet.signals.rotation.clock_drift import ClockDrift
    from torsionnet.signals.rotation.counter import PulseReading
    from torsionnet.signals.rotation.pitch_order import CalculatedOrders
    from torsionnet.signals.rotation.pulse_deviations import WheelCalibration
    from torsionnet.signals.rotation.wheel_calibration import WheelTest
    from torsionnet.signals.rotation.wheel_channel import WheelChannel
    from torsionnet.signals.rotation.wheel_rotation import WheelRotation


# Command ``torsionnet angle``, which makes angle and speed with their uncertainty of the pulses of toothed wheels.

DEGREES = 57.29577951308232
"""Degrees in a radian."""


@dataclass(frozen=True)
class OrderUncertainty:
    """Uncertainty of one order of an angle: what errors of pulses add to its peak amplitude, RMS in rad."""

    order: float
    deviation: Annotated[float, Out(json="deviation_rad")]


@dataclass(frozen=True)
class TurnedWheel:
    """Pulses of one wheel, the turns and speeds they show, and what they leave uncertain; times in s, angles in rad."""

    name: Annotated[str, Out("wheel")]
    pulses: Annotated[int, Out("pulses")]
    repairs: Annotated[int, Out("repairs")]
    revolutions: Annotated[float, Out("turns", digits=7)]
    lowest_speed: Annotated[float, Out("lowest speed", "rpm", json="lowest_speed_rad_s", digits=5, factor=RPM)]
    highest_speed: Annotated[float, Out("highest speed", "rpm", json="highest_speed_rad_s", digits=5, factor=RPM)]
    tick: Annotated[float, Out("tick", "us", json="tick_s", digits=3, factor=1e6)]
    jitter: Annotated[float | None, Out("jitter seen", "us", json="jitter_s", digits=3, factor=1e6)]
    tooth_errors: Annotated[float | None, Out("tooth errors", "deg", json="tooth_errors_rad", digits=3, factor=DEGREES)]
    deviation: Annotated[float, Out("deviation of angle", "deg", json="deviation_rad", digits=3, factor=DEGREES)]
    highest_order: Annotated[float, Out("highest order", digits=4)]
    alias_order: Annotated[float, Out("aliases from", digits=4)]
    settled: Annotated[tuple[float, float], Out(json="settled_s")]
    gap: str
    tooth_0: str
    remarks: tuple[NoteOrText, ...]
    orders: tuple[OrderUncertainty, ...]


@dataclass(frozen=True, eq=False)
class TurnedWheels:
    """Wheels of a record, and the record of their angles."""

    SHOWN: ClassVar = ("record", "angles.sampling_rate", "angles.start", "angles.duration", "angles.notes", "wheels")

    record: str
    angles: Recording
    wheels: tuple[TurnedWheel, ...]


class AngleCommand(Command):
    """Angle and speed of shafts from pulses of toothed wheels, with what counter and teeth leave uncertain.

    RECORD holds times of pulses, counts of a clock, or the signal of the teeth. The angle is band-limited between the
    pulses; it is that of the reference shaft, 0 at tooth 0.

    \b
    torsionnet angle run_up.npz --pulses n1 --teeth 60 -o angle.npz
    torsionnet angle run_up.tdms --pulses n1=60 --pulses n2=48 --clock 80MHz --bits 32 --plot angle.png
    torsionnet angle test.mat --pulses crank=60-2 --pickup inductive --orders 6,12
    """

    forms = TABLE
    picture = "speed and uncertainty of the angle over time"

    record: str = argument("RECORD")
    reading: PulseOptions
    span: RecordSpan
    channels: tuple[str, ...] = option(
        "--channel", metavar="CHANNEL", help="Keep this channel, too; the angles then are at its times. Repeatable."
    )
    orders: tuple[float, ...] | None = option(
        "--orders",
        type=EntryOption("ORDERS", "signals.orders.tracking_entries:ORDERS"),
        help="Of the reference shaft: their uncertainty, or why the teeth do not tell them, as 3,6.",
    )
    output_file: str | None = file_option("The record of angle, speed and uncertainty; the ending tells the format.")

    def answer(self) -> Answer:
        from pathlib import Path

        from torsionnet.signals.formats.registry import format_of
        from torsionnet.signals.records.recording_files import write_recording
        from torsionnet.signals.rotation.rotations_of_wheels import angle_record

        if self.output_file:
            format_of(Path(self.output_file), "recording")
        record, wheels = self._turning()
        for wheel in wheels:
            wheel.check_orders(self.orders or ())
        angles = angle_record(record, wheels, keep=self.channels, sampling_rate=self.reading.rate)
        rows = tuple(turned_wheel(rotation, self.orders or ()) for rotation in wheels)
        print_warnings(angles.notes)
        return Answer(
            screen=lambda: _screen(angles, rows),
            csv=lambda: [("", _table(self.record, rows))],
            data=lambda: TurnedWheels(self.record, angles, rows),
            files=[(self.output_file, lambda file: write_recording(angles, file))],
            figures=lambda _: [
                ("", imported("torsionnet.plot.signal_plots:wheel_rotations")(wheels, title=angles.title))
            ],
        )

    def _turning(self) -> tuple[Recording, list[WheelRotation]]:
        """Record with the channels to be kept, and the rotation of every wheel."""
        from torsionnet.base.errors import UsageError
        from torsionnet.io.wheel_files import channels_of, patterns_of, read_turning_record
        from torsionnet.signals.rotation.rotations_of_wheels import rotations_of_wheels

        wheels = self.reading.wheels()
        if not wheels:
            raise UsageError(
                "name the channel of pulses: --pulses n1=60, or a file of wheels: --wheels wheels.yaml",
                kind="missing-entry",
            )
        self.span.check(self.record)
        channels = channels_of(wheels)
        marks = self.reading.marks({wheel.index for wheel in channels.values()}, wheels)
        record = read_turning_record(self.record, channels, marks, self.channels, **self.reading.arguments)
        record = self.span.cut(record)
        return record, list(rotations_of_wheels(record, channels, patterns_of(wheels), marks=marks).values())


def turned_wheel(wheel: WheelRotation, orders: tuple[float, ...] = ()) -> TurnedWheel:
    """Row of a table on the rotation of a wheel, with the uncertainty of the orders given."""
    import numpy as np

    first, last = wheel.settled
    speeds = wheel.speeds[(wheel.times >= first) & (wheel.times <= last)]
    deviations = wheel.deviations
    return TurnedWheel(
        wheel.name, len(wheel.times), wheel.repairs, wheel.revolutions, float(speeds.min()), float(speeds.max()),
        deviations.tick, deviations.jitter, deviations.place if deviations.places is not None else None,
        float(np.sqrt(np.mean(wheel.angle_deviation**2))), wheel.highest_order, wheel.alias_order,
        wheel.settled, wheel.gap, wheel.zero, wheel.remarks,
        tuple(OrderUncertainty(order, wheel.order_deviation(order)) for order in orders),
    )  # fmt: skip


def _table(record: str, rows: tuple[TurnedWheel, ...]) -> Table:
    from torsionnet.base.table import result_table

    return result_table(f"Wheels of {record}", rows, TurnedWheel)


def _screen(angles: Recording, rows: tuple[TurnedWheel, ...]) -> Iterator[Table | str]:
    from torsionnet.base.table import Column, Table

    yield _table(angles.title, rows)
    for row in rows:
        ends = f"settled from {row.settled[0]:.6g} to {row.settled[1]:.6g} s; nearer to the ends high orders are off"
        said = (row.gap, f"tooth 0 is {row.tooth_0}", *row.remarks, ends)
        yield from (f"{row.name}: {text}" for text in said if text)
    yield from (str(note) for note in angles.notes if not is_warning(note))
    if any(row.orders for row in rows):
        columns = (Column("wheel"), Column("order"), Column("errors add, RMS of the peak", "deg", 3))
        lines = tuple((row.name, order.order, order.deviation * DEGREES) for row in rows for order in row.orders)
        yield ""
        yield Table("Orders", columns, lines)


# Command ``torsionnet calibrate-wheel``, which finds the errors of pitch of a toothed wheel from its own pulses.

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
        type=EntryOption("ANGLE", "signals.rotation.pulse_deviations:PICKUP_ANGLE"),
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
        type=EntryOption("ANGLE", "signals.rotation.pulse_deviations:ZERO_ANGLE"),
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
        calibration = self.calibration()
        degrees = Conventions(angle="deg")
        return Answer(
            screen=lambda: [calibration.table(degrees)],
            data=lambda: calibration,
            csv=lambda: [("", calibration.table(degrees))],
            files=[(self.output_file, lambda file: write_wheel_pattern(calibration.stored(), file))],
            figures=lambda plot: [("", plot.wheel_pattern(calibration))],
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
        from torsionnet.io.wheel_files import read_turning_record
        from torsionnet.signals.rotation.wheel_calibration import WheelTest
        from torsionnet.signals.rotation.wheel_channel import wheel_pulses

        self.span.check(path)
        record = self.span.cut(read_turning_record(path, {name: wheel}, marks, **self.reading.arguments))
        pulses = {mark: wheel_pulses(record, mark, reading) for mark, reading in marks.items()}
        return WheelTest(
            wheel_pulses(record, name, wheel), pulses.get(self.second_pickup or ""), pulses.get(wheel.index)
        )

    def _calculated(self, tests: list[WheelTest], wheel: WheelChannel) -> CalculatedOrders:
        from torsionnet.app.cli.options import load_model
        from torsionnet.identification.orders.parametric_orders import calculated_wheel_orders, speed_grid
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


# Command ``torsionnet clocks``, which brings the record of a second system to the clock of the first.


class ClocksCommand(Command):
    """Drift and offset between the clocks of two systems, from a signal or a rotation that both recorded.

    A time t of RECORD is offset + (1 + drift) t of OTHER. With -o OTHER is written on the clock of RECORD.

    \b
    torsionnet clocks rig.npz telemetry.npz --channel T -o together.npz
    torsionnet clocks rig.npz telemetry.npz --pulses crank=60 --same-start -o together.npz
    """

    forms = TABLE

    record: str = argument("RECORD")
    other: str = argument("OTHER")
    reading: PulseOptions
    channel: str | None = option("--channel", metavar="CHANNEL", help="Signal that both recorded, as a torque.")
    same_start: bool = option("--same-start", help="Time 0 is the same on both clocks, as by a common trigger.")
    output_file: str | None = file_option("OTHER on the clock of RECORD; the ending tells the format.")

    def answer(self) -> Answer:
        from torsionnet.base.table import result_table
        from torsionnet.signals.records.recording_files import write_recording
        from torsionnet.signals.rotation.clock_drift import ClockDrift, on_first_clock

        clocks, theirs = self._clocks()
        table = result_table(f"clock of {self.other} against {self.record}", [clocks], ClockDrift, notes=clocks.remarks)
        moved = on_first_clock(theirs, clocks)
        return Answer(
            screen=lambda: [table],
            csv=lambda: [("", table)],
            data=lambda: clocks,
            files=[(self.output_file, lambda file: write_recording(moved, file))],
        )

    def _clocks(self) -> tuple[ClockDrift, Recording]:
        """Clocks of both systems from what both recorded, and the whole record of the second system."""
        from torsionnet.io.wheel_files import channels_of, patterns_of, read_turning_record
        from torsionnet.signals.records.recording_files import channel_names, read_recording
        from torsionnet.signals.rotation.clock_drift import rotation_clocks, signal_clocks
        from torsionnet.signals.rotation.rotations_of_wheels import rotations_of_wheels

        wheels = self.reading.wheels()
        if (self.channel is None) == (len(wheels) != 1):
            raise WrongUsage(
                "name what both recorded: --channel of a signal, or --pulses of one wheel", kind="missing-entry"
            )
        if self.channel is not None:
            if self.same_start:
                raise WrongUsage(
                    "--same-start belongs to --pulses: a signal tells the offset by itself", kind="needless-entry"
                )
            first, second = (self._signal(path, self.channel) for path in (self.record, self.other))
            theirs = read_recording(self.other, **self.reading.arguments)
            return replace(signal_clocks(first, second, self.channel), found_from=self.channel), theirs

        # The angle of one wheel over the clock of either record: it tells the drift.
        channels = channels_of(wheels)
        ((name, _),) = channels.items()
        marks = self.reading.marks({wheel.index for wheel in channels.values()}, wheels)
        kept = [other for other in channel_names(self.other) if other not in {name, *marks}]
        records = [
            read_turning_record(path, channels, marks, own, **self.reading.arguments)
            for path, own in ((self.record, ()), (self.other, kept))
        ]
        turned = [rotations_of_wheels(record, channels, patterns_of(wheels), marks=marks)[name] for record in records]
        return replace(rotation_clocks(*turned, same_start=self.same_start), found_from=name), records[1]

    def _signal(self, path: str, name: str) -> Recording:
        from torsionnet.app.cli.record_options import checked_record
        from torsionnet.signals.records.recording_files import read_recording

        record = read_recording(path, names=[name], **self.reading.arguments)
        return checked_record(record, self.reading, path)
