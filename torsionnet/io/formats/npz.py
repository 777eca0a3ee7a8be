"""NPZ files of numpy, read member by member in blocks: a large file never has to fit into memory."""

from __future__ import annotations

import contextlib
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.core.atomic import replacing
from torsionnet.io.foreign.content import Slice, Stored, sliced
from torsionnet.io.formats.npz_headers import ENDING, Header, checked_headers, loaded
from torsionnet.io.records.arrays import array_source
from torsionnet.io.records.source import Source
from torsionnet.io.records.stored import KEY, saved_columns, stored
from torsionnet.io.responses import described
from torsionnet.response import FrequencyResponse
from torsionnet.response.recording import FloatArray, Recording


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
    # An archive keeps its file open for as long as one of its members is.
    with zipfile.ZipFile(path) as archive, contextlib.ExitStack() as members:
        headers = checked_headers(archive, path)
        text = str(loaded(archive, KEY)) if KEY in headers else ""
        found = [_member(archive, name, header, members) for name, header in headers.items() if name != KEY]
        kept = [pair for pair in found if pair]
        blocks = sliced([read for _, read in kept], [member.length for member, _ in kept])
        yield array_source([member for member, _ in kept], blocks, text, path.stem)


def _member(
    archive: zipfile.ZipFile, name: str, header: Header, members: contextlib.ExitStack
) -> tuple[Stored, Slice] | None:
    if header.dtype.kind not in "fiub" or len(header.shape) > 2:
        return None
    if len(header.shape) == 1 and header.shape[0] != 1:
        stream = _Stream(archive, f"{name}{ENDING}", header.dtype, header.offset)
        members.callback(stream.file.close)
        return Stored(name, header.shape), stream
    values = loaded(archive, name)
    columns = values.reshape(-1, 1) if values.ndim < 2 or 1 in values.shape else values
    value = float(columns.ravel()[0]) if columns.size == 1 else None
    return Stored(name, columns.shape, value=value), lambda first, last: columns[first:last]


def write(recording: Recording, path: Path) -> None:
    """An NPZ file of one array for every signal, with a description of the recording."""
    arrays = {column.name: column.values for column in saved_columns(recording)}
    _write({**arrays, KEY: stored(recording)}, path)


def read_response(path: Path) -> FrequencyResponse:
    """The response in an NPZ file of :func:`write_response`."""
    with zipfile.ZipFile(path) as archive:
        there = checked_headers(archive, path)
        described.check_members(there, path, "archive", "is empty")
        numbers = {name: loaded(archive, name) for name in described.NUMBERS if name in there}
        return described.described(str(loaded(archive, described.KEY)), numbers)


def write_response(response: FrequencyResponse, path: Path) -> None:
    """An archive of arrays; equal responses give equal bytes."""
    _write({**described.arrays(response), described.KEY: described.description(response)}, path)


def _write(arrays: Mapping[str, Any], path: Path) -> None:
    # Not np.savez: it takes names as keyword arguments, of which "file" is one of its own.
    with replacing(path) as temporary, zipfile.ZipFile(temporary, "w", allowZip64=True) as archive:
        for name, values in arrays.items():
            with archive.open(f"{name}{ENDING}", "w", force_zip64=True) as member:  # dated 1980, not today
                np.lib.format.write_array(member, np.asanyarray(values), allow_pickle=False)
