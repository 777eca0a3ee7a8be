"""Command ``torsionnet track``, which finds the complex orders of the signals of a turning machine."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from torsionnet.cli.command import TABLE, Answer, click_command
from torsionnet.cli.declarations import option
from torsionnet.cli.options import ANGLE, EntryOption, PairOption, file_option
from torsionnet.cli.record_options import RecordCommand
from torsionnet.cli.wheel_options import NamedWheel, TeethOption, WheelReading
from torsionnet.core.errors import UsageError

if TYPE_CHECKING:
    from types import ModuleType

    from matplotlib.figure import Figure

    from torsionnet.response import Conventions, Table
    from torsionnet.response.measured.tracked_orders import TrackedOrders
    from torsionnet.response.recording import Recording
    from torsionnet.signals.orders.cycle_average import CycleAverage
    from torsionnet.signals.orders.mean_rotation import MeanRotation
    from torsionnet.signals.orders.phase_reference import PhaseReference
    from torsionnet.signals.orders.vold_kalman import VoldKalman
    from torsionnet.signals.rotation.wheel_rotation import WheelRotation

METHODS = ("average", "vold-kalman")
PICTURES = ("slices", "waterfall")
_ENTRIES = "signals.orders.tracking_entries"


class TrackCommand(RecordCommand):
    """Complex orders of signals and of wheels over speed: amplitude, phase from top dead centre, 95 % interval.

    The reference shaft is that of a wheel (--reference fly=60), or a channel of its angle or speed. Orders are over its
    mean angle of rotation. With -o the orders are written for `torsionnet orders --measured` and fits.

    \b
    torsionnet track up.npz --reference fly=60-2 --tdc 35deg --cam cam --channel T_shaft --orders 0.5:12:0.5 -o up.csv
    torsionnet track up.npz --reference fly=60 --wheel gen=60 --twist fly-gen --stiffness "2 MN*m/rad" --orders 3,6
    """

    forms = TABLE
    picture = "the orders over speed"

    reference: NamedWheel = option(
        "--reference",
        type=TeethOption(bare=True),
        required=True,
        help="Wheel of the reference shaft and its teeth, fly=60, or fly=60-2 with a gap; or its angle or speed.",
    )
    channels: tuple[str, ...] = option(
        "--channel", metavar="CHANNEL", help="Signal or wheel. Repeatable; default: all signals and wheels."
    )
    orders: tuple[float, ...] = option(
        "--orders", type=EntryOption("ORDERS", f"{_ENTRIES}:ORDERS"), required=True, help="As 0.5:12:0.5, or 3,4.5,6."
    )
    wheel_reading: WheelReading
    method: str = option("--method", type=click.Choice(METHODS), default=METHODS[0], show_default=True)
    cycles: int | None = option("--cycles", type=click.IntRange(2), help="Cycles of an average.  [default: 8]")
    step: float | None = option(
        "--steps", type=EntryOption("SPEED", f"{_ENTRIES}:STEP"), help="Slices of speed, each averaged, as 20rpm."
    )
    bandwidth: Any | None = option(
        "--bandwidth",
        type=EntryOption("BANDWIDTH", f"{_ENTRIES}:BANDWIDTH"),
        help="Of Vold-Kalman filters between -3 dB points: 1Hz, or 2% of the order's frequency.  [default: 1Hz]",
    )
    poles: int | None = option("--poles", type=click.IntRange(1, 4), help="Of Vold-Kalman filters.  [default: 2]")
    cycle: int = option(
        "--cycle", type=click.IntRange(1), default=2, show_default=True, help="Turns until vibration repeats."
    )
    further: NamedWheel | None = option(
        "--further-shaft",
        type=TeethOption(bare=True),
        help="Wheel, angle or speed of a second shaft, whose orders cross; by Vold-Kalman filters.",
    )
    further_orders: tuple[float, ...] | None = option(
        "--further-orders", type=EntryOption("ORDERS", f"{_ENTRIES}:ORDERS"), help="Orders of the second shaft."
    )
    index: str | None = option("--phase", metavar="CHANNEL", help="Pulses once per turn, from which phases count.")
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
        from torsionnet.io.tracked_order_tables import write_tracked_orders
        from torsionnet.response import Conventions

        self._refuse_contradictions()
        found, shown = self.tracked(), Conventions(angle=self.angle)
        return Answer(
            screen=lambda: _shown(found, shown),
            data=lambda: [one.record() for one in found],
            csv=lambda: [(one.name, one.table(shown)) for one in found],
            files=[(self.output_file, lambda file: write_tracked_orders(_of_first_shaft(found), file))],
            figures=lambda plot: [(one.name, self._picture(plot, one, shown)) for one in found],
        )

    def tracked(self) -> tuple[TrackedOrders, ...]:
        """Complex orders of all channels and wheels asked for, in SI."""
        from torsionnet.cli.progress import progress
        from torsionnet.cli.records import load_record
        from torsionnet.signals.orders.derived_orders import order_slices
        from torsionnet.signals.orders.track_orders import track_orders
        from torsionnet.signals.orders.tracked_signals import Twist

        rotations = self._rotations()
        first = rotations.get(self.reference.name)
        with progress("rotation", None) as advance:
            mean = self._mean(self.reference, rotations, advance)
            more = None if self.further is None else self._mean(self.further, rotations, advance)
        signals = self._signals(list(rotations))
        method = self._method()
        pairs = [self._pair(text, list(rotations)) for text in self.twists]
        twists = [Twist(*pair) for pair in pairs if not self.stiffness]
        twists += [Twist(*pair, self.stiffness) for pair in pairs if self.stiffness]
        with progress("tracking", None) as advance:
            record = load_record(self.record, self.reading, signals, 0.0, advance) if signals else None
            found = track_orders(
                record, mean, signals, [one for one in rotations.values() if self._wanted(one.name)],
                [(twist, rotations[twist.first], rotations[twist.second]) for twist in twists],
                orders=self.orders, method=method, reference=self._phase(mean, first),
                further=[] if more is None else [(more, self.further_orders or ())],
            )  # fmt: skip
        title = Path(self.record).name
        found = tuple(replace(one, title=title) for one in (*found, *self._stresses(found)))
        if self.step and self.method == METHODS[1]:
            return tuple(order_slices(one, self.step) for one in found)
        return found

    def _refuse_contradictions(self) -> None:
        if self.method == METHODS[0] and (self.bandwidth or self.poles):
            raise click.UsageError("--bandwidth and --poles belong to --method vold-kalman")
        if self.method == METHODS[1] and self.cycles:
            raise click.UsageError("--cycles belongs to --method average")
        if self.cycles and self.step:
            raise click.UsageError("--cycles and --steps both say over what is averaged: leave one out")
        if (self.further is None) != (self.further_orders is None):
            raise click.UsageError("--further-shaft and --further-orders go together")
        if self.further and self.method == METHODS[0]:
            raise click.UsageError("orders of a second shaft need --method vold-kalman")
        if self.stiffness and not self.twists:
            raise click.UsageError("--stiffness belongs to --twist")

    def _method(self) -> CycleAverage | VoldKalman:
        from torsionnet.signals.orders.cycle_average import CycleAverage
        from torsionnet.signals.orders.vold_kalman import VoldKalman

        if self.method == METHODS[1]:
            return replace(self.bandwidth or VoldKalman(), poles=self.poles or 2)
        return CycleAverage(cycles=self.cycles or 8, step=self.step or 0.0)

    def _rotations(self) -> dict[str, WheelRotation]:
        """Rotation of each wheel by name."""
        wheels = [one for one in (self.reference, self.further, *self.wheel_reading.wheels) if one and one.teeth > 1]
        self.wheel_reading.check_wheels([one.name for one in wheels])
        names = [one.name for one in wheels] + ([self.index] if self.index and wheels else [])
        if not wheels:
            return {}
        record = self.wheel_reading.record_of(self.record, names)
        return {one.name: self.wheel_reading.rotation(record, one, self.index) for one in wheels}

    def _mean(self, one: NamedWheel, rotations: dict[str, WheelRotation], advance: object) -> MeanRotation:
        from torsionnet.cli.records import load_record
        from torsionnet.signals.orders.mean_rotation import mean_rotation

        if one.teeth > 1:
            return mean_rotation(rotations[one.name], cycle=self.cycle)
        if one.teeth == 1:
            pulses = self.wheel_reading.record_of(self.record, [one.name])
            return mean_rotation(pulses.pulses_of(one.name), cycle=self.cycle)
        record = load_record(self.record, self.reading, [one.name], 0.0, advance)  # type: ignore[arg-type]
        return mean_rotation(record, one.name, cycle=self.cycle)

    def _phase(self, mean: MeanRotation, wheel: WheelRotation | None) -> PhaseReference:
        from torsionnet.signals.orders.phase_reference import phase_reference

        index, cam = self.index, self.cam
        if index is None and self.reference.teeth == 1:
            index = self.reference.name
        names = [name for name in (index, cam) if name]
        record = self.wheel_reading.record_of(self.record, names) if names else None
        return phase_reference(
            mean,
            wheel,
            index=_pulses(record, index),
            cam=_pulses(record, cam),
            offset=self.offset or 0.0,
            place="" if self.offset is None else f"top dead centre of cylinder {self.cylinder}",
        )

    def _signals(self, wheels: list[str]) -> list[str]:
        from torsionnet.io.recording_files import channel_names

        if self.channels:
            return [name for name in self.channels if name not in wheels]
        pulses = {*wheels, self.index, self.cam, self.reference.name, self.further.name if self.further else ""}
        return [name for name in channel_names(self.record) if name not in pulses]

    def _wanted(self, name: str) -> bool:
        return name in self.channels or not self.channels

    def _pair(self, text: str, known: list[str]) -> tuple[str, str]:
        for first in known:
            if text.startswith(f"{first}-") and text[len(first) + 1 :] in known:
                return first, text[len(first) + 1 :]
        raise UsageError(
            f"--twist {text}: two wheels with - between them are needed, of {', '.join(known) or 'none'}; name wheels "
            "with --reference and --wheel"
        )

    def _stresses(self, found: tuple[TrackedOrders, ...]) -> Iterator[TrackedOrders]:
        from torsionnet.core.entries.spec import EntryError
        from torsionnet.signals.orders.derived_orders import stress_orders
        from torsionnet.signals.orders.tracking_entries import DIAMETER

        for name, text in self.diameters:
            try:
                diameter = DIAMETER.coerce(text)
            except EntryError as error:
                raise UsageError(f"--diameter {name}: {error}") from None
            torques = [one for one in found if name in (one.name, one.name[len("torque(") : -1])]
            if not torques:
                raise UsageError(f"--diameter {name}: there is {', '.join(one.name for one in found)}")
            yield stress_orders(torques[0], diameter)

    def _picture(self, plot: ModuleType, one: TrackedOrders, shown: Conventions) -> Figure:
        figure: Figure = (
            plot.waterfall(one, conventions=shown)
            if self.drawn == "waterfall"
            else plot.tracked_orders(one, conventions=shown)
        )
        return figure


def _of_first_shaft(found: tuple[TrackedOrders, ...]) -> list[TrackedOrders]:
    """Orders that share the orders and the reference of the first, so that one file holds them."""
    first = found[0]
    return [one for one in found if one.orders.tolist() == first.orders.tolist() and one.reference == first.reference]


def _pulses(record: Recording | None, name: str | None):  # type: ignore[no-untyped-def]  # noqa: ANN202
    return None if record is None or name is None else record.pulses_of(name)


def _shown(found: tuple[TrackedOrders, ...], shown: Conventions) -> Iterator[Table | str]:
    for number, one in enumerate(found):
        yield from [""] if number else []
        yield one.table(shown)


command = click_command("track", TrackCommand)
