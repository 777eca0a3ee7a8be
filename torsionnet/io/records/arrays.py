"""Channels and sampling rate of files that hold named arrays (NPZ, MAT, HDF5)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from torsionnet.core.plain_names import free_name
from torsionnet.io.foreign import StoredArray
from torsionnet.io.foreign.content import COMPLEX, UNIT_NAMES, Blocks
from torsionnet.io.records.recording_description import with_description
from torsionnet.io.records.source import FileChannel, Source, names_a_rate
from torsionnet.response.recording import FloatArray

MOST_COLUMNS = 256
"""Most columns of an array that are taken for channels, as more make a picture, or a matrix of something else."""


def array_source(arrays: Sequence[StoredArray], blocks: Blocks, stored: str, title: str) -> Source:
    """Channels and sampling rate in Hz of a recording from named arrays.

    A number named ``fs`` or the like is the rate, other single numbers are left out.

    ``blocks`` knows the arrays by their place in ``arrays``.
    """
    channels, places, notes, rate = list[FileChannel](), list[tuple[int, int]](), list[str](), None
    for number, item in enumerate(arrays):
        if len(item.shape) > 2 or item.attributes.get(COMPLEX):
            continue
        rows, columns = (*item.shape, 1, 1)[:2]
        if rows == columns == 1 and not stored:
            is_rate = names_a_rate(item.name)
            rate = item.value if is_rate else rate
            what = "was taken for the sampling rate" if is_rate else "is a single number, no channel"
            notes.append(f"{item.name} {what}")
        elif columns > MOST_COLUMNS:
            notes.append(f"{item.name} was left out: {rows} by {columns} numbers are no channels")
        else:
            for column in range(columns):
                name = item.name if columns == 1 else f"{item.name}_{column + 1}"
                channels.append(channel_of(item, len(channels), name, attribute_text(item, *UNIT_NAMES)))
                places.append((number, column))
    source = Source(tuple(channels), by_column(blocks, places), rate=rate, title=title, notes=tuple(notes))
    return with_description(source, stored)


def by_column(blocks: Blocks, places: Sequence[tuple[int, int]]) -> Blocks:
    """Reader of blocks of columns from a reader of blocks of arrays, each of which is read once."""

    def columns_of(columns: Sequence[int], count: int) -> Iterator[list[FloatArray]]:
        wanted = [places[column] for column in columns]
        numbers = list(dict.fromkeys(number for number, _ in wanted))
        for block in blocks(numbers, count):
            found = dict(zip(numbers, block, strict=True))
            yield [_column(found[number], column) for number, column in wanted]

    return columns_of


def _column(block: FloatArray, column: int) -> FloatArray:
    return np.asarray(block if block.ndim == 1 else block[:, column], dtype=float)


def channel_of(item: StoredArray, number: int, name: str, unit: str) -> FileChannel:
    """Channel of an array in a file, of the quantity that the array has as an attribute."""
    return FileChannel(name, number, unit, attribute_text(item, "quantity") or None, item.length)


def told_apart(names: Sequence[str], longer: Sequence[str]) -> list[str]:
    """Names of channels, of which equal ones are replaced by ``longer`` ones, with numbers where these are equal, too.

    >>> told_apart(["T", "w", "T", "T"], ["1/T", "1/w", "2/T", "2/T"])
    ['1/T', 'w', '2/T', '2/T_2']
    """
    found: list[str] = []
    for name, other in zip(names, longer, strict=True):
        found.append(name if names.count(name) == 1 else free_name(other, {*found, *names}))
    return found


def attribute_text(item: StoredArray, *names: str) -> str:
    """Text of the first of these attributes that an array in a file has, empty where it has none."""
    return next((str(item.attributes[name]) for name in names if name in item.attributes), "")
