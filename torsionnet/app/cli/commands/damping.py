"""Command ``torsionnet damping``, which finds natural frequencies and damping ratios without a measured input."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from torsionnet.app.cli.command import TABLE, Answer, separated_by_lines
from torsionnet.app.cli.options import FiniteFloat, option
from torsionnet.app.cli.pulse_options import NamedWheel, PulseOptions
from torsionnet.app.cli.record_options import RecordCommand
from torsionnet.app.cli.terminal import print_warnings

if TYPE_CHECKING:
    from torsionnet.io.wheel_files import WheelOfTest
    from torsionnet.modal import Match, OperationalModes
    from torsionnet.signals.recording import FloatArray, Recording

SOURCES = ("run-up", "decay", "ambient")
POSITIVE = FiniteFloat(0, min_open=True)
ONLY_FOR = {
    "speed": ("run-up", "ambient"), "angle": ("run-up",), "orders": ("run-up", "ambient"), "band": ("run-up",),
    "excitation": ("run-up",), "revolutions": ("run-up",), "bandwidth": ("run-up",), "modes": ("run-up", "decay"),
    "start": ("decay",), "end": ("decay",), "highest": ("decay", "ambient"),
}  # fmt: skip
"""Kinds of records for which each option counts, by the name of its value."""
WORDS = {"orders": "order", "highest": "to"}
"""Words of options that differ from the names of their values."""


class DampingCommand(RecordCommand):
    """Natural frequencies and damping ratios from a run-up, a free decay or ambient vibration, with 95 % intervals.

    Of a run-up the swept response is fitted, not the steady one, to the channel itself or to an order that was tracked
    (a file of the command track).

    \b
    torsionnet damping runup.npz --from run-up --channel T --order 6 --speed n
    torsionnet damping runup.npz --from run-up --channel T --order 6 --angle fly --pulses fly=60-2
    torsionnet damping drop.npz --from decay --channel T
    torsionnet damping night.npz --from ambient --channel T --to 60
    """

    forms = TABLE
    picture = "measured order and swept fit, decay with envelope, or stabilisation diagram"

    reading: PulseOptions
    source: str = option("--from", type=click.Choice(SOURCES), required=True, help="What the record holds.")
    channels: tuple[str, ...] = option("--channel", metavar="CHANNEL", required=True, help="Ambient: repeatable.")
    orders: tuple[float, ...] = option(
        "--order",
        type=POSITIVE,
        help="Run-up: the order that passes the resonance; further ones are fitted with it. "
        "Ambient: orders of the running machine. Repeatable.",
    )
    speed: str | None = option(
        "--speed", metavar="CHANNEL", help="Channel of the speed of the reference shaft, or a wheel of --pulses."
    )
    angle: str | None = option("--angle", metavar="CHANNEL", help="Instead: channel of its angle, or such a wheel.")
    band: tuple[float, float] | None = option(
        "--band",
        type=(POSITIVE, POSITIVE),
        metavar="LOW HIGH",
        help="Run-up: frequencies of the order in Hz.  [default: about its peak]",
    )
    modes: int | None = option("--modes", type=click.IntRange(1), help="Number of modes.")
    excitation: str | None = option(
        "--excitation",
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
    end: float | None = option("--end", type=FiniteFloat(), help="Decay: s.  [default: found]")
    highest: float | None = option("--to", type=POSITIVE, help="Decay, ambient: highest frequency in Hz.")
    model: str | None = option("--against", metavar="MODEL", help="Compare with the modes of a model.")
    configuration: str = option("--configuration", "-c", metavar="NAME", default="", help="Of that model.")

    def answer(self) -> Answer:
        self._check()
        found = self._found()
        compared = _compared(found, self.model, self.configuration) if self.model else None
        print_warnings(found.notes)
        return Answer(
            screen=lambda: separated_by_lines([found.table(), *([compared.table()] if compared else [])]),
            data=lambda: replace(found, against_model=compared),
            csv=lambda: [("", found.table())],
            figures=lambda plot: [("", plot.operational_modes(found))],
        )

    def _check(self) -> None:
        """Refuse options that say nothing on the kind of record, and channels or orders that are missing."""
        faults = [
            f"--{WORDS.get(name, name)} is for --from {' or '.join(sources)}"
            for name, sources in ONLY_FOR.items()
            if getattr(self, name) not in {None, ()} and self.source not in sources
        ]
        if self.source != "ambient" and len(self.channels) > 1:
            faults.append(f"--from {self.source} reads one --channel")
        if self.source == "run-up" and not self.orders:
            faults.append("the frequency of the excitation is not known: give --order, vibrations per revolution")
        if self.source == "ambient" and self.highest is None:
            faults.append("give the highest frequency of interest, --to, in Hz")
        if faults:
            raise click.UsageError("; ".join(faults))

    def _found(self) -> OperationalModes:
        from torsionnet.modal import modes_from_ambient, modes_from_decay, modes_from_run_up

        if self.source == "run-up" and _is_tracked(self.record):
            return self._tracked()
        record = self._recording()
        if self.source == "decay":
            return modes_from_decay(
                record, self.channels[0], start=self.start, end=self.end, modes=self.modes, highest=self.highest
            )
        if self.source == "ambient":
            turning = None if self.speed is None else _quantity(record, self.speed, "velocity")
            speeds = None if turning is None else (float(turning.min()), float(turning.max()))
            return modes_from_ambient(
                record, self.channels, highest=self.highest or 0.0, orders=self.orders, speeds=speeds
            )
        if (self.speed is None) == (self.angle is None):
            text = "the frequency of an order needs the speed of the shaft: give --speed CHANNEL or --angle CHANNEL"
            raise click.UsageError(text)
        return modes_from_run_up(
            record,
            self.channels[0],
            self.orders,
            str(self.speed or self.angle),
            band=self.band,
            modes=self.modes or 1,
            excitation=self._law(),
            revolutions=self.revolutions,
        )

    def _tracked(self) -> OperationalModes:
        from torsionnet.base.errors import UsageError, did_you_mean
        from torsionnet.io.tracked_order_tables import read_tracked_orders
        from torsionnet.modal import modes_from_tracked_orders

        if len(self.orders) > 1:
            raise click.UsageError("a tracked order is read alone: give one --order")
        tracked = {one.name: one for one in read_tracked_orders(self.record)}
        name = self.channels[0]
        if name not in tracked:
            text = f'no tracked channel is named "{name}"{did_you_mean(name, tracked)}'
            raise UsageError(f"{text}; there is {', '.join(tracked)}")
        return modes_from_tracked_orders(
            tracked[name],
            self.orders[0],
            band=self.band,
            modes=self.modes or 1,
            excitation=self._law(),
            revolutions=self.revolutions,
            bandwidth=self.bandwidth,
        )

    def _law(self) -> Any:
        return self.excitation or "constant"

    def _recording(self) -> Recording:
        from torsionnet.app.cli.record_options import load_record
        from torsionnet.app.cli.terminal import progress
        from torsionnet.signals.recording import Recording

        names = [*self.channels, *(one for one in (self.speed, self.angle) if one)]
        wheels = self.reading.wheels([NamedWheel(name) for name in names])
        unused = [name for name in wheels if name not in names]
        if unused and not self.reading.wheels_file:
            text = f"--pulses {unused[0]}: no --angle, --speed or --channel names this wheel"
            raise click.UsageError(text)
        if used := {name: wheel for name, wheel in wheels.items() if name in names}:
            return self._turning(used, [name for name in names if name not in used])
        with progress("reading", None) as advance:
            found = load_record(self.record, self.reading, names, 0.0, advance)
            return found if isinstance(found, Recording) else _joined(list(found))

    def _turning(self, wheels: dict[str, WheelOfTest], kept: list[str]) -> Recording:
        """Recording of the channels kept, with the angle (rad) of each wheel, or its speed (rad/s), by its name."""
        from torsionnet.app.cli.record_options import checked_record
        from torsionnet.io.turning_records import read_turning_record
        from torsionnet.io.wheel_files import channels_of, patterns_of
        from torsionnet.signals.rotation.rotations_of_wheels import angle_record, rotations_of_wheels

        channels = channels_of(wheels)
        marks = self.reading.marks({one.index for one in channels.values()}, wheels)
        record = read_turning_record(self.record, channels, marks, kept, **self.reading.arguments)
        rotations = rotations_of_wheels(record, channels, patterns_of(wheels), marks=marks)
        made = angle_record(record, tuple(rotations.values()), keep=kept, sampling_rate=self.reading.rate)
        named = {f"{name} {'speed' if name == self.speed else 'angle'}": name for name in wheels}
        signals = [*(made[name] for name in kept), *(replace(made[one], name=name) for one, name in named.items())]
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
            f"unit is not in the file, --unit {name}={unit}"
        )
    return signal.values


def _compared(found: OperationalModes, model: str, configuration: str) -> Match:
    from torsionnet.loading import load
    from torsionnet.modal import match

    rig = load(model)
    rig = rig.configured(configuration) if configuration else rig
    return match(found, rig.modes())
