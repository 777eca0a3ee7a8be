"""TDMS files of LabVIEW, through npTDMS."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.atomic import replacing
from torsionnet.signals.files.extras import needed
from torsionnet.signals.files.source import Channel, Reader, Source, sliced
from torsionnet.signals.files.stored import KEY, TIME, checked_names, stored, with_stored
from torsionnet.signals.recording import FloatArray, Recording

GROUP, PIECE = "recording", 1 << 20


@contextlib.contextmanager
def opened(path: Path) -> Iterator[Source]:
    """A TDMS file; rate and start are those of the waveform properties."""
    nptdms = needed("tdms")
    with path.open("rb") as stream, nptdms.TdmsFile.open(stream) as file:
        groups = file.groups()
        items = [channel for group in groups for channel in group.channels() if _is_numeric(channel)]
        channels = [_channel(item, number, len(groups) > 1) for number, item in enumerate(items)]
        blocks = sliced([_reader(item) for item in items], [len(item) for item in items])
        waves = [item.properties for item in items if item.properties.get("wf_increment")]
        rate = 1 / float(waves[0]["wf_increment"]) if waves else None
        start = float(waves[0].get("wf_start_offset", 0.0)) if waves else 0.0
        title = str(file.properties.get("name", path.stem))
        source = Source(tuple(channels), blocks, rate=rate, start=start, title=title, notes=_rate_notes(waves))
        text = file.properties.get(KEY, "")
        yield with_stored(source, text) if text else source if waves else source.with_time_found()


def _is_numeric(channel: Any) -> bool:
    return len(channel) > 0 and np.dtype(channel.dtype).kind in "fiub"


def _rate_notes(waves: list[Any]) -> tuple[str, ...]:
    increments = sorted({float(wave["wf_increment"]) for wave in waves})
    if len(increments) < 2:  # noqa: PLR2004
        return ()
    return (f"channels have sampling intervals of {increments} s; the first channel's was taken for all",)


def _channel(item: Any, number: int, grouped: bool) -> Channel:
    name = f"{item.group_name}/{item.name}" if grouped else item.name
    unit = str(item.properties.get("unit_string", item.properties.get("NI_UnitDescription", "")))
    return Channel(name, number, unit, str(item.properties.get("quantity", "")) or None, len(item))


def _reader(item: Any) -> Reader:
    def read(first: int, last: int) -> FloatArray:
        return np.asarray(item.read_data(offset=first, length=last - first), dtype=float)

    return read


def write(recording: Recording, path: Path) -> None:
    """A TDMS file of one group, with waveform properties and units."""
    checked_names(recording)
    nptdms = needed("tdms")
    root = nptdms.RootObject({"name": recording.title or path.stem, KEY: stored(recording)})
    common = {"wf_increment": 1 / recording.sampling_rate, "wf_start_offset": recording.start}
    with replacing(path) as temporary, nptdms.TdmsWriter(str(temporary)) as writer:
        writer.write_segment([root, nptdms.GroupObject(GROUP)])
        for first in range(0, len(recording), PIECE):
            part = slice(first, first + PIECE)
            items = [
                nptdms.ChannelObject(
                    GROUP, signal.name, signal.values[part],
                    {**common, "unit_string": signal.unit, "quantity": signal.quantity},
                )
                for signal in recording
            ]  # fmt: skip
            if recording.times is not None:
                items.append(nptdms.ChannelObject(GROUP, TIME, recording.times[part], {"unit_string": "s"}))
            writer.write_segment(items)
