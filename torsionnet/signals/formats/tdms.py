"""Recordings in TDMS files of LabVIEW, through npTDMS."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from torsionnet.base.atomic import atomic_replacement
from torsionnet.signals.foreign import StoredArray
from torsionnet.signals.foreign.content import WAVE_INTERVAL, WAVE_OFFSET, WAVE_START
from torsionnet.signals.formats.extras import import_extra, open_foreign
from torsionnet.signals.recording import Recording
from torsionnet.signals.records.arrays import attribute_text, channel_of
from torsionnet.signals.records.source import (
    KEY,
    FileChannel,
    Source,
    is_time,
    recording_json,
    saved_columns,
    with_description,
)

GROUP = "recording"
"""Name of the group written."""
ZERO = "zero"
"""Attribute of a channel of time stamps with the first of them, from which the seconds count."""
PIECE = 1 << 20
"""Samples of a TDMS segment that is written, few enough to fit into memory, enough for npTDMS to be quick."""


@contextlib.contextmanager
def open_source(path: Path) -> Iterator[Source]:
    """Yield the channels of a TDMS file, with sampling rate (Hz) and start (s) from the waveform properties."""
    with open_foreign(path, "tdms") as content:
        items = content.arrays
        every = [_channel(item, number) for number, item in enumerate(items)]
        stamps = _stamps(items, every)
        clocks = {channel.column for channel in stamps.values()}
        channels = [
            channel
            if channel.rate or channel.over
            else replace(channel, clock=_clock(stamps.get(_group(item)), channel))
            for item, channel in zip(items, every, strict=True)
            if ZERO not in item.attributes and channel.column not in clocks
        ]
        rates = [channel.rate for channel in channels if channel.rate]
        starts = [channel.start for channel in channels if channel.start is not None]
        title = str(content.attributes.get("name", path.stem))
        start = starts[0] if starts else 0.0
        notes = (
            [f"begins at {start:g} s, its wf_start_offset"] if start and len(set(starts)) == 1 and not stamps else []
        )
        begun = [WAVE_START in item.attributes for item in items if item.attributes.get(WAVE_INTERVAL)]
        if any(begun) and not all(begun):
            notes.append("channels without wf_start_time were taken to begin with the first of the others")
        rate = rates[0] if rates else None
        zeros = [(channel.name, attribute_text(items[channel.column], ZERO)) for channel in stamps.values()]
        notes += [f"{name} counts from {zero} UTC" for name, zero in zeros if zero]
        source = Source(tuple(channels), content.blocks, rate=rate, start=start, title=title, notes=tuple(notes))
        text = str(content.attributes.get(KEY, ""))
        yield with_description(source, text) if text or not (rates or stamps) else source


def _group(item: StoredArray) -> str:
    return attribute_text(item, "group")


def _stamps(items: Sequence[StoredArray], every: Sequence[FileChannel]) -> dict[str, FileChannel]:
    """Channel of time stamps of every group, the first of them; of numbers where several groups have such a channel."""
    dated, numbers = dict[str, FileChannel](), dict[str, FileChannel]()
    for item, channel in zip(items, every, strict=True):
        named = replace(channel, name=item.name)
        if ZERO in item.attributes:
            dated.setdefault(_group(item), channel)
        elif is_time(named) and is_time(replace(named, unit="")) and not channel.rate:
            numbers.setdefault(_group(item), channel)
    return {**numbers, **dated} if len({*numbers, *dated}) > 1 else dated


def _clock(stamps: FileChannel | None, channel: FileChannel) -> FileChannel | None:
    """Time stamps of the group that a channel is in, where there is one for each of its samples."""
    return stamps if stamps and stamps.length == channel.length else None


def _channel(item: StoredArray, number: int) -> FileChannel:
    group = _group(item)
    unit = attribute_text(item, "unit_string", "NI_UnitDescription")
    channel = channel_of(item, number, f"{group}/{item.name}" if "group" in item.attributes else item.name, unit)
    channel = replace(channel, group=group)
    return replace(channel, unit="s") if ZERO in item.attributes else channel


def write(recording: Recording, path: Path) -> None:
    """Write a TDMS file of one group with the signals of a recording in SI, waveform properties and units."""
    columns = saved_columns(recording)
    nptdms = import_extra("tdms")
    root = nptdms.RootObject({"name": recording.title or path.stem, KEY: recording_json(recording)})
    wave = {WAVE_INTERVAL: 1 / recording.sampling_rate, WAVE_OFFSET: recording.start}
    with atomic_replacement(path) as temporary, nptdms.TdmsWriter(str(temporary)) as writer:
        writer.write_segment([root, nptdms.GroupObject(GROUP)])
        for first in range(0, max((len(column.values) for column in columns), default=0), PIECE):
            writer.write_segment([
                nptdms.ChannelObject(
                    GROUP, column.name, column.values[first : first + PIECE],
                    _properties(column.attributes, wave if column.is_sampled else {}),
                )
                for column in columns
                if first < max(len(column.values), 1)
            ])  # fmt: skip


def _properties(attributes: Mapping[str, str], wave: Mapping[str, float]) -> dict[str, str | float]:
    """Properties of a channel of a TDMS file, its quantity, unit and waveform, or of time stamps the unit alone."""
    named = {"unit_string" if name == "unit" else name: text for name, text in attributes.items()}
    return {**wave, **named} if "quantity" in named else {**named}
