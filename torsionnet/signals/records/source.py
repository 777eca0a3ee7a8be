"""Channels of an open file that are read in blocks, and the description of a recording that a file holds."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

from torsionnet.base.delimited.dialect import plain_unit
from torsionnet.base.errors import Position, UsageError
from torsionnet.base.notes import NoteOrText, note_data, stored_note
from torsionnet.base.plain_names import free_name
from torsionnet.base.units import DIMENSIONS, UnitError, parse_unit
from torsionnet.linear.between_samples import Between, check_between
from torsionnet.signals.foreign.content import Blocks
from torsionnet.signals.recording import QUANTITY_UNITS, FloatArray, Recording, Signal
from torsionnet.signals.rotation.counter import PulseReading
from torsionnet.signals.rotation.pulse_channel import PULSE_TIMES

# Channels of an open file that are read in blocks, before their units are looked at.

TIME_NAMES = frozenset({"time", "times", "zeit", "tid", "temps", "timestamp", "timestamps", "time stamp", "x-time"})
"""Names of channels that are taken for time stamps in several languages, in lower case."""
CLOCK_NAMES = {
    "rate": frozenset({"fs", "sampling_rate", "sample_rate", "samplerate", "samplingrate", "abtastrate"}),
    "interval": frozenset({
        "dt", "ts", "tinterval", "delta_t", "deltat", "sampling_interval", "sample_interval", "samplinginterval",
        "sampleinterval", "sampling_time", "sample_time", "sampletime", "tsample", "tinc", "xincrement",
        "abtastintervall",
    }),
    "start": frozenset({"tstart", "t0", "start_time", "starttime", "startzeit", "xorigin"}),
}  # fmt: skip
"""Names of single numbers in a file that are taken for the sampling rate in Hz, or sampling interval or start in s, in
lower case."""

T = TypeVar("T")
NOWHERE = -1
"""Column of a channel without values, for which a file has no array."""


@dataclass(frozen=True)
class FileChannel:
    """Channel of a recording as the file has it, with its name, unit and number (``column``) for ``Source.blocks``.

    ``quantity`` is None where the file says nothing, empty where it says that none is known. ``rate`` (Hz) and
    ``start`` (s) are those of the channel alone, where the file has them for each, or ``clock`` is the channel of its
    time stamps; ``over`` is the unit or name of its axis where that is no time, ``scale`` the channel of its axis where
    nothing tells what that is. ``group`` is where it stands in the file. ``implied`` has the factor to SI by
    quantity where the file has units for all channels, for those without one of their own. Time stamps count from
    ``zero``. ``between`` and ``course_rate`` are those of a :class:`~torsionnet.signals.recording.Signal`.
    """

    name: str
    column: int
    unit: str = ""
    quantity: str | None = None
    length: int | None = None
    position: Position | None = None
    notes: tuple[NoteOrText, ...] = ()
    rate: float | None = None
    start: float | None = None
    clock: FileChannel | None = None
    over: str = ""
    scale: FileChannel | None = None
    group: str = ""
    implied: Mapping[str, float] = field(default_factory=dict)
    zero: float = 0.0
    between: Between = "band_limited"
    course_rate: float | None = None

    def shares_axis(self, stamps: FileChannel) -> bool:
        """Whether a channel may have these time stamps, going over no other dimension scale than they do."""
        return self.scale is None or self.scale.name in (stamps.name, stamps.scale.name if stamps.scale else "")


@dataclass(frozen=True)
class StoredPulses:
    """Channel of a file with pulses: times in s with the step of their counter in s, or what ``reading`` says."""

    channel: FileChannel
    tick: float
    reading: PulseReading | None = None


@dataclass(frozen=True)
class StatedInterval:
    """Sampling interval in s that an entry of a file gives besides the time stamps."""

    name: str
    seconds: float
    position: Position


@dataclass(frozen=True)
class Source:
    """Channels, sampling rate in Hz and notes of an open file.

    ``blocks(columns, count)`` reads so many samples at a time, everything at once where ``count`` is 0.
    ``discovered`` grows while blocks are read: what was assumed about the values. ``hint`` is added to what is wrong.
    ``seams`` grows with them: first sample and start in s of each block that does not follow the one before.
    """

    channels: tuple[FileChannel, ...]
    blocks: Blocks
    time: FileChannel | None = None
    rate: float | None = None
    start: float = 0.0
    stamped: bool = False
    title: str = ""
    notes: tuple[NoteOrText, ...] = ()
    discovered: list[NoteOrText] = field(default_factory=list)
    place: Callable[[int], Position | None] = lambda _row: None
    stated: StatedInterval | None = None
    pulses: tuple[StoredPulses, ...] = ()
    hint: str = ""
    seams: list[tuple[int, float]] = field(default_factory=list)

    @property
    def every(self) -> dict[str, FileChannel]:
        """Channels by name, those of time stamps among them."""
        clocks = [channel.clock for channel in self.channels if channel.clock]
        stamps = [self.time] if self.time else []
        return {channel.name: channel for channel in (*reversed(clocks), *stamps, *self.channels)}

    def with_time_channel(self) -> Source:
        """Source with the channel of time stamps, known by its name or unit, taken out of the others.

        Where structures or groups have time stamps each, channels have those of the nearest.
        """
        named = {
            structure_of(channel.name): channel
            for channel in reversed(self.channels)
            if is_time(channel) and _has_time_name(channel)
        }
        if len(named) > 1 or any(channel.rate or channel.clock for channel in self.channels):
            clocks = {
                *(channel.column for channel in named.values()),
                *(channel.clock.column for channel in self.channels if channel.clock),
            }
            rest = [channel for channel in self.channels if channel.column not in clocks]
            own = [channel if channel.clock or channel.over else _timed(channel, named) for channel in rest]
            return replace(self, channels=tuple(own))
        for channel in self.channels:
            if is_time(channel):
                others = tuple(other for other in self.channels if other is not channel)
                return replace(self, channels=others, time=channel, notes=(*self.notes, time_note(channel)))
        return self


def _timed(channel: FileChannel, named: Mapping[str, FileChannel]) -> FileChannel:
    """Channel with the time stamps of the nearest structure; one with a rate has those of its own, which say more."""
    stamps = named.get(structure_of(channel.name)) if channel.rate else nearest(channel.name, named)
    if channel.rate and (stamps is None or channel.start or stamps.length != channel.length):
        return channel
    if stamps and not channel.shares_axis(stamps):
        return channel
    return replace(channel, rate=None, start=None, clock=stamps)


def group_of(channel: FileChannel) -> str:
    """Group or structure of a file that a channel is in, empty for none."""
    return channel.group or structure_of(channel.name)


def structure_of(name: str) -> str:
    """Structure that a field of a file is in, empty for one in none."""
    return name.rpartition(".")[0]


def nearest(name: str, clocks: Mapping[str, T]) -> T | None:
    """Clock of the structure that a channel is in, or of the nearest around it; None where none has any."""
    inside = structure_of(name)
    while inside and inside not in clocks:
        inside = structure_of(inside)
    return clocks.get(inside)


def time_note(channel: FileChannel) -> str:
    """Note on a recording that a channel was taken for the time stamps."""
    return f'"{channel.name}" was taken for the time stamps'


def is_time(channel: FileChannel) -> bool:
    """Whether a channel holds time stamps, having a unit of time, or none and a name for time."""
    if not channel.unit:
        return _has_time_name(channel)
    try:
        return parse_unit(plain_unit(channel.unit)).dimension == DIMENSIONS["time"]
    except UnitError:
        return False


def _has_time_name(channel: FileChannel) -> bool:
    name = channel.name.rpartition(".")[2].strip()  # the field of a structure
    return name == "t" or name.casefold() in TIME_NAMES  # T is a torque


def clock_entry(name: str) -> str:
    """Entry of the clock that a single number of this name is, ``rate``, ``interval`` or ``start``, empty for none.

    >>> clock_entry("fs"), clock_entry("d.Time_Sample_Rate"), clock_entry("Tinterval"), clock_entry("Length")
    ('rate', 'rate', 'interval', '')
    """
    folded = name.rpartition(".")[2].casefold()
    for kind, names in CLOCK_NAMES.items():
        if folded in names or any(folded.endswith(f"_{known}") for known in names if len(known) > 2):
            return kind
    return ""


# Axes of channels in files: time in any unit, frequencies in any unit, or an angle and others, which are no time.

_NO_TIMES = re.compile(
    r"angle|winkel|frequen|\border|ordnung|distan|position|\bweg\b|rotation|revolution|umdrehung|drehzahl|\brpm\b",
    re.IGNORECASE,
)
"""Words in the names of axes that are no time, in English and German."""


def other_axis(unit: str, name: str = "") -> str:
    """Unit, or else name, of an axis that is no time; empty where it is time, or where nothing tells what it is.

    >>> other_axis("deg"), other_axis("ms", "Time"), other_axis("", "Crank angle"), other_axis("")
    ('deg', '', 'Crank angle', '')
    """
    if not unit:
        return name if _NO_TIMES.search(name) else ""
    try:
        return "" if parse_unit(plain_unit(unit)).dimension == DIMENSIONS["time"] else unit
    except UnitError:
        return unit


def seconds_in(unit: str) -> float:
    """Seconds in a unit of time, one where there is no unit.

    >>> seconds_in("ms"), seconds_in("")
    (0.001, 1.0)
    """
    return float(parse_unit(plain_unit(unit)).factor) if unit else 1.0


def hertz_in(unit: str) -> float:
    """Hz in a unit of frequency or of angular frequency, one where there is no unit.

    Raises
    ------
    UnitError
        The unit is one of something else.

    >>> hertz_in("kHz"), round(hertz_in("rad/s"), 9), round(hertz_in("rpm"), 9)
    (1000.0, 0.159154943, 0.016666667)
    """
    if not unit:
        return 1.0
    parsed = parse_unit(plain_unit(unit))
    if parsed.dimension not in (DIMENSIONS["frequency"], DIMENSIONS["speed"]):
        raise UnitError(f'"{unit}" is no unit of frequency; expected one like Hz or rad/s', kind="wrong-unit")
    return float(parsed.factor) / (1.0 if parsed.dimension == DIMENSIONS["frequency"] else 2 * math.pi)


# Description of a recording (everything but its values) as one JSON text that is saved in a file next to them.

KEY = "torsionnet_recording"
"""Name under which the description of a recording stands in a file."""
TIME = "time"
"""Name of the time stamps of a recording in a file."""


def channel_names(recording: Recording) -> tuple[str, ...]:
    """Names of the signals of a recording, then those of its channels of pulses, as a file has to hold them."""
    return (*recording.names, *(channel.name for channel in recording.pulses))


def recording_json(recording: Recording, keys: Sequence[str] | None = None, *, with_time: bool = False) -> str:
    """JSON text of a recording's names, quantities, sampling rate in Hz, start in s, title, notes and pulses.

    ``keys`` name the values in the file, those of signals, then those of channels of pulses.
    """
    named = list(keys or channel_names(recording))
    signals = [
        {
            "key": key,
            "name": signal.name,
            "quantity": signal.quantity,
            "notes": list(map(note_data, signal.notes)),
            **_course(signal),
        }
        for key, signal in zip(named, recording, strict=False)
    ]
    pulses = [
        {
            "key": key,
            "name": channel.name,
            "count": len(channel),
            "tick": channel.tick,
            "notes": list(map(note_data, channel.notes)),
        }
        for key, channel in zip(named[len(signals) :], recording.pulses, strict=True)
    ]
    data = {
        "sampling_rate": recording.sampling_rate,
        "start": recording.start,
        "time": TIME if with_time or recording.times is not None else None,
        "stamped": recording.times is not None,
        "title": recording.title,
        "notes": list(map(note_data, recording.notes)),
        "signals": signals,
        # A record without pulses keeps the bytes that it had before there were pulses in files.
        **({"pulses": pulses} if pulses else {}),
    }
    return json.dumps(data)


def _course(signal: Signal) -> dict[str, Any]:
    """Course of a signal between samples as plain values; band-limited ones keep the bytes they had before it."""
    if signal.between == "band_limited":
        return {}
    return {"between": signal.between, **({"course_rate": signal.course_rate} if signal.course_rate else {})}


@dataclass(frozen=True)
class SavedColumn:
    """Values (n,) of a recording's signal in SI with their name in the file, and unit and quantity as attributes.

    Pulse times have a length of their own.
    """

    name: str
    values: FloatArray
    attributes: dict[str, str]

    @property
    def is_sampled(self) -> bool:
        """Whether the values were sampled together with those of the other columns, unlike pulse times."""
        return self.attributes.get("quantity") != PULSE_TIMES


def saved_columns(recording: Recording, keys: Sequence[str] | None = None) -> list[SavedColumn]:
    """Columns of a recording to save, every signal, the time stamps where there are any, pulses, with unique names."""
    check_names(recording)
    named = list(keys or channel_names(recording))
    columns = [
        SavedColumn(key, signal.values, {"unit": signal.unit, "quantity": signal.quantity})
        for key, signal in zip(named, recording, strict=False)
    ]
    times = [] if recording.times is None else [SavedColumn(TIME, recording.times, {"unit": "s"})]
    pulses = [
        SavedColumn(key, channel.times, {"unit": channel.unit, "quantity": PULSE_TIMES})
        for key, channel in zip(named[len(columns) :], recording.pulses, strict=True)
    ]
    return [*columns, *times, *pulses]


def with_description(source: Source, text: str) -> Source:
    """Source of a recording with what the description in its file says.

    Without a description, with its time channel found.

    Raises
    ------
    ValueError
        The two do not fit.
    """
    if not text:
        return source.with_time_channel()
    try:
        data = json.loads(text)
        channels = tuple(_channel(source, entry) for entry in data["signals"])
        pulses = tuple(_pulse_channel(source, entry) for entry in data.get("pulses", []))
        time = None if data["time"] is None else _named(source, data["time"])
        known = {"rate": float(data["sampling_rate"]), "start": float(data["start"]), "stamped": bool(data["stamped"])}
        words = {"title": str(data["title"]), "notes": tuple(map(stored_note, data["notes"]))}
    except (json.JSONDecodeError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(
            f"the description of the recording in the file is damaged ({type(error).__name__}: {error})"
        ) from error
    return replace(source, channels=channels, pulses=pulses, time=time, **known, **words)  # type: ignore[arg-type]


def _pulse_channel(source: Source, entry: dict[str, Any]) -> StoredPulses:
    tick = float(entry["tick"])
    if not 0 <= tick < float("inf"):
        raise TypeError(f"tick is {tick}")
    # Some formats keep no array without values.
    named = _named(source, entry["key"]) if entry["count"] else FileChannel(entry["key"], NOWHERE)
    return StoredPulses(replace(named, name=str(entry["name"]), notes=tuple(map(stored_note, entry["notes"]))), tick)


def _channel(source: Source, entry: dict[str, Any]) -> FileChannel:
    quantity = str(entry["quantity"])
    return replace(
        _named(source, entry["key"]),
        name=str(entry["name"]),
        quantity=quantity,
        unit=QUANTITY_UNITS.get(quantity, ""),
        notes=tuple(map(stored_note, entry["notes"])),
        between=_known_course(entry),
        course_rate=float(entry["course_rate"]) if "course_rate" in entry else None,
        rate=None,
        start=None,
        clock=None,
    )


def _known_course(entry: dict[str, Any]) -> Between:
    try:
        return check_between(entry.get("between", "band_limited"))
    except UsageError as error:
        raise TypeError(str(error)) from None


def _named(source: Source, key: str) -> FileChannel:
    for channel in source.channels:
        if channel.name == key:
            return channel
    raise ValueError(f"channel {key}, which its description names, is not in the file")


def check_names(recording: Recording, *, with_time: bool = False) -> None:
    """Refuse a recording of which two channels would have one name in a file."""
    names = [*channel_names(recording), *([TIME] if with_time or recording.times is not None else [])]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise UsageError(f"cannot write two channels of one name: {', '.join(twice)}", kind="repeated-name")


def plain_keys(names: Sequence[str], pattern: str, taken: Sequence[str] = (TIME,)) -> list[str]:
    """Unique names of channels without what ``pattern`` finds, for formats that do not take every name.

    >>> plain_keys(["T [1]", "T_1_", "time"], "[^A-Za-z0-9_]")
    ['T__1_', 'T_1_', 'time_2']
    """
    keys: list[str] = []
    for name in names:
        plain = re.sub(pattern, "_", name.strip()) or "signal"
        keys.append(free_name(plain, {*keys, *taken}))
    return keys
