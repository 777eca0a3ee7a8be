"""Reading of MAT v4 and v5 files through scipy, with numbers, also those in structures, and texts.

What a file says that it holds is checked against its size before anything is unpacked.
"""

from __future__ import annotations

import contextlib
import zlib
from collections.abc import Iterator
from math import prod
from pathlib import Path
from struct import Struct, error
from typing import Any, BinaryIO

import torsionnet.signals.foreign.content as resource_limits
from torsionnet.signals.foreign.content import COMPLEX, ROW, Content, ForeignFileError, Plain, memory_content

MOST_STRUCTURES = 64
"""Most entries of an array of structures in a MAT file that are read, each of which becomes channels of its own."""


HEADER_BYTES = 128
"""Number of bytes of the header of a MAT v5 file."""
COMPRESSED, MATRIX = 15, 14
"""Types of data elements of a MAT v5 file, a compressed variable, and an array."""
ENTRY_CLASSES = frozenset({1, 2})
"""Array classes cell and structure of a MAT v5 file, of which every entry takes a tag of 8 bytes."""
SPARSE_CLASS = 5
"""Array class of sparse matrices in a MAT v5 file, whose dimensions may be larger than its data."""
PREVIEW_BYTES = 4096
"""Number of bytes that are unpacked of a compressed variable to read its size and dimensions."""
V4_SIZES = (8, 4, 4, 2, 2, 1)
"""Number of bytes of a number in a MAT v4 file by the digit P of its type."""
_TOO_MUCH = "says that it holds more than there is; the file is damaged or ends early"


def load() -> None:
    """Import scipy.io for MAT files before the limits of memory and time begin."""
    import scipy.io  # noqa: F401


@contextlib.contextmanager
def open_content(path: Path) -> Iterator[Content]:
    """Yield all variables of a MAT file, fields of structures being named ``structure.field``."""
    from scipy.io import loadmat

    _check_claims(path)
    content: dict[str, Any] = loadmat(str(path), squeeze_me=False, simplify_cells=False)
    arrays: list[tuple[str, Any, dict[str, Plain]]] = []
    texts: dict[str, Plain] = {}
    others = []
    for name, value in content.items():
        if name.startswith("__"):
            continue
        members = list(_members(name, value))
        arrays += [(key, *_column(numbers)) for key, numbers in members if numbers.dtype.kind != "U"]
        texts |= {key: "".join(text.ravel()[:1]) for key, text in members if text.dtype.kind == "U"}
        others += [name] if not members and int(getattr(value, "size", 0)) else []
    yield memory_content(arrays, texts, others)


def _column(values: Any) -> tuple[Any, dict[str, Plain]]:
    is_row = values.ndim == 2 and values.shape[0] == 1
    given: dict[str, Plain] = {COMPLEX: True} if values.dtype.kind == "c" else {}
    return (values.reshape(-1, 1) if is_row else values), given | ({ROW: True} if is_row else {})


def _members(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    kind = getattr(getattr(value, "dtype", None), "kind", "")
    if kind == "V" and value.dtype.names:
        entries = value.ravel()[:MOST_STRUCTURES]
        for number, entry in enumerate(entries, 1):
            label = name if len(entries) == 1 else f"{name}{number}"
            for key in value.dtype.names:
                yield from _members(f"{label}.{key}", entry[key])
    elif kind == "O" and "." in name:  # cells in a structure: their texts, such as the names of channels
        for number, cell in enumerate(value.ravel()[:MOST_STRUCTURES], 1):
            if getattr(getattr(cell, "dtype", None), "kind", "") == "U":
                yield f"{name}{{{number}}}", cell
    elif kind and kind in "fiubcU" and value.size:
        yield name, value


def _check_claims(path: Path) -> None:
    """Refuse a MAT file of which a variable claims more than the file holds, or more than a file may unpack to."""
    size = path.stat().st_size
    with path.open("rb") as file:
        start = file.read(HEADER_BYTES)
        mark = start[126:128]
        if len(start) < HEADER_BYTES or 0 in start[:4]:
            _check_v4(file, size)
            return
        if mark in (b"IM", b"MI"):
            total = sum(_elements(file, "<" if mark == b"IM" else ">", size))
            resource_limits.check(total, path)


def _elements(file: BinaryIO, order: str, size: int) -> Iterator[int]:
    """Yield the unpacked size in bytes of every variable of a MAT v5 file, in the order of the file."""
    pair, at, number = Struct(f"{order}II"), HEADER_BYTES, 0
    while at + pair.size <= size:
        number += 1
        file.seek(at)
        kind, length = pair.unpack(file.read(pair.size))
        if length > size - at - pair.size:
            raise ForeignFileError(f"variable {number} {_TOO_MUCH}")
        start = file.read(min(length, PREVIEW_BYTES))
        if kind == COMPRESSED:
            start = zlib.decompressobj().decompress(start, PREVIEW_BYTES)
            if len(start) < pair.size:
                raise ForeignFileError(f"variable {number} cannot be unpacked; the file is damaged")
            kind, unpacked = pair.unpack(start[: pair.size])
            start = start[pair.size :]
        else:
            unpacked = length
        if kind == MATRIX:
            _check_dimensions(start, order, unpacked, number)
        yield unpacked
        at += pair.size + length


def _check_dimensions(start: bytes, order: str, length: int, number: int) -> None:
    """Refuse a variable of a MAT file that is smaller than its dimensions need, a byte an entry, or a tag."""
    try:
        _, _, flags, _, _, count = Struct(f"{order}6I").unpack_from(start)
        dimensions = Struct(f"{order}{min(count // 4, 32)}i").unpack_from(start, 24)
    except error:
        return  # of something else; the library has its own words
    kind = flags & 0xFF
    least = 0 if kind == SPARSE_CLASS else 8 if kind in ENTRY_CLASSES else 1
    if least * prod(dimensions) > length:
        raise ForeignFileError(f"variable {number} {_TOO_MUCH}")


def _check_v4(file: BinaryIO, size: int) -> None:
    at, number = 0, 0
    while at < size:
        number += 1
        file.seek(at)
        start = file.read(20)
        if len(start) < 20:
            raise ForeignFileError(f"variable {number} {_TOO_MUCH}")
        order = "<" if 0 <= Struct("<i").unpack_from(start)[0] <= 5000 else ">"
        kind, rows, columns, imaginary, letters = Struct(f"{order}5i").unpack(start)
        precision = kind // 10 % 10
        if not (0 <= kind <= 5000 and precision < len(V4_SIZES) and min(rows, columns, letters) >= 0):
            raise ForeignFileError("this is no MAT file, or a damaged one")
        at += 20 + letters + rows * columns * V4_SIZES[precision] * (2 if imaginary else 1)
        if at > size:
            raise ForeignFileError(f"variable {number} {_TOO_MUCH}")
