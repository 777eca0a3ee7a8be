"""Recordings and frequency responses in NPZ files of numpy, read in blocks, so that a file need not fit into memory.

What a file says that it holds is checked against what is there before anything is unpacked.
"""

from __future__ import annotations

import contextlib
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.base.atomic import atomic_replacement
from torsionnet.base.errors import Fault, ModelError
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.signals import response_description
from torsionnet.signals.foreign import ForeignFileError
from torsionnet.signals.foreign import content as resource_limits
from torsionnet.signals.foreign.content import Slice, StoredArray, sliced_blocks
from torsionnet.signals.recording import FloatArray, Recording
from torsionnet.signals.records.arrays import array_source, with_left_out
from torsionnet.signals.records.source import KEY, Source, recording_json, saved_columns

ARRAY_ENDING = ".npy"
"""Ending of an array's name in the archive that an NPZ file is."""


class _Stream:
    """Reader of a one-dimensional array of an NPZ file from front to back."""

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
def open_source(path: Path) -> Iterator[Source]:
    """Yield the channels of an NPZ file, every numeric array, or every column of the array."""
    # An archive keeps its file open for as long as one of its members is.
    with zipfile.ZipFile(path) as archive, contextlib.ExitStack() as members:
        headers = _checked_headers(archive, path)
        text = str(_loaded(archive, KEY)) if KEY in headers else ""
        pairs = [_member(archive, name, header, members) for name, header in headers.items() if name != KEY]
        kept = [pair for pair in pairs if pair]
        blocks = sliced_blocks([read for _, read in kept], [member.length for member, _ in kept])
        left = [
            name for name, pair in zip((member for member in headers if member != KEY), pairs, strict=True) if not pair
        ]
        yield with_left_out(array_source([member for member, _ in kept], blocks, text, path.stem), left)


def _member(
    archive: zipfile.ZipFile, name: str, header: Header, members: contextlib.ExitStack
) -> tuple[StoredArray, Slice] | None:
    if header.dtype.kind not in "fiub" or len(header.shape) > 2:
        return None
    if len(header.shape) == 1 and header.shape[0] != 1:
        stream = _Stream(archive, f"{name}{ARRAY_ENDING}", header.dtype, header.offset)
        members.callback(stream.file.close)
        return StoredArray(name, header.shape), stream
    values = _loaded(archive, name)
    columns = values.reshape(-1, 1) if values.ndim < 2 or 1 in values.shape else values
    value = float(columns.ravel()[0]) if columns.size == 1 else None
    return StoredArray(name, columns.shape, value=value), lambda first, last: columns[first:last]


def write(recording: Recording, path: Path) -> None:
    """Write an NPZ file of one array in SI for every signal, with a description of the recording."""
    arrays = {column.name: column.values for column in saved_columns(recording)}
    _write({**arrays, KEY: recording_json(recording)}, path)


def read_response(path: Path) -> FrequencyResponse:
    """Frequency response in SI from an NPZ file that :func:`write_response` has written."""
    with zipfile.ZipFile(path) as archive:
        there = _checked_headers(archive, path)
        response_description.check_members(there, path, "archive", "is empty")
        numbers = {name: _loaded(archive, name) for name in response_description.NUMBERS if name in there}
        return response_description.response_from(str(_loaded(archive, response_description.KEY)), numbers)


def write_response(response: FrequencyResponse, path: Path) -> None:
    """Write an NPZ file of the arrays of a frequency response in SI; equal responses give equal bytes."""
    _write(
        {**response_description.arrays(response), response_description.KEY: response_description.description(response)},
        path,
    )


def _write(arrays: Mapping[str, Any], path: Path) -> None:
    # Not np.savez: it takes names as keyword arguments, of which "file" is one of its own.
    with atomic_replacement(path) as temporary, zipfile.ZipFile(temporary, "w", allowZip64=True) as archive:
        for name, values in arrays.items():
            with archive.open(f"{name}{ARRAY_ENDING}", "w", force_zip64=True) as member:  # dated 1980, not today
                np.lib.format.write_array(member, np.asanyarray(values), allow_pickle=False)


@dataclass(frozen=True)
class Header:
    """Shape and type of an array of an NPZ file, and the offset of its values in bytes."""

    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    offset: int


def _checked_headers(archive: zipfile.ZipFile, path: Path) -> dict[str, Header]:
    """Headers of the arrays of an NPZ file by name, checked against the sizes in the archive.

    Raises
    ------
    ModelError
        Arrays of Python objects, and arrays that claim more or less than there is.
    ForeignFileError
        Everything together would unpack to more than a file of its size may.
    """
    entries = [entry for entry in archive.infolist() if entry.filename.endswith(ARRAY_ENDING)]
    resource_limits.check(sum(entry.file_size for entry in entries), path)
    headers, faults = {}, []
    for entry in entries:
        name = entry.filename.removesuffix(ARRAY_ENDING)
        if name in headers:
            faults.append(f"{name} is in the archive twice")
        header = headers[name] = _header(archive, entry)
        claimed = header.offset + header.dtype.itemsize * prod(header.shape)
        if header.dtype.hasobject:
            faults.append(f"{name} holds Python objects, which are not unpacked; save numbers")
        elif claimed != entry.file_size:
            text = f"{name} says that it takes {claimed} bytes, there are {entry.file_size}"
            faults.append(f"{text}; the file is damaged or ends early")
    if faults:
        raise ModelError([Fault(text, kind="unreadable-file") for text in faults], path.name)
    return headers


def _header(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> Header:
    with archive.open(entry) as file:
        version = np.lib.format.read_magic(file)
        read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _fortran, dtype = read(file)
        if any(size < 0 for size in shape):
            raise ForeignFileError(f"{entry.filename} has a negative size in its shape {shape}; the file is damaged")
        return Header(shape, dtype, file.tell())


def _loaded(archive: zipfile.ZipFile, name: str) -> Any:
    """Whole array of an NPZ file, whose header was checked."""
    with archive.open(f"{name}{ARRAY_ENDING}") as file:
        return np.load(file, allow_pickle=False)
