"""Command ``torsionnet track``, which finds the complex orders of the signals of a turning machine."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from torsionnet.app.cli.command import TABLE, Answer, Command
from torsionnet.app.cli.options import ANGLE, EntryOption, PairOption, WrongUsage, argument, file_option, option
from torsionnet.app.cli.pulse_options import NamedWheel, PulseOptions, TeethOption
from torsionnet.app.cli.record_options import RecordSpan
from torsionnet.base.errors import UsageError, did_you_mean

if TYPE_CHECKING:
    from types import ModuleType

    from matplotlib.figure import Figure

    from torsionnet.base.conventions import Conventions
    from torsionnet.base.table import Table
    from torsionnet.io.wheel_files import WheelOfTest
    from torsionnet.signals.orders.cycle_average import CycleAverage
    from torsionnet.signals.orders.mean_rotation import MeanRotation
    from torsionnet.signals.orders.track_orders import PhaseMark
    from torsionnet.signals.orders.tracked_orders import TrackedOrders
    from torsionnet.signals.orders.tracked_signals import Twist
    from torsionnet.signals.orders.vold_kalman import VoldKalman
    from torsionnet.signals.rotation.pulse_channel import PulseChannel
    from torsionnet.signals.rotation.wheel_rotation import WheelRotation

METHODS = ("average", "vold-kalman")
PICTURES = ("slices", "waterfall")
_ENTRIES = "signals.orders.tracking_entries"


class TrackCommand(Command):
    """Complex orders of signals and of wheels over speed: amplitude, phase from top dead centre, 95 % interval.

    The reference shaft is that of a wheel (--reference-shaft fly=60), or a channel of its angle or speed. Orders are
    over its mean angle of rotation. With -o the orders are written for `torsionnet orders --measured` and fits.

    \b
    torsionnet track up.npz --reference-shaft fly=60-2 --tdc 35deg --cam cam --channel T --orders 0.5:12:0.5 -o up.csv
    torsionnet track up.npz --wheels wheels.yaml --reference-shaft fly --orders 0.5:12:0.5 -o up.csv
    torsionnet track up.npz --reference-shaft fly=60 --pulses gen=60 --twist fly-gen --stiffness 2MN*m/rad --orders 3,6
    """

    forms = TABLE
    picture = "the orders over speed"

    record: str = argument("RECORD")
    reference: NamedWheel = option(
        "--reference-shaft",
        type=TeethOption(),
        required=True,
        help="Wheel of the reference shaft, fly=60, fly=60-2 with a gap, or fly of --wheels; or its angle or speed.",
    )
    channels: tuple[str, ...] = option(
        "--channel", metavar="CHANNEL", help="Signal or wheel. Repeatable; default: all signals and wheels."
    )
    orders: tuple[float, ...] = option(
        "--orders", type=EntryOption("ORDERS", f"{_ENTRIES}:ORDERS"), required=True, help="As 0.5:12:0.5, or 3,4.5,6."
    )
    reading: PulseOptions
    span: RecordSpan
    method: str = option(
        "--method", type=click.Choice(METHODS), default=METHODS[0], show_default=True, help="How orders are tracked."
    )
    cycles: int | None = option("--cycles", type=click.IntRange(2), help="Cycles of an average.  [default: 8]")
    step: float | None = option(
        "--speed-step", type=EntryOption("SPEED", f"{_ENTRIES}:STEP"), help="Slices of speed, each averaged, as 20rpm."
    )
    bandwidth: Any | None = option(
        "--bandwidth",
        type=EntryOption("BANDWIDTH", f"{_ENTRIES}:BANDWIDTH"),
        help="Of Vold-Kalman filters between -3 dB points: 1Hz, or 2% of the order's frequency.  [default: 1Hz]",
    )
    poles: int | None = option(
        "--filter-poles", type=click.IntRange(1, 4), help="Of Vold-Kalman filters.  [default: 2]"
    )
    cycle: int = option(
        "--cycle", type=click.IntRange(1), default=2, show_default=True, help="Turns until vibration repeats."
    )
    further: NamedWheel | None = option(
        "--further-shaft",
        type=TeethOption(),
        help="Wheel, angle or speed of a second shaft, whose orders cross; by Vold-Kalman filters.",
    )
    further_orders: tuple[float, ...] | None = option(
        "--further-orders", type=EntryOption("ORDERS", f"{_ENTRIES}:ORDERS"), help="Orders of the second shaft."
    )
    phase: str | None = option("--phase", metavar="CHANNEL", help="Pulses once per turn, from which phases count.")
    cam: str | None = option("--cam", metavar="CHANNEL", help="Pulses once per cycle; the next mark begins the cycle.")
    offset: float | None = option(
        "--tdc",
        type=EntryOption("ANGLE", f"{_ENTRIES}:TOP_DEAD_CENTRE"),
        help="From tooth 0 or the pulse to top dead centre, as 35deg, in the sense of rotation.",
    )
    cylinder: str = option("--cylinder", default="1", show_default=True, help="Cylinder of that top dead centre.")
    twists: tuple[str, ...] = option("--twist", metavar="A-B", help="Twist between two wheels. Repeatable.")
    stiffness: float | None = option(
        "--stiffness", type=EntryOption("STIFFNESS", f"{_ENTRIES}:STIFFNESS"), help="Makes a torque of the twist."
    )
    diameters: tuple[tuple[str, str], ...] = option(
        "--diameter",
        type=PairOption("CHANNEL", "DIAMETER", "T_shaft=120mm"),
        help="Makes a stress of a torque, 16 T/(pi d^3). Repeatable.",
    )
    drawn: str = option(
        "--picture", type=click.Choice(PICTURES), default=PICTURES[0], show_default=True, help="What --plot draws."
    )
    angle: str = ANGLE
    output_file: str | None = file_option("Write the complex orders: CSV.", (".csv",))

    def answer(self) -> Answer:
        from torsionnet.base.conventions import Conventions
        from torsionnet.io.tracked_order_tables import write_tracked_orders

        self._refuse_contradictions()
        tracked, shown = self.tracked(), Conventions(angle=self.angle)
        return Answer(
            screen=lambda: _shown(tracked, shown),
            data=lambda: tracked,
            csv=lambda: [(channel.name, channel.table(shown)) for channel in tracked],
            files=[(self.output_file, lambda file: write_tracked_orders(_of_first_shaft(tracked), file))],
            figures=lambda plot: [(channel.name, self._picture(plot, channel, shown)) for channel in tracked],
        )

    def tracked(self) -> tuple[TrackedOrders, ...]:
        """Complex orders of all channels and wheels asked for, in SI."""
        from torsionnet.app.cli.record_options import load_record
        from torsionnet.app.cli.terminal import progress
        from torsionnet.signals.orders.track_orders import orders_of_test
        from torsionnet.signals.orders.tracked_orders import order_slices

        self.span.check(self.record)
        shafts = [shaft for shaft in (self.reference, self.further) if shaft]
        wheels = self.reading.wheels(shafts, (name for name in (self.phase, self.cam) if name))
        method = self._method()
        with progress("rotation", None) as advance:
            rotations, mark, once = self._pulses(wheels)
            # Orders are those of the reference shaft; further shafts have orders of their own.
            mean, *more = [self._mean(name, rotations, once, advance) for name, _ in shafts]
        signals = self._signals(wheels)
        twists = [self._twist(text, list(rotations)) for text in self.twists]
        with progress("tracking", None) as advance:
            record = load_record(self.record, self.reading, signals, 0.0, advance, self.span) if signals else None
            tracked = orders_of_test(
                record,
                rotations,
                mean,
                orders=self.orders,
                channels=signals,
                wheels=[name for name in rotations if name in self.channels or not self.channels],
                twists=twists,
                mark=mark,
                method=method,
                further=[(shaft, self.further_orders or ()) for shaft in more],
            )
        title = Path(self.record).name
        tracked = tuple(replace(channel, title=title) for channel in (*tracked, *self._stresses(tracked)))
        if self.step and self.method == METHODS[1]:
            return tuple(order_slices(channel, self.step) for channel in tracked)
        return tracked

    def _refuse_contradictions(self) -> None:
        if self.method == METHODS[0] and (self.bandwidth or self.poles):
            raise WrongUsage("--bandwidth and --filter-poles belong to --method vold-kalman", kind="needless-entry")
        if self.method == METHODS[1] and self.cycles:
            raise WrongUsage("--cycles belongs to --method average", kind="needless-entry")
        if self.cycles and self.step:
            raise WrongUsage(
                "--cycles and --speed-step both say over what is averaged: leave one out", kind="contradicting-entries"
            )
        if (self.further is None) != (self.further_orders is None):
            raise WrongUsage("--further-shaft and --further-orders go together", kind="missing-entry")
        if self.further and self.method == METHODS[0]:
            raise WrongUsage("orders of a second shaft need --method vold-kalman", kind="contradicting-entries")
        if self.stiffness and not self.twists:
            raise WrongUsage("--stiffness belongs to --twist", kind="needless-entry")

    def _method(self) -> CycleAverage | VoldKalman:
        from torsionnet.signals.orders.cycle_average import CycleAverage
        from torsionnet.signals.orders.vold_kalman import VoldKalman

        if self.method == METHODS[1]:
            return replace(self.bandwidth or VoldKalman(), poles=self.poles or 2)
        return CycleAverage(cycles=self.cycles or 8, step=self.step or 0.0)

    def _pulses(
        self, wheels: dict[str, WheelOfTest]
    ) -> tuple[dict[str, WheelRotation], PhaseMark, dict[str, PulseChannel]]:
        """Rotations of the wheels, the mark of the phases, and channels of one pulse per turn, all from the record."""
        from torsionnet.io.wheel_files import channels_of, patterns_of, read_turning_record
        from torsionnet.signals.orders.track_orders import PhaseMark
        from torsionnet.signals.rotation.rotations_of_wheels import rotations_of_wheels
        from torsionnet.signals.rotation.wheel_channel import wheel_pulses

        channels = channels_of(wheels)
        once = {name for name, wheel in channels.items() if wheel.teeth == 1}
        index = self.phase or (self.reference.name if self.reference.name in once else None)
        toothed = {name: wheel for name, wheel in channels.items() if name not in {*once, index, self.cam}}
        indices = [wheel.index for wheel in toothed.values()]
        marks = self.reading.marks(dict.fromkeys([*once, index, self.cam, *indices]), wheels)
        place = "" if self.offset is None else f"top dead centre of cylinder {self.cylinder}"
        if not toothed and not marks:
            return {}, PhaseMark(offset=self.offset or 0.0, place=place), {}
        record = self.span.cut(read_turning_record(self.record, toothed, marks, **self.reading.arguments))
        rotations = rotations_of_wheels(record, toothed, patterns_of(wheels), marks=marks, index=index or "")
        pulses = {name: wheel_pulses(record, name, wheel) for name, wheel in marks.items()}
        # A wheel without a gap has no mark of its own, though an index or a pattern may number its teeth.
        of_wheel = not self.cam or (self.reference.name in toothed and toothed[self.reference.name].shows_tooth_0)
        mark = PhaseMark(pulses.get(index or ""), pulses.get(self.cam or ""), self.offset or 0.0, place, of_wheel)
        return rotations, mark, {name: pulses[name] for name in once}

    def _mean(
        self,
        name: str,
        rotations: dict[str, WheelRotation],
        once: dict[str, PulseChannel],
        advance: Callable[[float], None],
    ) -> MeanRotation:
        from torsionnet.app.cli.record_options import load_record
        from torsionnet.signals.orders.mean_rotation import mean_rotation
        from torsionnet.signals.records.recording_files import channel_names

        pulses = rotations.get(name) or once.get(name)
        if pulses is not None:
            return mean_rotation(pulses, cycle=self.cycle)
        if rotations and name not in (there := channel_names(self.record)):
            hint = did_you_mean(name, [*rotations, *there])
            wheels, channels = ", ".join(rotations), ", ".join(there)
            raise UsageError(
                f"no wheel or channel is named {name}{hint}; wheels: {wheels}; channels: {channels}",
                kind="unknown-channel",
            )
        return mean_rotation(
            load_record(self.record, self.reading, [name], 0.0, advance, self.span), name, cycle=self.cycle
        )  # fmt: skip

    def _signals(self, wheels: dict[str, WheelOfTest]) -> list[str]:
        from torsionnet.signals.records.recording_files import channel_names

        if self.channels:
            return [name for name in self.channels if name not in wheels]
        pulses = {*wheels, self.phase, self.cam, self.reference.name, self.further.name if self.further else ""}
        pulses |= {name for wheel in wheels.values() for name in (wheel.channel.index, wheel.channel.second)}
        return [name for name in channel_names(self.record) if name not in pulses]

    def _twist(self, text: str, known: list[str]) -> Twist:
        from torsionnet.signals.orders.tracked_signals import Twist

        for first in known:
            if text.startswith(f"{first}-") and text[len(first) + 1 :] in known:
                return Twist(first, text[len(first) + 1 :], self.stiffness or 0.0)
        raise UsageError(
            f"--twist {text}: two wheels with - between them are needed, of {', '.join(known) or 'none'}; name wheels "
            "with --reference-shaft and --pulses, or in the file of --wheels",
            kind="missing-entry",
        )

    def _stresses(self, tracked: tuple[TrackedOrders, ...]) -> Iterator[TrackedOrders]:
        from torsionnet.base.entries.spec import EntryError
        from torsionnet.signals.orders.tracked_orders import stress_orders
        from torsionnet.signals.orders.tracking_entries import DIAMETER

        for name, text in self.diameters:
            try:
                diameter = DIAMETER.coerce(text)
            except EntryError as error:
                raise UsageError(f"--diameter {name}: {error}", kind=error.fault.kind) from None
            torques = [channel for channel in tracked if name in (channel.name, channel.name[len("torque(") : -1])]
            if not torques:
                raise UsageError(
                    f"--diameter {name}: there is {', '.join(channel.name for channel in tracked)}", kind="unknown-name"
                )
            yield stress_orders(torques[0], diameter)

    def _picture(self, plot: ModuleType, tracked: TrackedOrders, shown: Conventions) -> Figure:
        figure: Figure = (
            plot.waterfall(tracked, conventions=shown)
            if self.drawn == "waterfall"
            else plot.tracked_orders(tracked, conventions=shown)
        )
        return figure


def _of_first_shaft(tracked: tuple[TrackedOrders, ...]) -> list[TrackedOrders]:
    """Orders that share the orders and the reference of the first, so that one file holds them."""
    first = tracked[0]
    return [
        channel
        for channel in tracked
        if channel.orders.tolist() == first.orders.tolist() and channel.reference == first.reference
    ]


def _shown(tracked: tuple[TrackedOrders, ...], shown: Conventions) -> Iterator[Table | str]:
    for number, channel in enumerate(tracked):
        yield from [""] if number else []
        yield channel.table(shown)
