"""NPZ files of numpy, read member by member in blocks: a large file never has to fit into memory."""

from __future__ import annotations

import contextlib
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.atomic import replacing
from torsionnet.signals.files.arrays import Member, array_member, array_source
from torsionnet.signals.files.source import Source
from torsionnet.signals.files.stored import KEY, TIME, checked_names, stored
from torsionnet.signals.recording import FloatArray, Recording


class _Stream:
    """Reads a one-dimensional member front to back."""

    def __init__(self, archive: zipfile.ZipFile, entry: str, dtype: np.dtype[Any], header: int) -> None:
        self.file, self.at = archive.open(entry), 0
        self.dtype, self.header = dtype, header
        self.file.read(header)

    def __call__(self, first: int, last: int) -> FloatArray:
        if first != self.at:
            self.file.seek(self.header + first * self.dtype.itemsize)
        data = self.file.read((last - first) * self.dtype.itemsize)
        self.at = last
        return np.frombuffer(data, dtype=self.dtype).astype(float, copy=False)


@contextlib.contextmanager
def opened(path: Path) -> Iterator[Source]:
    """An NPZ file: every numeric array is a channel, or one for every column."""
    with zipfile.ZipFile(path) as archive:
        entries = [entry for entry in archive.namelist() if entry.endswith(".npy")]
        text = str(np.load(archive.open(f"{KEY}.npy"), allow_pickle=False)) if f"{KEY}.npy" in entries else ""
        members = [_member(archive, entry) for entry in entries if entry != f"{KEY}.npy"]
        yield array_source([member for member in members if member], text, path.stem)


def _member(archive: zipfile.ZipFile, entry: str) -> Member | None:
    name = entry.removesuffix(".npy")
    with archive.open(entry) as file:
        version = np.lib.format.read_magic(file)
        read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _fortran, dtype = read(file)
        header = file.tell()
    if dtype.kind not in "fiub" or len(shape) > 2:  # noqa: PLR2004
        return None
    if len(shape) == 1:
        return Member(name, (shape[0], 1), _Stream(archive, entry, dtype, header))
    with archive.open(entry) as file:
        return array_member(name, np.load(file, allow_pickle=False))


def write(recording: Recording, path: Path) -> None:
    """An NPZ file of one array for every signal, with a description of the recording."""
    checked_names(recording)
    arrays: dict[str, Any] = {signal.name: signal.values for signal in recording}
    if recording.times is not None:
        arrays[TIME] = recording.times
    # Not np.savez: it takes names as keyword arguments, of which "file" is one of its own.
    with replacing(path) as temporary, zipfile.ZipFile(temporary, "w", allowZip64=True) as archive:
        for name, values in [*arrays.items(), (KEY, np.array(stored(recording)))]:
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, np.asanyarray(values), allow_pickle=False)
