"""Recordings in HDF5 files, and in MAT v7.3 files, which are HDF5, with every dataset of numbers as a channel."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from torsionnet.base.atomic import write_bytes
from torsionnet.signals.formats.extras import import_extra, open_foreign
from torsionnet.signals.recording import Recording
from torsionnet.signals.records.arrays import array_source, with_left_out
from torsionnet.signals.records.exported_structures import structured_source, unknown_structures
from torsionnet.signals.records.source import (
    KEY,
    Source,
    channel_names,
    plain_keys,
    recording_json,
    saved_columns,
)
from torsionnet.signals.response_description import refuse_response

CHUNK_LENGTH = 65536
"""Samples of a chunk of an HDF5 dataset, 0.5 MB, so that parts of a long recording can be read without the rest."""


@contextlib.contextmanager
def open_source(path: Path) -> Iterator[Source]:
    """Yield the channels of an HDF5 file, with units from attributes of the datasets."""
    with open_foreign(path, "hdf5") as content:
        text = str(content.attributes.get(KEY, ""))
        known = None if text else structured_source(content.arrays, content.blocks, content.attributes, path.stem)
        if not (text or known):
            refuse_response(content.arrays)
        hint = "" if text else unknown_structures(content.arrays)
        given = content.arrays, content.blocks, text, path.stem, content.attributes
        yield known or with_left_out(replace(array_source(*given), hint=hint), content.others)


def write(recording: Recording, path: Path) -> None:
    """Write an HDF5 file of one dataset in SI for every signal, with unit and quantity as attributes."""
    keys = plain_keys(channel_names(recording), r"[/.\0]")
    columns = saved_columns(recording, keys)
    h5py = import_extra("hdf5")
    # Made in memory: on a full disk the library crashes.
    image = io.BytesIO()
    with h5py.File(image, "w", track_order=True) as file:
        file.attrs[KEY] = recording_json(recording, keys)
        file.attrs["sampling_rate"], file.attrs["start"] = recording.sampling_rate, recording.start
        for column in columns:
            length = len(column.values)
            chunks = (CHUNK_LENGTH,) if length > CHUNK_LENGTH else None
            item = file.create_dataset(column.name, shape=column.values.shape, dtype="f8", chunks=chunks)
            for first in range(0, length, 16 * CHUNK_LENGTH):
                item[first : first + 16 * CHUNK_LENGTH] = column.values[first : first + 16 * CHUNK_LENGTH]
            item.attrs.update(column.attributes)
    write_bytes(path, image.getbuffer())
