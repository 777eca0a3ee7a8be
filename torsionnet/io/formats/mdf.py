"""Recordings in MDF4 files, through asammdf."""

from __future__ import annotations

import contextlib
import html
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.core.atomic import atomic_replacement
from torsionnet.io.formats.extras import import_extra, open_foreign
from torsionnet.io.records.arrays import attribute_text, channel_of
from torsionnet.io.records.recording_description import check_names, recording_json, with_description
from torsionnet.io.records.source import Source
from torsionnet.response.measured.pulse_channel import PULSE_TIMES
from torsionnet.response.recording import Recording


@contextlib.contextmanager
def open_source(path: Path) -> Iterator[Source]:
    """Yield the channels of an MDF file with the time stamps of the first channel."""
    with open_foreign(path, "mdf") as content:
        text = html.unescape(str(content.attributes.get("comment", "")))  # it is wrapped in XML
        channels = [
            channel_of(item, number, item.name, attribute_text(item, "unit"))
            for number, item in enumerate(content.arrays)
        ]
        source = Source(tuple(channels), content.blocks, title=path.stem)
        found = text[text.find("{") : text.rfind("}") + 1]
        yield with_description(source, found if '"sampling_rate"' in found else "")


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
