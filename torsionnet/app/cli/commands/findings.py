"""Commands that find something in a record without a model: ``damping``, ``loops`` and ``spectrogram``."""

from __future__ import annotations

from copy import copy
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from torsionnet.app.cli.command import TABLE, Answer, separated_by_lines
from torsionnet.app.cli.options import (
    ANGLE,
    EntryOption,
    FiniteFloat,
    OutputFile,
    WrongUsage,
    band_option,
    file_option,
    option,
)
from torsionnet.app.cli.pulse_options import NamedWheel, PulseOptions
from torsionnet.app.cli.record_options import Averaging, RecordCommand, RecordSpan
from torsionnet.app.cli.terminal import print_warnings

if TYPE_CHECKING:
    from torsionnet.base.table import Table
    from torsionnet.io.wheel_files import WheelOfTest
    from torsionnet.modal.matching import Match
    from torsionnet.modal.operational.ambient_modes import OperationalModes
    from torsionnet.signals.recording import FloatArray, Recording
    from torsionnet.signals.spectra import Spectrogram
    from torsionnet.signals.torque_loops.loop_result import TorqueLoops


# Command ``torsionnet damping``, which finds natural frequencies and damping ratios without a measured input.

KINDS = ("run-up", "decay", "ambient")
POSITIVE = FiniteFloat(0, min_open=True)
ONLY_FOR = {
    "speed_channel": ("run-up", "ambient"), "angle_channel": ("run-up",), "orders": ("run-up", "ambient"),
    "band": ("run-up",), "excitation_law": ("run-up",), "revolutions": ("run-up",), "bandwidth": ("run-up",),
    "mode_count": ("run-up", "decay"), "start": ("decay",), "stop": ("decay",), "up_to": ("decay", "ambient"),
}  # fmt: skip
"""Kinds of records for which each option counts, by the name of its value."""


