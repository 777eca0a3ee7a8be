"""Options that name the wheels of a record and how their pulses are read, for commands on turning machines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from torsionnet.cli.declarations import option
from torsionnet.cli.options import PairOption
from torsionnet.cli.record_options import RecordReading
from torsionnet.core.errors import Fault, ModelError, UsageError

if TYPE_CHECKING:
    from torsionnet.io.wheel_files import WheelOfTest
    from torsionnet.response.recording import Recording
    from torsionnet.signals.rotation.wheel_rotation import WheelRotation


class PulsesOption(PairOption):
    """Type of an option value ``n1``, ``n1=60`` or ``n1=60-2``, read as a channel and the text of its teeth."""

    def __init__(self) -> None:
        super().__init__("CHANNEL", "TEETH", "n1=60")
        self.name = "CHANNEL[=TEETH]"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        return super().convert(value, param, ctx) if "=" in value else (value.strip(), "")


class PulseOptions(RecordReading):
    """Options on reading a record of turning wheels, such as the channels of their pulses, teeth, gap and clock."""

    pulses: tuple[tuple[str, str], ...] = option(  # type: ignore[assignment]
        "--pulses",
        type=PulsesOption(),
        help="A channel of pulses, of their times or counts, or the signal of the teeth. Repeatable.",
    )
    wheels_file: str | None = option(
        "--wheels", metavar="FILE", help="Instead: a YAML file with the wheels by channel, as n1: {teeth: 60, ...}."
    )
    teeth: str | None = option("--teeth", metavar="N", help="Teeth of the wheel, missing ones included.")
    missing_teeth: str | None = option("--missing-teeth", metavar="N", help="Teeth that its gap lacks: 2 of 60-2.")
    ratio: str | None = option("--ratio", metavar="R", help="Turns of the reference shaft per turn of the wheel.")
    turns_against: bool = option("--reversed", help="The wheel turns against the sense of the reference shaft.")
    index: str | None = option("--index", metavar="CHANNEL", help="Index pulse, which names tooth 0.")
    pattern: str | None = option("--pattern", metavar="FILE", help="Pitch pattern of the wheel, which is removed.")
    tick: str | None = option("--tick", metavar="TIME", help="The channel counts steps of this time, as 12.5ns.")
    clock: str | None = option("--clock", metavar="FREQUENCY", help="Instead: of this clock, as 80MHz.")
    bits: str | None = option("--bits", metavar="N", help="Width of the counter, which wraps.")
    level: str | None = option("--level", metavar="VALUE", help="Value that the signal of the teeth passes.")
    hysteresis: str | None = option("--hysteresis", metavar="SHARE", help="Share of its height to pass, as 0.2.")
    edge: str | None = option(
        "--edge", type=click.Choice(["rising", "falling"]), help="Flank of the teeth that counts."
    )
    pickup: str | None = option(
        "--pickup", type=click.Choice(["switching", "inductive"]), help="Inductive: the signal grows with the speed."
    )
    second: str | None = option("--second", metavar="CHANNEL", help="Second track of an encoder, for the direction.")

    @property
    def arguments(self) -> dict[str, Any]:
        """Keyword arguments of :func:`read_recording` that follow from these options, by name."""
        return {name: value for name, value in super().arguments.items() if name != "pulses"}

    def wheels(self) -> dict[str, WheelOfTest]:
        """Wheels of the options or of the file, by the channel of their pulses.

        Raises
        ------
        ModelError
            With every fault.
        UsageError
            Neither options nor a file name a wheel, or both do.
        """
        from torsionnet.io.wheel_files import read_wheels

        given = {name: value for name in _ENTRIES if (value := getattr(self, name)) is not None}
        if self.wheels_file:
            if self.pulses or given:
                raise UsageError("--wheels has all entries of the wheels: leave --pulses and the others out")
            return read_wheels(self.wheels_file)
        if not self.pulses:
            raise UsageError("name the channel of pulses: --pulses n1=60, or a file of wheels: --wheels wheels.yaml")
        found: dict[str, WheelOfTest] = {}
        faults: list[Fault] = []
        for name, teeth in self.pulses:
            of_own = dict(zip(("teeth", "missing_teeth"), teeth.split("-", 1), strict=False)) if teeth else {}
            wheel, wrong = self._wheel({**given, **of_own})
            faults += [replace(fault, message=f"{name}: {fault.message}", path=()) for fault in wrong]
            if wheel:
                found[name] = wheel
        if faults:
            raise ModelError(faults, "--pulses")
        return found

    def _wheel(self, given: dict[str, Any]) -> tuple[WheelOfTest | None, list[Fault]]:
        from torsionnet.io.wheel_files import WheelOfTest, pattern_of
        from torsionnet.signals.rotation.wheel_channel import WheelChannel

        entries = {name: _number(value) if name in _WHOLE else value for name, value in given.items()}
        if "teeth" not in entries:
            return None, [Fault("how many teeth does the wheel have? give --pulses CHANNEL=60 or --teeth 60")]
        wheel, faults = WheelChannel.read({**entries, "reversed": self.turns_against})
        if wheel is None:
            return None, [replace(fault, message=f"{_option(fault)}{fault.message}") for fault in faults]
        pattern, wrong = pattern_of(wheel, Path())
        return WheelOfTest(wheel, pattern), wrong


MOSTLY_RISING = 0.9
"""Share of values larger than the one before above which a channel holds times of pulses, if faulty ones."""
_WHOLE = ("teeth", "missing_teeth", "bits")
_ENTRIES = (
    *_WHOLE, "ratio", "index", "pattern", "tick", "clock", "level", "hysteresis", "edge", "pickup", "second",
)  # fmt: skip


def _option(fault: Fault) -> str:
    return f"--{str(fault.path[0]).replace('_', '-')}: " if fault.path else ""


def _number(text: str) -> int | str:
    return int(text) if text.strip().isdecimal() else text


def turning_record(path: str, reading: PulseOptions, kept: Sequence[str] = ()) -> tuple[Recording, list[WheelRotation]]:
    """Record with the channels to be kept, and the rotation of every wheel.

    Raises
    ------
    ModelError
        The file is faulty.
    UsageError
        Pulses that do not fit their wheel.
    """
    from torsionnet.signals.rotation.wheel_channel import wheel_pulses
    from torsionnet.signals.rotation.wheel_rotation import wheel_rotation

    wheels = reading.wheels()
    record = _record(path, reading, wheels, kept)
    found, faults = [], []
    for name, one in wheels.items():
        try:
            index = wheel_pulses(record, one.channel.index, _reading(one)) if one.channel.index else None
            pulses = wheel_pulses(record, name, one.channel)
            found.append(wheel_rotation(pulses, one.channel, one.pattern, index=index))
        except UsageError as error:
            faults.append(Fault(str(error)))
    if faults:
        raise ModelError(faults, path)
    return record, found


def _reading(one: WheelOfTest) -> Any:
    from torsionnet.signals.rotation.wheel_channel import counted_reading

    return counted_reading(one.channel)


def _record(path: str, reading: PulseOptions, wheels: dict[str, WheelOfTest], kept: Sequence[str]) -> Recording:
    """Record of the channels of wheels, their index and second track, and those to be kept.

    Unless a wheel has the entries of a tooth signal, its channel is read as times or counts first.
    """
    import numpy as np

    from torsionnet.io.recording_files import read_recording

    stamped = {
        name: _reading(one)
        for wheel, one in wheels.items()
        for name in (wheel, one.channel.index)
        if name and not one.channel.is_of_a_signal
    }
    counted = {name: one for name, one in stamped.items() if one.seconds is not None}
    attempts = (
        {"names": [*stamped, *kept]},  # pulses that this package has written
        {"names": [*stamped, *kept], "pulse_readings": stamped},
        {"pulse_readings": counted},  # a channel asked for by name must have a quantity, and a voltage has none
    )
    refused: list[ModelError] = []
    for given in attempts if stamped else attempts[-1:]:
        try:
            record = read_recording(path, **given, **reading.arguments)
        except ModelError as error:
            refused.append(error)
            continue
        trains = {channel.name for channel in record.pulses}
        signals = {one: np.mean(np.diff(record[one].values) > 0) for one in stamped if one in record.names}
        if stamped.keys() <= trains or (given is attempts[-1] and all(x < MOSTLY_RISING for x in signals.values())):
            return record
    raise refused[len(refused) > 1]
