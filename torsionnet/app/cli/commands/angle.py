"""Command ``torsionnet angle``, which makes angle and speed with their uncertainty of the pulses of toothed wheels."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

from torsionnet.app.cli.command import TABLE, Answer, Command
from torsionnet.app.cli.options import EntryOption, argument, file_option, option
from torsionnet.app.cli.pulse_options import PulseOptions
from torsionnet.app.cli.record_options import RecordSpan
from torsionnet.app.cli.terminal import print_warnings
from torsionnet.base.notes import NoteOrText, is_warning
from torsionnet.base.packages import imported
from torsionnet.base.result_rows import Out
from torsionnet.base.units import RPM
from torsionnet.signals.recording import Recording

if TYPE_CHECKING:
    from torsionnet.base.table import Table
    from torsionnet.signals.rotation.wheel_rotation import WheelRotation

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
        found, wheels = self._turning()
        for wheel in wheels:
            wheel.check_orders(self.orders or ())
        angles = angle_record(found, wheels, keep=self.channels, sampling_rate=self.reading.rate)
        rows = tuple(turned_wheel(one, self.orders or ()) for one in wheels)
        print_warnings(angles.notes)
        return Answer(
            screen=lambda: _screen(angles, rows),
            csv=lambda: [("", _table(self.record, rows))],
            data=lambda: TurnedWheels(self.record, angles, rows),
            files=[(self.output_file, lambda file: write_recording(angles, file))],
            figures=lambda _: [
                ("", imported("torsionnet.plot.wheel_plots:wheel_rotations")(wheels, title=angles.title))
            ],
        )

    def _turning(self) -> tuple[Recording, list[WheelRotation]]:
        """Record with the channels to be kept, and the rotation of every wheel."""
        from torsionnet.base.errors import UsageError
        from torsionnet.io.turning_records import read_turning_record
        from torsionnet.io.wheel_files import channels_of, patterns_of
        from torsionnet.signals.rotation.rotations_of_wheels import rotations_of_wheels

        wheels = self.reading.wheels()
        if not wheels:
            raise UsageError(
                "name the channel of pulses: --pulses n1=60, or a file of wheels: --wheels wheels.yaml",
                kind="missing-entry",
            )
        self.span.check(self.record)
        channels = channels_of(wheels)
        marks = self.reading.marks({one.index for one in channels.values()}, wheels)
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
        lines = tuple((row.name, one.order, one.deviation * DEGREES) for row in rows for one in row.orders)
        yield ""
        yield Table("Orders", columns, lines)
