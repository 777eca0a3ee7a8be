"""Command ``torsionnet damping``, which finds natural frequencies and damping ratios without a measured input."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from torsionnet.app.cli.command import TABLE, Answer, separated_by_lines
from torsionnet.app.cli.options import EntryOption, FiniteFloat, WrongUsage, band_option, option
from torsionnet.app.cli.pulse_options import NamedWheel, PulseOptions
from torsionnet.app.cli.record_options import RecordCommand
from torsionnet.app.cli.terminal import print_warnings

if TYPE_CHECKING:
    from torsionnet.io.wheel_files import WheelOfTest
    from torsionnet.modal.matching import Match
    from torsionnet.modal.operational.operational_modes import OperationalModes
    from torsionnet.signals.recording import FloatArray, Recording

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
