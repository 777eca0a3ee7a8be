"""What an NPZ file says that it holds, against what is there, before anything is unpacked."""

from __future__ import annotations

import zipfile
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.core.errors import Fault, ModelError
from torsionnet.io.foreign import ForeignFileError, resource_limits

ENDING = ".npy"


@dataclass(frozen=True)
class Header:
    """Shape and type of an array, and where its values begin."""

    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    offset: int


def checked_headers(archive: zipfile.ZipFile, path: Path) -> dict[str, Header]:
    """The headers by name.

    Raises
    ------
    ModelError
        Arrays of Python objects, and arrays that claim more or less than there is.
    ForeignFileError
        Everything together would unpack to more than a file of its size may.
    """
    entries = [entry for entry in archive.infolist() if entry.filename.endswith(ENDING)]
    resource_limits.check(sum(entry.file_size for entry in entries), path)
    headers, faults = {}, []
    for entry in entries:
        name = entry.filename.removesuffix(ENDING)
        if name in headers:
            faults.append(f"{name} is there twice")
        header = headers[name] = _header(archive, entry)
        claimed = header.offset + header.dtype.itemsize * prod(header.shape)
        if header.dtype.hasobject:
            faults.append(f"{name} holds Python objects, which are not unpacked; save numbers")
        elif claimed != entry.file_size:
            text = f"{name} says that it takes {claimed} bytes, there are {entry.file_size}"
            faults.append(f"{text}; the file is damaged or ends early")
    if faults:
        raise ModelError([Fault(text) for text in faults], path.name)
    return headers


def _header(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> Header:
    with archive.open(entry) as file:
        version = np.lib.format.read_magic(file)
        read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _fortran, dtype = read(file)
        if any(size < 0 for size in shape):
            raise ForeignFileError(f"{entry.filename} has the shape {shape}")
        return Header(shape, dtype, file.tell())


def loaded(archive: zipfile.ZipFile, name: str) -> Any:
    """A whole array, whose header was checked."""
    with archive.open(f"{name}{ENDING}") as file:
        return np.load(file, allow_pickle=False)
