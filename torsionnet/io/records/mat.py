"""MAT files: v5 through scipy, v7.3, which is HDF5, through h5py."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import torsionnet.io.records.hdf5 as hdf5
from torsionnet.core.atomic import replacing
from torsionnet.core.errors import UsageError
from torsionnet.io.foreign import opening
from torsionnet.io.records.arrays import content_source
from torsionnet.io.records.source import Source
from torsionnet.io.records.stored import KEY, TIME, checked_names, plain_keys, stored
from torsionnet.response.recording import Recording

LONGEST_NAME = 63
LARGEST = 2**31  # bytes of one variable
SIGNATURE = b"\x89HDF\r\n\x1a\n"


@contextlib.contextmanager
def opened(path: Path) -> Iterator[Source]:
    """A MAT file; numeric variables, and fields of structures, are channels."""
    if _is_hdf5(path):
        with hdf5.opened(path) as source:
            yield source
        return
    with opening.opened(path, "mat") as content:
        yield content_source(content, str(content.attributes.get(KEY, "")), path.stem)


def _is_hdf5(path: Path) -> bool:
    with path.open("rb") as file:
        start = file.read(len(SIGNATURE))
        file.seek(512)  # MATLAB puts its own header of 512 bytes first
        return SIGNATURE in (start, file.read(len(SIGNATURE)))


def write(recording: Recording, path: Path) -> None:
    """A MAT v5 file of one column for every signal, with a description of the recording."""
    from scipy.io import savemat

    checked_names(recording)
    keys = plain_keys(recording.names, "[^A-Za-z0-9_]|^(?=[^A-Za-z])", (TIME, KEY))
    if any(len(key) > LONGEST_NAME for key in keys) or 8 * len(recording) >= LARGEST:
        raise UsageError(
            "a MAT v5 file takes names of 63 characters and 2 GB for each signal; write an .h5 or .npz file"
        )
    keys = [f"x{key}" if key.startswith("_") else key for key in keys]
    content: dict[str, Any] = dict(zip(keys, (signal.values for signal in recording), strict=True))
    if recording.times is not None:
        content[TIME] = recording.times
    with replacing(path) as temporary:
        savemat(str(temporary), {**content, KEY: stored(recording, keys)}, oned_as="column", long_field_names=True)
