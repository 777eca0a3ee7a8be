"""Channels of a text file that end before others do."""

from __future__ import annotations

from collections.abc import Sequence

from torsionnet.core.delimited.number_rows import NumberRows
from torsionnet.core.errors import Fault, ModelError
from torsionnet.io.records.source import FileChannel

EMPTY_CELLS_NOTE = " empty cells are NaN"


def check_lengths(rows: NumberRows, channels: Sequence[FileChannel], file: str) -> None:
    """Refuse rows that were read to their end and of which the last are empty in some of the channels."""
    lengths = {channel.name: int(rows.filled[channel.column]) for channel in channels}
    if len(set(lengths.values())) > 1:
        sizes = ", ".join(f"{name} has {length}" for name, length in lengths.items())
        raise ModelError([Fault(f"channels of different lengths: {sizes} values")], file)


def count_empty(rows: NumberRows, columns: Sequence[int], discovered: list[str]) -> None:
    """Note how many cells were empty so far, instead of what was noted before."""
    empty = int(rows.empty[list(columns)].sum())
    if empty:
        discovered[:] = [
            *(note for note in discovered if not note.endswith(EMPTY_CELLS_NOTE)),
            f"{empty}{EMPTY_CELLS_NOTE}",
        ]
