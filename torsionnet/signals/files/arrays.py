"""Files of named arrays (NPZ, MAT, HDF5): which arrays are channels, and which number is the sampling rate."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from torsionnet.signals.files.source import Channel, Reader, Source, names_a_rate, sliced
from torsionnet.signals.files.stored import with_stored
from torsionnet.signals.recording import FloatArray

MOST_COLUMNS = 256  # more make a picture or a matrix of something else


@dataclass(frozen=True)
class Member:
    """One array of a file; ``read`` gives rows of it, ``shape`` is (samples, columns)."""

    name: str
    shape: tuple[int, int]
    read: Reader
    unit: str = ""
    quantity: str = ""

    def column(self, index: int) -> Reader:
        def read(first: int, last: int) -> FloatArray:
            block = self.read(first, last)
            return np.asarray(block if block.ndim == 1 else block[:, index], dtype=float)

        return read


def array_member(name: str, values: FloatArray, unit: str = "", quantity: str = "") -> Member:
    """Member of an array in memory; a row becomes a column."""
    columns = values.reshape(-1, 1) if values.ndim < 2 or 1 in values.shape else values  # noqa: PLR2004
    shape = (columns.shape[0], columns.shape[1])
    return Member(name, shape, lambda first, last: columns[first:last], unit, quantity)


def array_source(members: Iterable[Member], stored: str, title: str) -> Source:
    """Source of named arrays: a number named ``fs`` or the like is the rate, other single numbers are passed over."""
    channels, readers, notes, rate = list[Channel](), list[Reader](), list[str](), None
    for member in members:
        if member.shape == (1, 1) and not stored:
            is_rate = names_a_rate(member.name)
            rate = float(member.read(0, 1).ravel()[0]) if is_rate else rate
            what = "was taken for the sampling rate" if is_rate else "is a single number, no channel"
            notes.append(f"{member.name} {what}")
        elif member.shape[1] > MOST_COLUMNS:
            notes.append(f"{member.name} was left out: {member.shape[0]} by {member.shape[1]} numbers are no channels")
        else:
            for column in range(member.shape[1]):
                channels.append(_channel(member, column, len(channels)))
                readers.append(member.column(column))
    blocks = sliced(readers, [channel.length or 0 for channel in channels])
    source = Source(tuple(channels), blocks, rate=rate, title=title, notes=tuple(notes))
    return with_stored(source, stored) if stored else source.with_time_found()


def _channel(member: Member, column: int, number: int) -> Channel:
    name = member.name if member.shape[1] == 1 else f"{member.name}_{column + 1}"
    return Channel(name, number, member.unit, member.quantity or None, member.shape[0])
