"""Files of named arrays (NPZ, MAT, HDF5): which arrays are channels, and which number is the sampling rate."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from torsionnet.io.foreign import Content, Stored
from torsionnet.io.foreign.content import COMPLEX
from torsionnet.io.records.source import Blocks, FileChannel, Source, names_a_rate
from torsionnet.io.records.stored import with_stored
from torsionnet.response.recording import FloatArray

MOST_COLUMNS = 256  # more make a picture or a matrix of something else
UNIT_NAMES = ("unit", "units", "Unit", "Units", "unit_string")


@dataclass(frozen=True)
class ArrayMember:
    """One array of a file; ``shape`` is (samples, columns), ``value`` that of a single number."""

    name: str
    shape: tuple[int, int]
    unit: str = ""
    quantity: str = ""
    value: float | None = None


def array_source(members: Sequence[ArrayMember], blocks: Blocks, stored: str, title: str) -> Source:
    """Source of named arrays: a number named ``fs`` or the like is the rate, other single numbers are passed over.

    ``blocks`` knows the arrays by their place in ``members``.
    """
    channels, places, notes, rate = list[FileChannel](), list[tuple[int, int]](), list[str](), None
    for number, member in enumerate(members):
        if member.shape == (1, 1) and not stored:
            is_rate = names_a_rate(member.name)
            rate = member.value if is_rate else rate
            what = "was taken for the sampling rate" if is_rate else "is a single number, no channel"
            notes.append(f"{member.name} {what}")
        elif member.shape[1] > MOST_COLUMNS:
            notes.append(f"{member.name} was left out: {member.shape[0]} by {member.shape[1]} numbers are no channels")
        else:
            for column in range(member.shape[1]):
                channels.append(_channel(member, column, len(channels)))
                places.append((number, column))
    source = Source(tuple(channels), _by_column(blocks, places), rate=rate, title=title, notes=tuple(notes))
    return with_stored(source, stored) if stored else source.with_time_found()


def _by_column(blocks: Blocks, places: Sequence[tuple[int, int]]) -> Blocks:
    """Blocks of columns out of blocks of arrays, each of which is read once."""

    def columns_of(columns: Sequence[int], count: int) -> Iterator[list[FloatArray]]:
        wanted = [places[column] for column in columns]
        numbers = list(dict.fromkeys(number for number, _ in wanted))
        for block in blocks(numbers, count):
            found = dict(zip(numbers, block, strict=True))
            yield [_column(found[number], column) for number, column in wanted]

    return columns_of


def _column(block: FloatArray, column: int) -> FloatArray:
    return np.asarray(block if block.ndim == 1 else block[:, column], dtype=float)


def content_source(content: Content, stored: str, title: str) -> Source:
    """Source of the arrays of a file of another program."""
    kept = [(number, item) for number, item in enumerate(content.arrays) if _is_channel(item)]
    numbers = [number for number, _ in kept]
    members = [
        ArrayMember(item.name, _shape(item.shape), _word(item, UNIT_NAMES), _word(item, ("quantity",)), item.value)
        for _, item in kept
    ]
    return array_source(
        members, lambda asked, count: content.blocks([numbers[at] for at in asked], count), stored, title
    )


def _is_channel(item: Stored) -> bool:
    return len(item.shape) <= 2 and not item.attributes.get(COMPLEX)


def _shape(shape: Sequence[int]) -> tuple[int, int]:
    rows, columns = (*shape, 1, 1)[:2]
    return rows, columns


def _word(item: Stored, names: Sequence[str]) -> str:
    return next((str(item.attributes[name]) for name in names if name in item.attributes), "")


def _channel(member: ArrayMember, column: int, number: int) -> FileChannel:
    name = member.name if member.shape[1] == 1 else f"{member.name}_{column + 1}"
    return FileChannel(name, number, member.unit, member.quantity or None, member.shape[0])
