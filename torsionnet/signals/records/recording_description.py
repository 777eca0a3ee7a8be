"""Description of a recording (everything but its values) as one JSON text that is saved in a file next to them."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import note_data, stored_note
from torsionnet.base.plain_names import free_name
from torsionnet.linear.between_samples import Between, check_between
from torsionnet.signals.recording import QUANTITY_UNITS, FloatArray, Recording, Signal
from torsionnet.signals.records.source import NOWHERE, FileChannel, Source, StoredPulses
from torsionnet.signals.rotation.pulse_channel import PULSE_TIMES

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