class DampingCommand(RecordCommand):
    """Natural frequencies and damping ratios from a run-up, a free decay or ambient vibration, with 95 % intervals.

    Of a run-up the swept response is fitted, not the steady one, to the channel itself or to an order that was tracked
    (a file of the command track).

    \b
    torsionnet damping runup.npz --kind run-up --channel T --orders 6 --speed-channel n
    torsionnet damping runup.npz --kind run-up --channel T --orders 6 --angle-channel fly --pulses fly=60-2
    torsionnet damping drop.npz --kind decay --channel T
    torsionnet damping night.npz --kind ambient --channel T --up-to 60
    """

    forms = TABLE
    picture = "measured order and swept fit, decay with envelope, or stabilisation diagram"

    reading: PulseOptions
    kind: str = option("--kind", type=click.Choice(KINDS), required=True, help="What the record holds.")
    channels: tuple[str, ...] = option("--channel", metavar="CHANNEL", required=True, help="Ambient: repeatable.")
    orders: tuple[float, ...] | None = option(
        "--orders",
        type=EntryOption("ORDERS", "signals.orders.tracking_entries:ORDERS_AS_GIVEN"),
        help="Run-up: the order that passes the resonance, and further ones that are fitted with it, as 6,5.5,6.5. "
        "Ambient: orders of the running machine.",
    )
    speed_channel: str | None = option(
        "--speed-channel",
        metavar="CHANNEL",
        help="Channel of the speed of the reference shaft, or a wheel of --pulses.",
    )
    angle_channel: str | None = option(
        "--angle-channel", metavar="CHANNEL", help="Instead: channel of its angle, or such a wheel."
    )
    band: tuple[float, float] | None = band_option(
        "Run-up: frequencies of the order in Hz.  [default: about its peak]", POSITIVE
    )
    mode_count: int | None = option("--mode-count", type=click.IntRange(1), help="How many modes are fitted.")
    excitation_law: str | None = option(
        "--excitation-law",
        type=click.Choice(["constant", "inertia"]),
        help="Run-up: amplitude of the excitation, constant or as the square of the speed.  [default: constant]",
    )
    revolutions: float | None = option(
        "--revolutions", type=POSITIVE, help="Run-up: length of the windows of angle.  [default: 4, or less]"
    )
    bandwidth: float | None = option(
        "--bandwidth", type=POSITIVE, help="Run-up, tracked order: bandwidth in Hz with which it was tracked."
    )
    start: float | None = option("--start", type=FiniteFloat(), help="Decay: s.  [default: found]")
    stop: float | None = option("--stop", type=FiniteFloat(), help="Decay: s.  [default: found]")
    up_to: float | None = option("--up-to", type=POSITIVE, help="Decay, ambient: highest frequency in Hz.")
    model: str | None = option("--model", metavar="MODEL", help="Compare with the modes of this model.")
    configuration: str = option("--configuration", "-c", metavar="NAME", default="", help="Of that model.")

    def answer(self) -> Answer:
        self._refuse_idle_options()
        modes = self._identified()
        compared = _compared(modes, self.model, self.configuration) if self.model else None
        print_warnings(modes.notes)
        return Answer(
            screen=lambda: separated_by_lines([modes.table(), *([compared.table()] if compared else [])]),
            data=lambda: replace(modes, against_model=compared),
            csv=lambda: [("", modes.table())],
            figures=lambda plot: [("", plot.operational_modes(modes))],
        )

    def _refuse_idle_options(self) -> None:
        """Refuse options that say nothing on the kind of record, and channels or orders that are missing."""
        faults = [
            f"--{name.replace('_', '-')} is for --kind {' or '.join(sources)}"
            for name, sources in ONLY_FOR.items()
            if getattr(self, name) not in {None, ()} and self.kind not in sources
        ]
        if self.kind != "ambient" and len(self.channels) > 1:
            faults.append(f"--kind {self.kind} reads one --channel")
        if self.kind == "run-up" and not self.orders:
            faults.append("the frequency of the excitation is not known: give --orders, vibrations per revolution")
        if self.kind == "ambient" and self.up_to is None:
            faults.append("give the highest frequency of interest, --up-to, in Hz")
        if faults:
            raise WrongUsage("; ".join(faults), kind="missing-entry")

    def _identified(self) -> OperationalModes:
        from torsionnet.modal import modes_from_ambient, modes_from_decay, modes_from_run_up

        if self.kind == "run-up" and _is_tracked(self.record):
            return self._tracked()
        record = self._recording()
        if self.kind == "decay":
            return modes_from_decay(
                record, self.channels[0], start=self.start, stop=self.stop, mode_count=self.mode_count, up_to=self.up_to
            )
        if self.kind == "ambient":
            # Over this range of speeds an order of the shaft is a peak, and no mode.
            turning = None if self.speed_channel is None else _quantity(record, self.speed_channel, "velocity")
            speeds = None if turning is None else (float(turning.min()), float(turning.max()))
            return modes_from_ambient(
                record, self.channels, up_to=self.up_to or 0.0, orders=self.orders or (), speeds=speeds
            )
        if (self.speed_channel is None) == (self.angle_channel is None):
            text = "the frequency of an order needs the speed of the shaft: give --speed-channel or --angle-channel"
            raise WrongUsage(text, kind="missing-entry")
        return modes_from_run_up(
            record,
            self.channels[0],
            self.orders or (),
            str(self.speed_channel or self.angle_channel),
            band=self.band,
            mode_count=self.mode_count or 1,
            excitation_law=self._law(),
            revolutions=self.revolutions,
        )

    def _tracked(self) -> OperationalModes:
        from torsionnet.base.errors import UsageError, did_you_mean
        from torsionnet.io.tracked_order_tables import read_tracked_orders
        from torsionnet.modal.operational.run_up_modes import modes_from_tracked_orders

        orders = self.orders or ()
        if len(orders) > 1:
            raise WrongUsage("a tracked order is read alone: give one of --orders", kind="wrong-count")
        tracked = {order.name: order for order in read_tracked_orders(self.record)}
        name = self.channels[0]
        if name not in tracked:
            text = f'no tracked channel is named "{name}"{did_you_mean(name, tracked)}'
            raise UsageError(f"{text}; there is {', '.join(tracked)}", kind="unknown-channel")
        return modes_from_tracked_orders(
            tracked[name],
            orders[0],
            band=self.band,
            mode_count=self.mode_count or 1,
            excitation_law=self._law(),
            revolutions=self.revolutions,
            bandwidth=self.bandwidth,
        )

    def _law(self) -> Any:
        return self.excitation_law or "constant"

    def _recording(self) -> Recording:
        from torsionnet.app.cli.record_options import load_record
        from torsionnet.app.cli.terminal import progress
        from torsionnet.signals.recording import Recording

        names = [*self.channels, *(channel for channel in (self.speed_channel, self.angle_channel) if channel)]
        wheels = self.reading.wheels([NamedWheel(name) for name in names])
        unused = [name for name in wheels if name not in names]
        if unused and not self.reading.wheels_file:
            text = f"--pulses {unused[0]}: no --angle-channel, --speed-channel or --channel names this wheel"
            raise WrongUsage(text, kind="unknown-channel")
        if used := {name: wheel for name, wheel in wheels.items() if name in names}:
            return self._turning(used, [name for name in names if name not in used])
        with progress("reading", None) as advance:
            record = load_record(self.record, self.reading, names, 0.0, advance)
            return record if isinstance(record, Recording) else _joined(list(record))

    def _turning(self, wheels: dict[str, WheelOfTest], kept: list[str]) -> Recording:
        """Recording of the channels kept, with the angle (rad) of each wheel, or its speed (rad/s), by its name."""
        from torsionnet.app.cli.record_options import checked_record
        from torsionnet.io.wheel_files import channels_of, patterns_of, read_turning_record
        from torsionnet.signals.rotation.rotations_of_wheels import angle_record, rotations_of_wheels

        channels = channels_of(wheels)
        marks = self.reading.marks({wheel.index for wheel in channels.values()}, wheels)
        record = read_turning_record(self.record, channels, marks, kept, **self.reading.arguments)
        rotations = rotations_of_wheels(record, channels, patterns_of(wheels), marks=marks)
        made = angle_record(record, tuple(rotations.values()), keep=kept, sampling_rate=self.reading.rate)
        named = {f"{name} {'speed' if name == self.speed_channel else 'angle'}": name for name in wheels}
        signals = [*(made[name] for name in kept), *(replace(made[wheel], name=name) for wheel, name in named.items())]
        return checked_record(replace(made, signals=tuple(signals), pulses=()), self.reading, self.record)


