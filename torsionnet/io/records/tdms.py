"""TDMS files of LabVIEW, through npTDMS."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from torsionnet.core.atomic import replacing
from torsionnet.io.foreign import Stored, opening
from torsionnet.io.foreign.content import Plain
from torsionnet.io.records.extras import needed, require
from torsionnet.io.records.source import FileChannel, Source
from torsionnet.io.records.stored import KEY, TIME, checked_names, stored, with_stored
from torsionnet.response.recording import Recording

GROUP, PIECE, INCREMENT = "recording", 1 << 20, "wf_increment"


@contextlib.contextmanager
def opened(path: Path) -> Iterator[Source]:
    """A TDMS file; rate and start are those of the waveform properties."""
    require("tdms")
    with opening.opened(path, "tdms") as content:
        channels = [_channel(item, number) for number, item in enumerate(content.arrays)]
        waves = [item.attributes for item in content.arrays if item.attributes.get(INCREMENT)]
        rate = 1 / float(waves[0][INCREMENT] or 0) if waves else None
        start = float(waves[0].get("wf_start_offset") or 0.0) if waves else 0.0
        title = str(content.attributes.get("name", path.stem))
        notes = _rate_notes(waves)
        source = Source(tuple(channels), content.blocks, rate=rate, start=start, title=title, notes=notes)
        text = str(content.attributes.get(KEY, ""))
        yield with_stored(source, text) if text else source if waves else source.with_time_found()


def _rate_notes(waves: Sequence[Mapping[str, Plain]]) -> tuple[str, ...]:
    increments = sorted({float(wave[INCREMENT] or 0) for wave in waves})
    if len(increments) < 2:
        return ()
    return (f"channels have sampling intervals of {increments} s; the first channel's was taken for all",)


def _channel(item: Stored, number: int) -> FileChannel:
    given = item.attributes
    name = f"{given['group']}/{item.name}" if "group" in given else item.name
    unit = str(given.get("unit_string", given.get("NI_UnitDescription", "")))
    return FileChannel(name, number, unit, str(given.get("quantity", "")) or None, item.length)


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
