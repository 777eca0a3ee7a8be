"""Recordings in MDF4 files, through asammdf."""

from __future__ import annotations

import contextlib
import html
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.base.atomic import atomic_replacement
from torsionnet.base.errors import comma_list
from torsionnet.signals.foreign import StoredArray
from torsionnet.signals.formats.extras import import_extra, open_foreign
from torsionnet.signals.recording import Recording
from torsionnet.signals.records.arrays import attribute_text, channel_of, told_apart
from torsionnet.signals.records.source import (
    FileChannel,
    Source,
    check_names,
    other_axis,
    recording_json,
    with_description,
)
from torsionnet.signals.rotation.pulse_channel import PULSE_TIMES


@contextlib.contextmanager
def open_source(path: Path) -> Iterator[Source]:
    """Yield the channels of an MDF file, each with the time stamps of its group; of equal names, the group tells."""
    with open_foreign(path, "mdf") as content:
        text = html.unescape(str(content.attributes.get("comment", "")))  # it is wrapped in XML
        first = len(content.arrays) - int(content.attributes.get("rasters") or 0)
        masters = [
            channel_of(item, number, item.name, attribute_text(item, "unit"))
            for number, item in enumerate(content.arrays[first:], first)
        ]
        items = content.arrays[:first]
        names = told_apart([item.name for item in items], [f"{item.attributes['group']}/{item.name}" for item in items])
        channels = [
            _channel(item, number, name, masters) for number, (item, name) in enumerate(zip(items, names, strict=True))
        ]
        source = Source(tuple(channels), content.blocks, title=path.stem, notes=_missing(channels, content.arrays))
        description = text[text.find("{") : text.rfind("}") + 1]
        own = '"sampling_rate"' in description
        yield with_description(replace(source, channels=(*channels, *masters)), description) if own else source


def _channel(item: StoredArray, number: int, name: str, masters: Sequence[FileChannel]) -> FileChannel:
    channel = channel_of(item, number, name, attribute_text(item, "unit"))
    over = attribute_text(item, "over")
    clock = None if over else masters[int(item.attributes["raster"] or 0)]
    over = over or other_axis(clock.unit if clock else "")
    return replace(channel, clock=None if over else clock, over=over)


def _missing(channels: Sequence[FileChannel], items: Sequence[StoredArray]) -> tuple[str, ...]:
    counts = [(channel.name, item.attributes.get("invalid")) for channel, item in zip(channels, items, strict=False)]
    marked = [f"{name} ({count})" for name, count in counts if count]
    return (f"samples that the file marks as invalid are missing, as NaN: {comma_list(marked)}",) if marked else ()


def write(recording: Recording, path: Path) -> None:
    """Write an MDF4 file of one channel in SI for every signal of a recording."""
    check_names(recording, with_time=True)
    asammdf: Any = import_extra("mdf")
    signals = [
        asammdf.Signal(samples=np.asarray(s.values), timestamps=recording.time, name=s.name, unit=s.unit)
        for s in recording
    ]
    with atomic_replacement(path) as temporary, asammdf.MDF(version="4.10") as file:
        file.append(signals, comment=recording.title)
        for channel in filter(len, recording.pulses):
            train = asammdf.Signal(
                samples=channel.times, timestamps=channel.times, name=channel.name, unit=channel.unit
            )
            file.append([train], comment=PULSE_TIMES)
        file.header.comment = recording_json(recording, with_time=True)
        file.save(temporary, overwrite=True)