def _joined(blocks: list[Recording]) -> Recording:
    """Recording joined from the blocks of a large file; of few channels it can be kept in memory."""
    import numpy as np

    signals = tuple(
        replace(signal, values=np.concatenate([block[signal.name].values for block in blocks])) for signal in blocks[0]
    )
    return replace(blocks[0], signals=signals)


def _is_tracked(path: str) -> bool:
    """Whether a file is a table of tracked orders, by the first line that is no comment."""
    if not path.lower().endswith(".csv"):
        return False
    try:
        with Path(path).open(encoding="utf-8", errors="replace") as file:
            heading = next((line for line in file if line.strip() and not line.startswith("#")), "")
    except OSError:
        return False
    return "order" in [cell.strip().strip('"') for cell in heading.split(",")]


def _quantity(record: Recording, name: str, quantity: str) -> FloatArray:
    from torsionnet.base.errors import UsageError

    signal = record[name]
    if signal.quantity != quantity:
        unit = "rpm" if quantity == "velocity" else "rad"
        raise UsageError(
            f"{name} is no {quantity} but {signal.quantity or 'unknown'}: say --quantity {name}={quantity} and, if its "
            f"unit is not in the file, --unit {name}={unit}",
            kind="wrong-unit",
        )
    return signal.values


def _compared(modes: OperationalModes, model: str, configuration: str) -> Match:
    from torsionnet.drivetrain import load
    from torsionnet.modal import match

    rig = load(model)
    rig = rig.configured(configuration) if configuration else rig
    return match(modes, rig.modes())


# Command ``torsionnet loops``, which reads stages, friction, free play and loss from loops of torque over twist.

ENDINGS = (".yaml", ".yml")
_ENTRIES = "signals.torque_loops.loop_remarks"


class LoopsCommand(RecordCommand):
    """Stages, friction, free play, stiffness and loss from loops of torque over twist of a component bench.

    The twist is a channel, or two angles, --twist of the driving and --twist of the driven side. Cycles are cut at its
    reversals; the first of those that repeat is left out, and 95 % intervals are those over the others. The loss factor
    eta_s belongs to the secant stiffness k_s, eta_1 to the first harmonic k' + j k''.

    \b
    torsionnet loops bench.csv --torque T --twist gamma --plot loops.png --write-model flywheel.yaml
    torsionnet loops bench.csv --torque T --twist phi_1 --twist phi_2 --delay T=1.2ms --inertia 0.045kg*m^2
    """

    forms = TABLE
    picture = "the loops with their branches and stages"

    torque: str = option("--torque", metavar="CHANNEL", required=True, help="Channel of the torque.")
    twist: tuple[str, ...] = option(
        "--twist", metavar="CHANNEL", required=True, help="Channel of the twist; or twice, driving and driven angle."
    )
    speed_channel: str | None = option("--speed-channel", metavar="CHANNEL", help="Its mean is the speed of a loop.")
    span: RecordSpan
    inertia: float | None = option(
        "--inertia",
        type=EntryOption("INERTIA", f"{_ENTRIES}:INERTIA"),
        help="Moves between torque meter and component; its torque is taken out where the twist is a sine.",
    )
    drift: bool = option("--drift", help="Take the drift of the torque from cycle to cycle out of each cycle.")
    encoder_step: float | None = option(
        "--encoder-step",
        type=EntryOption("ANGLE", f"{_ENTRIES}:STEP"),
        help="Step of the twist, a part of the intervals.  [default: that which the record shows]",
    )
    angle: str = ANGLE
    output_file: str | None = file_option("Write the result, for report --loops; ends in .json.", (".json",))
    model_file: str | None = option(
        "--write-model", type=OutputFile(ENDINGS), help="Write the component as a model file, with intervals."
    )

    def answer(self) -> Answer:
        from torsionnet.app.cli.terminal import print_warnings
        from torsionnet.base.conventions import Conventions
        from torsionnet.io.loop_element import write_loop_element

        loops, shown = self.loops(), Conventions(angle=self.angle)
        print_warnings(loops.notes)
        return Answer(
            screen=lambda: [loops.table(shown)],
            data=lambda: loops,
            csv=lambda: [("", loops.table(shown))],
            files=[
                (self.output_file, loops.to_json),
                (self.model_file, lambda file: write_loop_element(loops, file)),
            ],
            figures=lambda _: [("", loops.figure(conventions=shown))],
        )

    def loops(self) -> TorqueLoops:
        """Loops of the record, without the delays given."""
        from torsionnet.app.cli.record_options import load_record
        from torsionnet.app.cli.terminal import progress
        from torsionnet.signals.recording import Recording
        from torsionnet.signals.torque_loops.loops import loops

        if len(self.twist) > 2:
            raise click.UsageError("a twist is one channel, or two angles: give --twist once or twice")
        self.span.check(self.record)
        # The lateness of the torque is for the loops to take out, and to know of.
        span, late = copy(self.span), dict(self.span.delays).get(self.torque, 0.0)
        span.delays = tuple((channel, delay) for channel, delay in span.delays if channel != self.torque)
        names = [self.torque, *self.twist, *([self.speed_channel] if self.speed_channel else [])]
        with progress("loops", None) as advance:
            record = load_record(self.record, self.reading, names, 0.0, advance, span)
            if not isinstance(record, Recording):
                raise click.UsageError("a record of loops is read as a whole: cut it by --start and --stop")
            result = loops(
                record,
                self.torque,
                self.twist[0] if len(self.twist) == 1 else (self.twist[0], self.twist[1]),
                speed_channel=self.speed_channel,
                delay=late,
                inertia=self.inertia or 0.0,
                drift=self.drift,
                encoder_step=self.encoder_step,
            )
        return replace(result, title=Path(self.record).name)


