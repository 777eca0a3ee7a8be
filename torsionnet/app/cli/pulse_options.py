"""Options that name the wheels of a record and how their pulses are read, for all commands on turning machines."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from torsionnet.app.cli.options import EntryType, option, refuse
from torsionnet.app.cli.record_options import RecordReading
from torsionnet.base.errors import Fault, ModelError, UsageError, did_you_mean

if TYPE_CHECKING:
    from torsionnet.io.wheel_files import WheelOfTest
    from torsionnet.signals.rotation.counter import PulseReading


class NamedWheel(NamedTuple):
    """Channel, and the text of its teeth, as ``("n1", "60-2")``; no text where they are said elsewhere."""

    name: str
    teeth: str = ""


class TeethOption(EntryType):
    """Type of an option value ``n1``, ``n1=60`` or ``n1=60-2``, read as a channel and the text of its teeth."""

    name = "CHANNEL[=TEETH]"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        name, equals, text = (part.strip() for part in value.partition("="))
        numbers = [part.strip() for part in text.split("-", 1)] if equals else []
        if not (name and all(part.isdecimal() for part in numbers)):
            refuse(
                f'expected {self.name}, as n1=60, n1=60-2 (several gaps: --pattern), got "{value}"',
                param,
                ctx,
                kind="wrong-form",
            )
        return NamedWheel(name, "-".join(numbers))


class WheelSetting(EntryType):
    """Type of an option value ``VALUE`` or ``WHEEL=VALUE``, read as a pair of texts; no wheel stands for all."""

    def __init__(self, value: str) -> None:
        self.name = f"[WHEEL=]{value}"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        left, equals, right = (part.strip() for part in value.partition("="))
        if not (left and (right or not equals)):
            refuse(f'expected {self.name}, got "{value}"', param, ctx, kind="wrong-form")
        return (left, right) if equals else ("", left)


Setting = tuple[tuple[str, str], ...]


class PulseOptions(RecordReading):
    """Options on the wheels of a record: teeth, gap, gearing, pitch pattern, and how the pulses are read.

    Each setting is that of all wheels, or, as ``WHEEL=VALUE``, of one; one of its own comes first.
    """

    pulses: tuple[NamedWheel, ...] = option(  # type: ignore[assignment]
        "--pulses",
        type=TeethOption(),
        help="A wheel by the channel of its pulses, n1=60, or n1=60-2 with a gap of two teeth. The channel holds "
        "times, counts or the signal of the teeth. Repeatable.",
    )
    wheels_file: str | None = option(
        "--wheels",
        metavar="FILE",
        help="Instead: a YAML file with the wheels by channel, as n1: {teeth: 60, ...}; --pulses n1 takes this one.",
    )
    teeth: Setting = option("--teeth", type=WheelSetting("N"), help="Teeth of the wheel, missing ones included.")
    missing_teeth: Setting = option(
        "--missing-teeth", type=WheelSetting("N"), help="Teeth that its gap lacks: 2 of 60-2."
    )
    ratio: Setting = option(
        "--ratio",
        type=WheelSetting("R"),
        help="Turns of the reference shaft per turn of the wheel; negative: it turns against it.",
    )
    index: Setting = option("--index", type=WheelSetting("CHANNEL"), help="Index pulse, which names tooth 0.")
    pattern: Setting = option(
        "--pattern",
        type=WheelSetting("PATTERN"),
        help="File of its pitch pattern, as calibrate-wheel writes it, which is removed; or where its teeth stand, "
        "'16 teeth, 2 missing, 10 teeth, 2 missing', or '0, 80, 180, 270 deg'.",
    )
    tick: Setting = option(
        "--tick", type=WheelSetting("TIME"), help="The channel counts steps of this time, as 12.5ns."
    )
    clock: Setting = option("--clock", type=WheelSetting("FREQUENCY"), help="Instead: of this clock, as 80MHz.")
    bits: Setting = option("--bits", type=WheelSetting("N"), help="Width of the counter, which wraps.")
    level: Setting = option("--level", type=WheelSetting("VALUE"), help="Value that the signal of the teeth passes.")
    hysteresis: Setting = option(
        "--hysteresis", type=WheelSetting("SHARE"), help="Share of its height to pass, as 0.2."
    )
    edge: Setting = option("--edge", type=WheelSetting("rising|falling"), help="Flank of the teeth that counts.")
    pickup: Setting = option(
        "--pickup", type=WheelSetting("switching|inductive"), help="Inductive: the signal grows with the speed."
    )
    second: Setting = option(
        "--second", type=WheelSetting("CHANNEL"), help="Second track of an encoder, for the direction."
    )

    @property
    def arguments(self) -> dict[str, Any]:
        """Keyword arguments of :func:`read_recording` that follow from these options, by name."""
        return {name: value for name, value in super().arguments.items() if name != "pulses"}

    def wheels(self, also: Sequence[NamedWheel] = (), marks: Iterable[str] = ()) -> dict[str, WheelOfTest]:
        """Wheels of the options or of the file, by the channel of their pulses.

        Parameters
        ----------
        also : sequence of NamedWheel
            Channels that other options name, with the text of their teeth; those without teeth are wheels only if
            the file has them.
        marks : iterable of str
            Channels of other pulses, which settings may name, too.

        Raises
        ------
        ModelError
            With every fault.
        UsageError
            Both options and a file name wheels, or a setting names none.
        """
        if self.wheels_file:
            return self._of_file(self.wheels_file, also)
        texts: dict[str, str] = {}
        for name, text in (*((name, text) for name, text in also if text), *self.pulses):
            if text and texts.get(name) not in {None, "", text}:
                raise UsageError(
                    f"{name} is given {texts[name]} and {text} teeth: leave one out", kind="contradicting-entries"
                )
            texts[name] = text or texts.get(name, "")
        self._check_names([*texts, *marks])
        wheels: dict[str, WheelOfTest] = {}
        faults: list[Fault] = []
        for name, text in texts.items():
            of_own = dict(zip(_TEETH, text.split("-", 1), strict=False)) if text else {}
            wheel, wrong = _wheel({**self._settings(name, _ENTRIES), **of_own})
            faults += [replace(fault, message=f"{name}: {fault.message}", path=()) for fault in wrong]
            if wheel:
                wheels[name] = wheel
        if faults:
            raise ModelError(faults, "--pulses")
        return wheels

    def marks(
        self, names: Iterable[str | None], wheels: Mapping[str, WheelOfTest], *, like: str = ""
    ) -> dict[str, PulseReading]:
        """Readings of channels of pulses that are no wheels, as of an index, by name.

        They share tick, clock and bits of all wheels, or, with a file of wheels, of the wheel whose index they are,
        else of the first; what else they have is set by name. With ``like`` they are read as the pulses of that wheel.

        Raises
        ------
        ModelError
            With every fault.
        """
        from torsionnet.signals.rotation.counter import PulseReading

        readings: dict[str, PulseReading] = {}
        for name in filter(None, names):
            if self.wheels_file:
                readings[name] = _reading_of_file(name, wheels, like)
                continue
            own = {**self._settings(name, _COUNTS), **self._of_own(name)}
            if like:
                shared = self._settings(like, _READINGS)
                shared.pop("second", None)
                own = {**shared, **own}
            reading, faults = PulseReading.read({key: _number(key, value) for key, value in own.items()})
            if reading is None:
                texts = [
                    replace(fault, message=f"{name}: {_option(fault)}{fault.message}", path=()) for fault in faults
                ]
                raise ModelError(texts, "--pulses")
            readings[name] = reading
        return readings

    def _of_file(self, file: str, also: Sequence[NamedWheel]) -> dict[str, WheelOfTest]:
        from torsionnet.io.wheel_files import read_wheels

        given = [f"{name}={text}" for name, text in (*also, *self.pulses) if text]
        given += [f"--{name.replace('_', '-')}" for name in _ENTRIES if getattr(self, name)]
        if given:
            raise UsageError(
                f"{Path(file).name} has all entries of the wheels: leave {', '.join(given)} out; --pulses n1 without "
                "teeth takes one wheel of the file",
                kind="contradicting-entries",
            )
        wheels = read_wheels(file)
        for name, _ in self.pulses:
            if name not in wheels:
                hint = did_you_mean(name, wheels)
                raise UsageError(
                    f'{file} has no wheel "{name}"{hint}; there is {", ".join(wheels)}', kind="unknown-name"
                )
        chosen = {name for name, _ in (*also, *self.pulses)} if self.pulses else wheels
        return {name: wheel for name, wheel in wheels.items() if name in chosen}

    def _settings(self, name: str, entries: Iterable[str]) -> dict[str, str]:
        """Settings of a wheel by the names of entries, those of its own before those of all."""
        of_all = {entry: value for entry in entries for wheel, value in getattr(self, entry) if not wheel}
        of_own = {entry: value for entry, value in self._of_own(name).items() if entry in entries}
        if of_own.keys() & {"tick", "clock"}:  # they say the same thing: one of its own takes the place of either
            of_all = {entry: value for entry, value in of_all.items() if entry not in {"tick", "clock"}}
        return {**of_all, **of_own}

    def _of_own(self, name: str) -> dict[str, str]:
        """Settings that name a channel, by the names of entries."""
        return {entry: value for entry in _ENTRIES for wheel, value in getattr(self, entry) if wheel == name}

    def _check_names(self, known: Sequence[str]) -> None:
        """Refuse a setting of a wheel that no option names."""
        for entry in _ENTRIES:
            for name, value in getattr(self, entry):
                if name and name not in known:
                    word, hint = entry.replace("_", "-"), did_you_mean(name, known)
                    there = ", ".join(known) or "none: name it with --pulses"
                    raise UsageError(
                        f"--{word} {name}={value}: there is no wheel of this name{hint}; there is {there}",
                        kind="unknown-name",
                    )


_TEETH = ("teeth", "missing_teeth")
_COUNTS, _SIGNALS = ("tick", "clock", "bits"), ("level", "hysteresis", "edge", "pickup", "second")
_READINGS = (*_COUNTS, *_SIGNALS)
_ENTRIES = (*_TEETH, "ratio", "index", "pattern", *_READINGS)
_WHOLE = (*_TEETH, "bits")


def _reading_of_file(name: str, wheels: Mapping[str, WheelOfTest], like: str) -> PulseReading:
    """Reading of a channel by a file of wheels: its own, that of the wheel it is like, or that wheel's counter."""
    from torsionnet.signals.rotation.wheel_channel import counted_reading

    if name in wheels:
        return wheels[name].channel
    if like:
        return replace(wheels[like].channel, second="")
    first = next(iter(wheels.values()))
    return counted_reading(next((wheel for wheel in wheels.values() if wheel.channel.index == name), first).channel)


def _wheel(given: dict[str, str]) -> tuple[WheelOfTest | None, list[Fault]]:
    from torsionnet.io.wheel_files import WheelOfTest, pattern_of
    from torsionnet.signals.rotation.wheel_channel import WheelChannel

    if "teeth" not in given:
        return None, [
            Fault("how many teeth does the wheel have? give --pulses CHANNEL=60 or --teeth 60", kind="missing-entry")
        ]
    entries: dict[str, Any] = {name: _number(name, value) for name, value in given.items()}
    if (ratio := given.get("ratio", "")).startswith("-"):
        entries |= {"ratio": ratio[1:].strip(), "reversed": True}
    wheel, faults = WheelChannel.read(entries)
    if wheel is None:
        return None, [replace(fault, message=f"{_option(fault)}{fault.message}") for fault in faults]
    pattern, wrong = pattern_of(wheel, Path())
    return WheelOfTest(wheel, pattern), wrong


def _option(fault: Fault) -> str:
    return f"--{str(fault.path[0]).replace('_', '-')}: " if fault.path else ""


def _number(name: str, text: str) -> int | str:
    return int(text) if name in _WHOLE and text.strip().isdecimal() else text
