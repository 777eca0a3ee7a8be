"""HDF5 files, and MAT v7.3 files, which are HDF5: every dataset of numbers is a channel."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from torsionnet.core.atomic import write_bytes
from torsionnet.io.foreign import opening
from torsionnet.io.records.arrays import content_source
from torsionnet.io.records.extras import needed, require
from torsionnet.io.records.source import Source
from torsionnet.io.records.stored import KEY, TIME, checked_names, plain_keys, stored
from torsionnet.response.recording import FloatArray, Recording

CHUNK = 65536
RATES = ("sampling_rate", "fs", "sample_rate")


@contextlib.contextmanager
def opened(path: Path) -> Iterator[Source]:
    """An HDF5 file; units are taken from attributes of the datasets."""
    require("hdf5")
    with opening.opened(path, "hdf5") as content:
        source = content_source(content, str(content.attributes.get(KEY, "")), path.stem)
        rates = [float(content.attributes[name] or 0) for name in RATES if name in content.attributes]
        yield source if source.rate or not rates else replace(source, rate=rates[0])


def write(recording: Recording, path: Path) -> None:
    """An HDF5 file of one dataset for every signal, with unit and quantity as attributes."""
    checked_names(recording)
    h5py = needed("hdf5")
    keys = plain_keys(recording.names, r"[/.\0]")
    # Made in memory: on a full disk the library crashes.
    image = io.BytesIO()
    with h5py.File(image, "w", track_order=True) as file:
        file.attrs[KEY] = stored(recording, keys)
        file.attrs["sampling_rate"], file.attrs["start"] = recording.sampling_rate, recording.start
        for key, signal in zip(keys, recording, strict=True):
            item = _filled(file, key, signal.values)
            item.attrs["unit"], item.attrs["quantity"] = signal.unit, signal.quantity
        if recording.times is not None:
            _filled(file, TIME, recording.times).attrs["unit"] = "s"
    write_bytes(path, image.getbuffer())


def _filled(file: Any, name: str, values: FloatArray) -> Any:
    item = file.create_dataset(name, shape=values.shape, dtype="f8", chunks=(CHUNK,) if len(values) > CHUNK else None)
    for first in range(0, len(values), 16 * CHUNK):
        item[first : first + 16 * CHUNK] = values[first : first + 16 * CHUNK]
    return item
