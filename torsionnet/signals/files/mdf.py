"""MDF4 files, through asammdf, which reads the channels asked for as a whole."""

from __future__ import annotations

import contextlib
import html
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.atomic import replacing
from torsionnet.signals.files.extras import needed
from torsionnet.signals.files.source import Channel, Source, reader_of, sliced
from torsionnet.signals.files.stored import checked_names, stored, with_stored
from torsionnet.signals.recording import Recording


@contextlib.contextmanager
def opened(path: Path) -> Iterator[Source]:
    """An MDF file; the time stamps are those of the first channel."""
    asammdf = needed("mdf")
    with asammdf.MDF(path) as file:
        signals = [signal for signal in file.iter_channels() if signal.samples.dtype.kind in "fiub"]
        text = html.unescape(str(file.header.comment))  # it is wrapped in XML
        channels = [Channel(s.name, number, s.unit or "", length=len(s)) for number, s in enumerate(signals)]
        arrays = [np.asarray(signal.samples, dtype=float) for signal in signals]
        if signals:
            arrays.append(np.asarray(signals[0].timestamps, dtype=float))
            channels.append(Channel("time", len(signals), "s", length=len(arrays[-1])))
        source = Source(tuple(channels), sliced([*map(reader_of, arrays)], [*map(len, arrays)]), title=path.stem)
        found = text[text.find("{") : text.rfind("}") + 1]
        yield with_stored(source, found) if '"sampling_rate"' in found else source.with_time_found()


def write(recording: Recording, path: Path) -> None:
    """An MDF4 file of one channel for every signal."""
    checked_names(recording, with_time=True)
    asammdf: Any = needed("mdf")
    signals = [
        asammdf.Signal(samples=np.asarray(s.values), timestamps=recording.time, name=s.name, unit=s.unit)
        for s in recording
    ]
    with replacing(path) as temporary, asammdf.MDF(version="4.10") as file:
        file.append(signals, comment=recording.title)
        file.header.comment = stored(recording, with_time=True)
        file.save(temporary, overwrite=True)