# Command ``torsionnet spectrogram``, which shows the level of a recorded channel over time and frequency.


class SpectrogramCommand(RecordCommand):
    """Level over time and frequency; on the screen the strongest line along the record.

    \b
    torsionnet spectrogram test.npz --channel T_T --decimate 50 --plot torque.png
    """

    forms = TABLE
    picture = "the level over time and frequency"

    channels: tuple[str, ...] = option("--channel", metavar="CHANNEL", help="Repeatable; default: all of the record.")
    averaging: Averaging
    up_to: float | None = option(
        "--up-to", type=FiniteFloat(0, min_open=True), help="Highest frequency in Hz; default: where the power ends."
    )
    span: float = option(
        "--span", type=FiniteFloat(0, min_open=True), default=60.0, show_default=True, help="dB shown."
    )
    angle: str = ANGLE

    def answer(self) -> Answer:
        from torsionnet.base.conventions import Conventions

        seen, shown = self.spectrograms(), Conventions(angle=self.angle)
        return Answer(
            screen=lambda: map(_strongest_lines, seen),
            data=lambda: seen,
            csv=lambda: [(channel.name, _strongest_lines(channel, every=True)) for channel in seen],
            figures=lambda plot: [
                (channel.name, plot.spectrogram(channel, up_to=self.up_to, span=self.span, conventions=shown))
                for channel in seen
            ],
        )

    def spectrograms(self) -> list[Spectrogram]:
        """Spectrograms of the recorded channels asked for."""
        from torsionnet.app.cli.record_options import load_record
        from torsionnet.app.cli.terminal import progress
        from torsionnet.signals.recording import Recording
        from torsionnet.signals.resampling import decimated
        from torsionnet.signals.spectra import spectrogram

        settings = self.averaging.settings()
        with progress("transforming", None) as advance:
            channels = self.channels or None
            record = self.averaging.suited(load_record(self.record, self.reading, channels, settings.seconds, advance))
            if not isinstance(record, Recording):  # only what is left after decimation is kept in memory
                record = _joined(list(decimated(record, settings.decimation)))
                settings = replace(settings, decimation=1)
            return [spectrogram(record, name, settings) for name in self.channels or record.names]


def _strongest_lines(seen: Spectrogram, *, every: bool = False) -> Table:
    """Table of the strongest line of a spectrogram over time: at every time, or at about twenty for the screen."""
    from torsionnet.base.table import Column, Table

    columns = (
        Column("time", "s", 5),
        Column("strongest line", "Hz", 5),
        Column("amplitude", seen.unit, 4),
    )
    step = 1 if every else max(1, len(seen.times) // 20)
    strongest = seen.amplitude.max(axis=0)
    rows = tuple(zip(*(values[::step].tolist() for values in (seen.times, seen.ridge, strongest)), strict=True))
    return Table(seen.name, columns, rows, tuple(map(str, seen.notes)))
